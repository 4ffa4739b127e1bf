#pragma once
// Whether what was found predicts data that no fit saw. A model, fitted and with its noise
// from what fits saw, is run beside the rest: -2 ln L of that is how well it predicts it, all
// that it costs included, for nothing of it was fitted there. Members are taken out one by
// one, the others fitted anew each time with the noise that suits them; one that the unseen
// data speak against, or that is not worth its price on both together, leaves the model, the
// worst first, and so does one whose force nobody would miss (member_forces.h). What could be
// in the place of a member is fitted there, too: by first order the likeliest, and the
// simplest laws of its kind; one that is better takes the place. Before a member leaves, what is
// simpler is asked there, and where all of a model predicts unseen data no better than the machine
// as given, the models are that the search had before; if none of them does it is none.

#include <functional>
#include <vector>

#include "mjdiag/discovery/answer/answer_data.h"
#include "mjdiag/discovery/answer/model_on_runs.h"
#include "mjdiag/discovery/fit/decision.h"
#include "mjdiag/discovery/fit/explain.h"

namespace mjdiag {

/// What is lost without a member, in -2 ln.
struct MemberLoss {
  double seen = 0.0;    ///< of the score, which has its price
  double unseen = 0.0;  ///< of how well unseen data are predicted
  double Total() const { return seen + unseen; }
  /// That unseen data speak against it by more than fits are off, or that it is not worth its
  /// price.
  bool IsRefuted() const;
  /// Whether no noise that is known better could make it less.
  bool IsBeyondDoubt() const;
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

/// @param explained  goes back to a model before, where what the search added to it does not
///                   hold on unseen data
/// @param is_over    whether nothing further may be tried
UnseenJudgement JudgeUnseen(const AnswerData& data, Explained& explained,
                            const std::function<bool()>& is_over);

/// The machine as given is the answer, and its members are refuted.
/// @param loss  that it was found by
void LeaveNothing(const std::vector<Block>& blocks, const std::string& why, double loss,
                  UnseenJudgement& judged);

}  // namespace mjdiag
