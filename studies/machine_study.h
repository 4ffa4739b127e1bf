#pragma once
// What all studies share: the machine, its diagnosis, runs with a fault, and what is
// seen in them.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/plugin/design/diagnosis.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/studies/growing_table.h"

namespace mjdiag {

/// A fault parameter or disturbance with its value.
struct SizedFault {
  std::string name;
  double value = 1.0;
};

struct StudyOptions {
  int runs = 200;          ///< Monte-Carlo runs where a study has any
  std::uint64_t seed = 1;  ///< of the first run
  std::function<void(double fraction)> progress;
  RowSink row;          ///< sees tables grow; may be called from any thread
  bool linear = false;  ///< the linear plant, where a study has either
  // Of one long run:
  double duration = 60.0;        ///< [s]
  double every = 60.0;           ///< a row [s]
  std::vector<SizedFault> wear;  ///< by how much these faults grow an hour
};

/// A machine with faults of its plant, and how it is run with those of the outside.
struct FaultyMachine {
  Machine machine;
  RunOptions options;
};

/// Disturbances of the setup go where they belong. InputError on a name that neither
/// the plant nor the setup has.
FaultyMachine WithFaults(const Machine& machine, const std::vector<SizedFault>& faults,
                         std::uint64_t seed);
Record RunLinear(const Excitation& motion, const FaultyMachine& faulty);
/// Of the linear plant, or the nonlinear one.
Record RunOf(const Excitation& motion, const FaultyMachine& faulty, bool linear);

/// 0 for a disturbance of the setup, else 1.
double HealthyValue(const Setup& setup, const std::string& fault);

/// The setup's filters with limits from nominal runs of the linear plant.
PreparedDiagnosis LinearDiagnosis(const Machine& machine);

/// What a diagnosis sees.
struct Detection {
  std::optional<double> residual;  ///< when the residual left its limits [s]
  bool spectrum = false;           ///< tones or raised noise
  bool estimate = false;           ///< of the fault asked for
  double value = 0.0;              ///< its estimate
};

/// In a record, all of which is regressed. Cross terms of large faults stay in: the
/// faults here are single ones.
Detection Look(const PreparedDiagnosis& prepared, const Record& record,
               const std::string& fault);

}  // namespace mjdiag
