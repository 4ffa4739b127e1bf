#pragma once
// How a model stands on single records: free simulation, from the reference in closed
// loop or the recorded input, beside what was measured.

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "mjdiag/discovery/comparison/comparison.h"
#include "mjdiag/discovery/measurements.h"
#include "mjdiag/plugin/effects/changes.h"
#include "mjdiag/plugin/machine/physics_steps.h"

namespace mjdiag {

struct RecordReplay {
  std::string name;   ///< of the record
  bool seen = true;   ///< by fits
  Comparison before;  ///< plant as given
  Comparison after;   ///< extended plant
};

/// Of all records, those that fits saw first. A machine that falls is followed by a filter
/// instead (CompareFollowed).
/// @param steps  that the records know, before and after: what others would add is no
///               mismatch of the plant
/// @param seed   of the noise floors
/// @param near   to it the noise of the filter is
std::vector<RecordReplay> ReplayAll(const Measurements& measurements,
                                    const Changes& changes, PhysicsSteps steps,
                                    std::uint64_t seed, bool falls,
                                    const FilterNoise& near);

/// Whether the machine falls on any of the records.
bool AnyDivergesOpenLoop(const Measurements& measurements);

/// Channel or derived signal -> relative error (ReplayErrors), mean over records [%].
std::map<std::string, double> MeanReplayErrors(
    const std::vector<MeasuredRecord>& records, const Changes& changes,
    PhysicsSteps steps);

}  // namespace mjdiag
