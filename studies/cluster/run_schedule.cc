#include "mjdiag/studies/cluster/run_schedule.h"

#include <algorithm>

namespace mjdiag {
namespace {

/// Adds a run behind the last one, in its range if it is the next.
void Append(std::int64_t run, std::vector<RunRange>& ranges) {
  if (!ranges.empty() && ranges.back().end == run) {
    ++ranges.back().end;
  } else {
    ranges.push_back({run, run + 1});
  }
}

}  // namespace

RunSchedule::RunSchedule(const std::vector<std::int64_t>& open, std::int64_t runs,
                         int ranks, double patience, double now)
    : waiting_runs_(static_cast<std::int64_t>(open.size())),
      is_done_(static_cast<std::size_t>(runs)),
      ranks_(static_cast<std::size_t>(ranks)),
      patience_(patience),
      total_(waiting_runs_) {
  std::vector<RunRange> ranges;
  for (const std::int64_t run : open) Append(run, ranges);
  waiting_.assign(ranges.begin(), ranges.end());
  for (Rank& rank : ranks_) rank.heard = now;
}

void RunSchedule::Heard(int rank, int threads, double now) {
  Rank& heard = ranks_[static_cast<std::size_t>(rank)];
  heard.threads = threads;
  heard.heard = now;
  heard.lost = false;
}

void RunSchedule::Done(int rank, const std::vector<std::int64_t>& runs) {
  Rank& maker = ranks_[static_cast<std::size_t>(rank)];
  for (const std::int64_t run : runs) {
    maker.has.erase(run);
    ++maker.made;
    // One that was thought lost may have made what another has made meanwhile.
    if (is_done_[static_cast<std::size_t>(run)]) continue;
    is_done_[static_cast<std::size_t>(run)] = true;
    ++done_;
  }
}

void RunSchedule::GiveBack(Rank& rank) {
  std::vector<RunRange> ranges;
  for (const std::int64_t run : rank.has) Append(run, ranges);
  waiting_.insert(waiting_.begin(), ranges.begin(), ranges.end());
  waiting_runs_ += static_cast<std::int64_t>(rank.has.size());
  rank.has.clear();
}

void RunSchedule::Retire(int rank) {
  Rank& retired = ranks_[static_cast<std::size_t>(rank)];
  retired.retired = true;
  GiveBack(retired);
}

std::vector<int> RunSchedule::TakeSilent(double now) {
  std::vector<int> silent;
  for (std::size_t i = 0; i < ranks_.size(); ++i) {
    Rank& rank = ranks_[i];
    if (rank.lost || now - rank.heard <= patience_) continue;
    rank.lost = true;
    GiveBack(rank);
    silent.push_back(static_cast<int>(i));
  }
  return silent;
}

std::int64_t RunSchedule::Share(const Rank& rank, double now) const {
  std::int64_t threads = 0;
  for (const Rank& one : ranks_) threads += Works(one) ? one.threads : 0;
  const auto has = static_cast<std::int64_t>(rank.has.size());
  if (waiting_runs_ <= 2 * threads) return rank.threads - has;
  const double seconds = now - rank.begun;
  const double rate = seconds > 0.0 ? static_cast<double>(rank.made) / seconds : 0.0;
  const auto made_ahead = static_cast<std::int64_t>(
      std::min(kAhead * rate, static_cast<double>(waiting_runs_)));
  const std::int64_t ahead =
      std::min(waiting_runs_ * rank.threads / (2 * threads), made_ahead);
  return has < rank.threads + ahead / 2 ? rank.threads + ahead - has : 0;
}

void RunSchedule::Take(std::int64_t count, Rank& rank, std::vector<RunRange>& taken) {
  while (count > 0 && !waiting_.empty()) {
    RunRange& first = waiting_.front();
    const std::int64_t run = first.begin++;
    if (first.begin == first.end) waiting_.pop_front();
    --waiting_runs_;
    if (is_done_[static_cast<std::size_t>(run)]) continue;
    Append(run, taken);
    rank.has.insert(run);
    --count;
  }
}

std::vector<RunRange> RunSchedule::Grant(int rank, double now) {
  Rank& asking = ranks_[static_cast<std::size_t>(rank)];
  std::vector<RunRange> taken;
  if (!Works(asking) || asking.threads == 0) return taken;
  if (asking.made == 0 && asking.has.empty()) asking.begun = now;
  Take(Share(asking, now), asking, taken);
  return taken;
}

bool RunSchedule::has_workers() const {
  return std::ranges::any_of(ranks_, [this](const Rank& rank) { return Works(rank); });
}

}  // namespace mjdiag
