#pragma once
// A model along what fits saw and along what they did not, behind the noise that suits it there:
// what an answer is judged by (unseen_judgement.h).

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "mjdiag/discovery/answer/answer_data.h"
#include "mjdiag/discovery/comparison/prediction.h"
#include "mjdiag/discovery/fit/explain.h"
#include "mjdiag/discovery/fit/model_fit.h"
#include "mjdiag/plugin/replay/force_filter.h"
#include "mjdiag/plugin/replay/noise_fit.h"

namespace mjdiag {

struct ModelOnRuns {
  ModelFit fit;
  FilterPath seen;
  FilterPath unseen;             ///< of SplitRun::unseen
  double unseen_deviance = 0.0;  ///< -2 ln L of what fits did not see of it

  double Score() const { return seen.deviance + fit.prior + fit.occam; }
  /// By all that was measured.
  double Total() const { return Score() + unseen_deviance; }
};

/// Along what fits did not see, behind the noise that is likeliest there: another motion asks
/// other things of what a model lacks, and whose values are right is the question, not whose
/// noise is. Begun from the noise of what fits saw, and from one with a hundredth of the
/// latent forces of the machine as given: a model that is all but exact has next to none,
/// and a filter that is so sure of itself does not come back from where a joint sticks a
/// moment longer.
/// @param given  noise of the machine as given
void FollowUnseen(const AnswerData& data, const FilterNoise& given,
                  const std::function<bool()>& is_over, ModelOnRuns& one);

/// Values of a model anew along the path of another one that is all but it, and behind its noise;
/// without what fits did not see.
ModelOnRuns RefittedAlong(const FilterPath& like, const AnswerData& data,
                          const Model& model, const std::function<bool()>& is_over);

/// Values and noise of a model anew, from others' paths: the noise by pieces of what fits saw,
/// and of what they did not the likeliest of some. What it costs beside others is an upper bound,
/// which `Refined` is not by.
/// @param others  the likelier ones first
ModelOnRuns RefittedByPieces(const AnswerData& data, const Model& model,
                             const std::vector<const ModelOnRuns*>& others,
                             const std::function<bool()>& is_over);

/// The same behind the noise that all of it asks for.
ModelOnRuns Refined(const AnswerData& data, ModelOnRuns by_pieces,
                    const FilterNoise& given, const std::function<bool()>& is_over);

ModelOnRuns NothingOf(const AnswerData& data, const Explained& explained,
                      const std::function<bool()>& is_over);

/// Where the search for the noise of one model ended is not where that of another did: what
/// suits the other may suit it as well.
void LookBehindNoiseOf(const ModelOnRuns& other, const AnswerData& data,
                       const IsTimeOver& is_over, ModelOnRuns& one);

/// How a model predicts what fits saw, or did not see.
Prediction PredictionOf(const AnswerData& data, const ModelOnRuns& one, bool of_seen);

/// Answers are judged by predictions over 0.1 s at most: what people who control a machine
/// look ahead, and so short that one that runs away has not yet.
inline bool IsWithinHorizon(double horizon) {
  constexpr double kHorizon = 0.1;  // [s]
  return horizon <= kHorizon * (1.0 + 1e-9);
}

}  // namespace mjdiag
