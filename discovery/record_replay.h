#pragma once
// How a model stands on single records: free simulation, from the reference in closed
// loop or the recorded input, beside what was measured.

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "mjdiag/comparison/comparison.h"
#include "mjdiag/discovery/measurements.h"
#include "mjdiag/plugin/effects/changes.h"

namespace mjdiag {

struct RecordReplay {
  std::string name;   ///< of the record
  bool seen = true;   ///< by fits
  Comparison before;  ///< plant as given
  Comparison after;   ///< extended plant
};

/// Of all records, those that fits saw first. A machine that falls is followed by a filter
/// instead (CompareFollowed).
/// @param seed  of the noise floors
std::vector<RecordReplay> ReplayAll(const Measurements& measurements,
                                    const Changes& changes, std::uint64_t seed,
                                    bool falls);

/// Whether the machine falls on any of the records.
bool AnyFalls(const Measurements& measurements);

/// Measured less simulated of every sensor, one record after the other, sensors x
/// samples; 0 where it was not measured. NumericalError where one diverges.
Eigen::MatrixXd FreeErrors(const std::vector<MeasuredRecord>& records,
                           const Changes& changes);

/// How far free simulation of records is off beside a model: the mean over sensors and
/// records of ln sqrt(1 + e^2 / r^2), e the rms of what was measured less what was
/// simulated, r that of the sensor's noise. Infinite where one diverges.
double FreeRun(const std::vector<MeasuredRecord>& records, const Changes& changes,
               const Eigen::VectorXd& noise_sd);

/// Channel or derived signal -> relative error (ReplayErrors), mean over records [%].
std::map<std::string, double> MeanReplayErrors(
    const std::vector<MeasuredRecord>& records, const Changes& changes);

}  // namespace mjdiag
