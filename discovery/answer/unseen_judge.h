#pragma once
// The judgement of unseen_judgement.h while it is made: members leave (unseen_judge_drops.cc) or
// are exchanged (unseen_judge_exchanges.cc), the rest of the models fitted anew each time.

#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/discovery/answer/simpler_blocks.h"
#include "mjdiag/discovery/answer/unseen_judgement.h"

namespace mjdiag {

class UnseenJudge {
 public:
  UnseenJudge(const AnswerData& data, Explained& explained,
              const std::function<bool()>& is_over)
      : data_(data), explained_(explained), is_over_(is_over) {}

  UnseenJudgement Run();

 private:
  void Decide(const std::string& tried, double score, const std::string& why) {
    judged_.decisions.push_back({tried, score, why});
  }
  std::string Names(const Model& model) const { return ModelText(data_.blocks, model); }
  /// The model of the search is the answer, with all its members.
  void TakeExplained(ModelOnRuns answer);
  /// To where the search was when its model still held on what no fit saw.
  void GoBack();
  /// Takes out, at once, members of the model of the search that nobody would miss.
  void DropIdle();
  /// Follows unseen data beside the machine as given, and beside the answer.
  /// @return whether the machine stays with them with the answer
  bool FollowBoth();
  /// Values and noises of some models anew; none of one that the machine cannot be. Those that
  /// are beyond doubt worse than the answer by the noise of pieces only.
  std::vector<std::optional<ModelOnRuns>> RefittedAll(
      const std::vector<Model>& models) const;
  /// Takes every member out; true if the worst one leaves the model, or another one comes in
  /// its place.
  bool DropWorst();
  /// What is simpler in the place of a member, if it is worth more than nothing there: a law of
  /// the wrong shape may hold where it was found and nowhere else.
  std::optional<ModelOnRuns> SimplerInPlaceOf(std::size_t place,
                                              const ModelOnRuns& without) const;
  bool IsFree(std::size_t block, std::size_t place) const;
  std::vector<Instead> InsteadOf(std::size_t place) const;
  /// True if a member is exchanged.
  bool ExchangeOne();
  MemberLoss LossOf(const ModelOnRuns& other) const {
    return {other.Score() - judged_.answer.Score(),
            other.unseen_deviance - judged_.answer.unseen_deviance};
  }

  /// Loss of what was not asked, or what nothing is known to be without.
  static constexpr double kNeeded = std::numeric_limits<double>::infinity();

  const AnswerData& data_;
  Explained& explained_;
  const std::function<bool()>& is_over_;
  UnseenJudgement judged_;
  /// Blocks of members whose loss is beyond doubt: the fewer others are left, the more.
  std::map<std::size_t, MemberLoss> needed_;
};

}  // namespace mjdiag
