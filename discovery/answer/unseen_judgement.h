#pragma once
// Whether what was found predicts data that no fit saw. A model, fitted and with its noise
// from what fits saw, is run beside the rest: -2 ln L of that is how well it predicts it, all
// that it costs included, for nothing of it was fitted there. Members are taken out one by
// one, the others fitted anew each time with the noise that suits them; one that the unseen
// data speak against, or that is not worth its price on both together, leaves the model, the
// worst first, and so does one whose force nobody would miss (member_forces.h). What could be
// in the place of a member is fitted there, too: by first order the likeliest, and the
// simplest laws of its kind; one that is better takes the place. A model that predicts unseen
// data no better than the machine as given is none.

#include <functional>
#include <vector>

#include "mjdiag/discovery/answer/answer_data.h"
#include "mjdiag/discovery/fit/decision.h"
#include "mjdiag/discovery/fit/explain.h"
#include "mjdiag/discovery/fit/model_fit.h"
#include "mjdiag/plugin/replay/force_filter.h"

namespace mjdiag {

/// A model along what fits saw and along what they did not, behind the noise that suits it.
struct ModelOnRuns {
  ModelFit fit;
  FilterPath seen;
  FilterPath unseen;             ///< of SplitRun::unseen
  double unseen_deviance = 0.0;  ///< -2 ln L of what fits did not see of it

  double Score() const { return seen.deviance + fit.prior + fit.occam; }
};

/// What is lost without a member, in -2 ln.
struct MemberLoss {
  double seen = 0.0;    ///< of the score, which has its price
  double unseen = 0.0;  ///< of how well unseen data are predicted
  double Total() const { return seen + unseen; }
};

/// Another block in the place of a member.
struct MemberExchange {
  std::size_t block = 0;
  Eigen::VectorXd values;
  MemberLoss loss;
};

struct UnseenJudgement {
  ModelOnRuns nothing;  ///< the machine as given
  ModelOnRuns answer;
  std::vector<std::size_t> places;  ///< of its members in Explained::fit
  std::vector<MemberLoss> losses;   ///< of its members
  std::vector<std::vector<MemberExchange>> exchanges;  ///< that were fitted, the same
  std::vector<Decision> decisions;
  std::vector<std::string> refuted;  ///< members that unseen data speak against
  bool is_cut_short = false;         ///< not every member was taken out
};

/// @param is_over  whether nothing further may be tried
UnseenJudgement JudgeUnseen(const AnswerData& data, const Explained& explained,
                            const std::function<bool()>& is_over);

}  // namespace mjdiag
