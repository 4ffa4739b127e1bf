#pragma once
// What a machine lacks along a run: one model (model.h), found by moves (moves.h) that are
// fitted with MuJoCo's own ticks (model_fit.h), each about the machine with the model so far,
// until nothing pays. A move is taken if the filter of the machine with it, its noise anew,
// predicts the run better than its price.

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/discovery/fit/decision.h"
#include "mjdiag/discovery/fit/model.h"
#include "mjdiag/discovery/fit/model_fit.h"
#include "mjdiag/discovery/hypotheses/candidate_choice.h"
#include "mjdiag/discovery/regression/moves.h"
#include "mjdiag/plugin/machine/physics_steps.h"
#include "mjdiag/plugin/plant/model_parameter.h"
#include "mjdiag/plugin/replay/force_filter.h"

namespace mjdiag {

struct Explained;

struct ExplainOptions {
  double seconds = 60.0;
  /// After every step, for people.
  std::function<void(const std::string&)> progress = {};
  /// Whenever a better model is found.
  std::function<void(const Explained&)> better = {};
  CandidateChoice choice = {};
  /// Numbers of the plant that may be others; none given: all of NumbersInDoubt.
  std::optional<std::vector<ModelParameter>> numbers = {};
  /// Members that are no numbers.
  std::size_t most_causes = std::numeric_limits<std::size_t>::max();
  /// Whether it is asked to end with what it has; called from this thread. May be empty.
  std::function<bool()> stop = {};
};

/// A model that the search had for a while, behind the noise that suited it.
struct StepTaken {
  ModelFit fit;
  FilterNoise noise;
};

struct Explained {
  std::vector<Block> blocks;
  ModelFit fit;
  FilterPath nothing;        ///< of the machine as given
  FilterPath path;           ///< of that with the model
  double score = 0.0;        ///< -2 ln L and what the model costs
  PhysicsSteps steps = {};   ///< that it knows
  int ticks = 1;             ///< of a sample of the paths (coarser_run.h)
  double input_width = 0.0;  ///< over which inputs are smoothed [samples of the paths]
  std::vector<Decision> decisions;  ///< what was tried, in that order
  /// What could be in the place of members (Moves::near), where the search came to its end:
  /// by how much worse each is stands in ModelMove::score.
  std::vector<ModelMove> rivals;
  std::vector<StepTaken> steps_taken;  ///< the model as it grew, by all of the run
  bool is_cut_short = false;  ///< by its seconds or because it was asked to end
};

/// @param reading_sd  of every sensor, by itself
Explained Explain(const Machine& machine, const MeasuredRun& run,
                  const Eigen::VectorXd& reading_sd, const ExplainOptions& options);

}  // namespace mjdiag
