#pragma once
// Which rank makes which runs of a study. A rank has a run for every one of its threads and
// n ahead, and gets more when half of these are begun: with w runs waiting, t threads of its
// own and T of all ranks,
//
//   n = min(w t / (2 T), what it makes in a second), 0 once w <= 2 T.
//
// So shares begin large and end small (guided self-scheduling of Polychronopoulos and
// Kuck), a slow rank holds few, and at the end nobody holds runs back. Nothing is handed
// out to two ranks but runs of one that was not heard for longer than `patience`: whichever
// makes such a run, its bits are the same. scripts/scheduler-loss simulates it.
//
// No threads, no messages, no clock: `now` [s] comes from outside.

#include <cstdint>
#include <deque>
#include <set>
#include <vector>

#include "mjdiag/studies/cluster/rank_message.h"

namespace mjdiag {

class RunSchedule {
 public:
  /// @param open   numbers of the runs to make, increasing
  /// @param runs   of the whole study
  RunSchedule(const std::vector<std::int64_t>& open, std::int64_t runs, int ranks,
              double patience, double now);

  /// The rank lives and makes runs with so many threads, 0: not yet.
  void Heard(int rank, int threads, double now);
  /// It has made these.
  void Done(int rank, const std::vector<std::int64_t>& runs);
  /// It makes no more runs: those it had are handed out again.
  void Retire(int rank);
  /// The ranks that have now not been heard for too long; as if retired, until they are.
  std::vector<int> TakeSilent(double now);

  /// What the rank is to make beside what it has; may be nothing.
  std::vector<RunRange> Grant(int rank, double now);

  std::int64_t done() const { return done_; }
  bool is_finished() const { return done_ == total_; }
  bool is_lost(int rank) const { return ranks_[static_cast<std::size_t>(rank)].lost; }
  /// Whether there is a rank that may make runs.
  bool has_workers() const;

 private:
  struct Rank {
    std::int64_t threads = 0;
    double heard = 0.0;  // [s]
    double begun = 0.0;  // when it got its first runs [s]
    std::int64_t made = 0;
    std::set<std::int64_t> has;
    bool retired = false;
    bool lost = false;
  };

  static constexpr double kAhead = 1.0;  // s

  bool Works(const Rank& rank) const { return !rank.retired && !rank.lost; }
  void GiveBack(Rank& rank);
  std::int64_t Share(const Rank& rank, double now) const;
  void Take(std::int64_t count, Rank& rank, std::vector<RunRange>& taken);

  std::deque<RunRange> waiting_;
  std::int64_t waiting_runs_ = 0;
  std::vector<bool> is_done_;  // by number of the run
  std::vector<Rank> ranks_;
  double patience_;
  std::int64_t done_ = 0;
  std::int64_t total_;
};

}  // namespace mjdiag
