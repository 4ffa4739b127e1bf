#pragma once
// What is not known of a machine, for its twin: which of its numbers unknown factors
// multiply, the tones on its commands, and where it starts.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/twin/linear_twin.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/plant/model_parameter.h"

namespace mjdiag {

/// A number of the plant with the unknowns whose product it is multiplied by.
struct UncertainNumber {
  ModelParameter number;
  ModelPart part;  ///< of its linear plant, its factors among it; of dry friction: none
};

/// Friction at a joint that effects of the plant make, beside that of its own, with the
/// unknown whose exponential multiplies it.
struct UncertainResistance {
  int joint = 0;
  Eigen::Index unknown = 0;
};

/// What theta of its twin is, in this order: fault parameters, numbers of the plant that
/// are not known exactly, two of every tone, those of the start.
struct UncertainMachine {
  std::vector<Unknown> unknowns;
  std::vector<UncertainNumber> numbers;
  std::vector<UncertainResistance> resistances;
  std::vector<UnknownTone> tones;
  Eigen::MatrixXd start;  ///< see UncertainModel
  Eigen::Index faults = 0;
  Eigen::Index known = 0;  ///< numbers of the plant, behind the faults

  Eigen::Index first_tone() const { return faults + known; }
};

struct UncertaintyOptions {
  bool faults = true;  ///< the machine may be faulty: else it is healthy
  /// Numbers that the plant says are exact are taken as known as their kind usually is.
  bool doubt = false;
  /// Numbers are known as DoubtOf says: nobody has measured them on the machine itself.
  bool unmeasured = false;
  bool friction = true;  ///< dry friction is among what acts
  /// [J], see StartDirections; 0: where a run starts is not among the unknowns.
  double start_energy = 1.0;
};

/// What a calibration says of the plant takes the place of what the plant says of itself.
/// Dry friction is not known exactly on any plant that does not say so of its own
/// joint: it changes with the hour, whether MuJoCo or an effect of the plant makes it. That
/// of effects is known as it was found where the machine is known to be healthy.
UncertainMachine MakeUncertainMachine(const Machine& machine,
                                      const UncertaintyOptions& options);

/// Coordinates z in which the unknowns of a calibrated machine are known independently of
/// each other, theta = T z: in the place of the numbers that were calibrated together as
/// many along the columns of the root of their covariance, of standard deviation 1.
struct KnownTogether {
  std::vector<Unknown> unknowns;
  Eigen::MatrixXd T;  ///< of all unknowns
};
KnownTogether AsCalibrated(const Machine& machine, const UncertainMachine& uncertain);

/// Its linear plant: without dry friction.
UncertainModel MakeUncertainModel(const Machine& machine,
                                  const UncertainMachine& uncertain);

/// What a number of the plant adds to M, D, K and Gamma and to the forces at rest.
ModelPart PartOf(const Machine& machine, const ModelParameter& number);

}  // namespace mjdiag
