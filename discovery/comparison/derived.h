#pragma once
// Signals that nobody measured but everybody compares: velocity and acceleration of the
// position sensors, and forces of the actuators.
//
//   velocity(k)      (f(k+1) - f(k-1)) / (2 T)   f: position after a zero-phase
//   low-pass acceleration(k)  (velocity(k+1) - velocity(k-1)) / (2 T) force(k) factor *
//   actuator signal(k), unfiltered
//
// (one-sided at both ends, see CentralDifference). Measured and simulated signals take
// the same path, so that what the low-pass removes is missing from both.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/plugin/setup/setup.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// "<position>_velocity" and "<position>_acceleration" of every channel in `positions`,
/// then the forces of `compare` whose actuator channel `record` has.
Record DeriveChannels(const Record& record, const std::vector<std::string>& positions,
                      const CompareSetup& compare);

/// One derived channel, measured against simulated.
struct DerivedMismatch {
  std::string name;
  std::string unit;  ///< SI, of rms
  double rms = 0.0;
  double relative_error_percent = 0.0;
};

/// Every channel of the first record against the channel of that name in the second,
/// without the first `skip` samples.
std::vector<DerivedMismatch> MeasureDerived(const Record& measured,
                                            const Record& simulated, Eigen::Index skip);

}  // namespace mjdiag
