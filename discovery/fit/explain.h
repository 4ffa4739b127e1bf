#pragma once
// What a machine lacks along a run: one model (model.h), found by moves (moves.h) that are
// fitted with MuJoCo's own ticks (model_fit.h), each about the machine with the model so far,
// until nothing pays. A move is taken if the filter of the machine with it, its noise anew,
// predicts the run better than its price.

#include <functional>
#include <string>
#include <vector>

#include "mjdiag/discovery/fit/model.h"
#include "mjdiag/discovery/fit/model_fit.h"
#include "mjdiag/plugin/replay/force_filter.h"

namespace mjdiag {

struct ExplainOptions {
  double seconds = 60.0;
  /// After every step, for people.
  std::function<void(const std::string&)> progress;
};

struct Explained {
  std::vector<Block> blocks;
  ModelFit fit;
  FilterPath nothing;  ///< of the machine as given
  FilterPath path;     ///< of that with the model
  Eigen::VectorXd widths;  ///< over which every input is smoothed [ticks]
  double score = 0.0;      ///< -2 ln L and what the model costs
};

/// @param reading_sd  of every sensor, by itself
Explained Explain(const Machine& machine, const MeasuredRun& run,
                  const Eigen::VectorXd& reading_sd, const ExplainOptions& options);

}  // namespace mjdiag
