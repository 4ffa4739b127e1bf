#pragma once
// What all studies share: the machine, its diagnosis, runs with a fault, and what is
// seen in them.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/plugin/design/diagnosis.h"
#include "mjdiag/plugin/simulation.h"

namespace mjdiag {

struct StudyOptions {
  int runs = 200;          ///< Monte-Carlo runs where a study has any
  std::uint64_t seed = 1;  ///< of the first run
  std::function<void(double fraction)> progress;
};

/// A fault with a knob or disturbance value.
struct SizedFault {
  std::string name;
  double value = 1.0;
};

/// Run options with these faults on; disturbances of the setup go where they belong.
/// InputError on a name that neither the plant nor the setup has.
RunOptions WithFaults(const Setup& setup, const mjModel& plant,
                      const std::vector<SizedFault>& faults, std::uint64_t seed);

/// 0 for a disturbance of the setup, else 1.
double HealthyValue(const Setup& setup, const std::string& fault);

/// The default trajectory of a setup.
Excitation DefaultMotion(const Setup& setup);

/// The setup's filters with limits from nominal runs of the linear plant.
PreparedDiagnosis LinearDiagnosis(const Setup& setup, const mjModel& plant);

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

/// The smallest deviation from healthy, by bisection on its logarithm between `seen`
/// and nothing, at which `detected` still holds; nullopt if it does not hold at `seen`.
/// Accurate to a factor of `resolution`.
std::optional<double> SmallestDeviation(double seen, double resolution,
                                        const std::function<bool(double)>& detected);

/// Binomial 99 % band of a rate: how many of `runs` may be counted if each counts with
/// this probability, lower and upper end.
std::pair<int, int> BinomialBand(int runs, double probability, double confidence);

}  // namespace mjdiag
