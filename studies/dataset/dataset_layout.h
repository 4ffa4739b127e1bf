#pragma once
// What a data set of a plan has in it, beside the values.

#include <string>
#include <vector>

#include "mjdiag/studies/dataset/series.h"
#include "mjdiag/studies/features.h"
#include "mjdiag/studies/plan/run_machine.h"

namespace mjdiag {

struct DatasetLayout {
  std::vector<Series> series;
  double sample_time = 0.0;         ///< of the series [s]
  std::vector<std::string> faults;  ///< that the diagnosis estimates
  std::vector<std::string> features;
  std::vector<std::string> feature_channels;
};

/// Of what the plan keeps: as many octaves as its segments have, nine at most.
FeatureOptions FeatureOptionsOf(const PlanKeep& keep);

/// InputError if this build cannot keep series and the plan asks for them, or features
/// ask for longer runs than they are.
DatasetLayout LayoutOf(const LoadedPlan& loaded, const RunMaker& maker);

}  // namespace mjdiag
