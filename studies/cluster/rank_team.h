#pragma once
// The ranks of a job in their roles: rank 0 leads, the others report to it.

#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "mjdiag/studies/cluster/rank_link.h"
#include "mjdiag/studies/cluster/rank_message.h"

namespace mjdiag {

class RankTeam {
 public:
  explicit RankTeam(std::unique_ptr<RankLink> link) : link_(std::move(link)) {}
  /// Of rank 0: ends the job for all, if End was not called.
  ~RankTeam();
  RankTeam(const RankTeam&) = delete;
  RankTeam& operator=(const RankTeam&) = delete;

  int rank() const { return link_->rank(); }
  int ranks() const { return link_->ranks(); }
  bool is_led_here() const { return rank() == 0; }

  // Of rank 0.

  void Order(int rank, const RankOrder& order);
  void OrderAll(const RankOrder& order);
  std::optional<std::pair<int, RankReport>> NextReport();
  /// One that does not answer any more.
  void Lose(int rank) { lost_.insert(rank); }
  /// No messages from here on: the others leave, each process goes on alone.
  void End();

  // Of the others.

  void Report(const RankReport& report) { link_->Send(0, Packed(report)); }
  std::optional<RankOrder> NextOrder();
  /// The next order that is no work, waiting for it. When rank 0 is silent for so long
  /// [s], the job is ended at once.
  RankOrder AwaitOrder(double longest);
  /// As the order to end says.
  void Leave(const RankOrder& order);
  /// Rank 0 is lost: ends the job.
  void Abort() { link_->Abort(); }

 private:
  std::unique_ptr<RankLink> link_;
  std::set<int> lost_;
  bool ended_ = false;
};

}  // namespace mjdiag
