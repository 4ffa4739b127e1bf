#include "mjdiag/studies/cluster/shared_runs.h"

#include <chrono>
#include <set>
#include <utility>

#include "mjdiag/signals/error.h"
#include "mjdiag/studies/cluster/pool_report.h"
#include "mjdiag/studies/cluster/run_schedule.h"

namespace mjdiag {
namespace {

using Kind = RankReport::Kind;

// Between two looks for messages, each of which costs some 20 us: of rank 0, which others
// may wait for, of one that waits itself, and of one that has enough to do.
constexpr auto kLeadTick = std::chrono::milliseconds(2);
constexpr auto kTick = std::chrono::milliseconds(1);
constexpr auto kBusyTick = std::chrono::milliseconds(10);

double Now() {
  return std::chrono::duration<double>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

std::string NameOf(int rank) { return "rank " + std::to_string(rank); }

class Leader {
 public:
  Leader(RankTeam& team, RunPool& pool, const LeadOptions& options)
      : team_(team),
        pool_(pool),
        options_(options),
        own_(pool, options.study),
        schedule_(options.open, options.runs, team.ranks(), options.patience, Now()) {}

  void MakeAll() {
    team_.OrderAll({RankOrder::Kind::kBegin});
    while (!schedule_.is_finished()) {
      Listen();
      if (const auto report = own_.Next(kLeadTick)) Take(0, *report);
      LookForSilent();
      if (!schedule_.has_workers() && !schedule_.is_finished()) ThrowFailure();
      Tell();
    }
    Tell();
  }

  /// All ranks close their journals; those that do not are lost.
  void Close() {
    is_closing_ = true;
    team_.OrderAll({RankOrder::Kind::kClose});
    pool_.Stop();
    const double until = Now() + options_.patience;
    while (static_cast<int>(closed_.size()) < team_.ranks() - 1 && Now() < until) {
      Listen();
      if (IsLastLost()) break;
      pool_.Wait(kTick);
    }
    for (int rank = 1; rank < team_.ranks(); ++rank) {
      if (!closed_.contains(rank)) team_.Lose(rank);
    }
  }

 private:
  void Listen() {
    while (const auto report = team_.NextReport()) Take(report->first, report->second);
  }

  void Take(int rank, const RankReport& report) {
    const bool was_lost = schedule_.is_lost(rank);
    schedule_.Heard(rank, static_cast<int>(report.threads), Now());
    if (was_lost) options_.note(NameOf(rank) + " answers again");
    schedule_.Done(rank, report.done);
    if (report.kind == Kind::kClosed) {
      closed_.insert(rank);
      return;
    }
    if (is_closing_) return;
    if (report.kind == Kind::kFailed) TakeFailure(rank, report);
    if (report.kind == Kind::kLeaves) Retire(rank, "was asked to end");
    if (report.threads > 0 && report.study != options_.study) {
      Retire(rank, "has another plan, setup or version");
    }
    Grant(rank, true);
  }

  void TakeFailure(int rank, const RankReport& report) {
    failure_ = report;
    Retire(rank, report.text);
    if (report.run >= 0 && !failed_runs_.insert(report.run).second) ThrowFailure();
  }

  void Retire(int rank, const std::string& why) {
    if (!retired_.insert(rank).second) return;
    options_.note(NameOf(rank) + " makes no more runs: " + why);
    schedule_.Retire(rank);
    GrantAll();
  }

  void LookForSilent() {
    // An own thread is none to be waited for.
    schedule_.Heard(0, own_.is_prepared() ? pool_.threads() : 0, Now());
    const std::vector<int> silent = schedule_.TakeSilent(Now());
    for (const int rank : silent) {
      options_.note(NameOf(rank) + " does not answer: others make its runs");
    }
    if (!silent.empty()) GrantAll();
  }

  /// @param answer  say so if there is nothing
  void Grant(int rank, bool answer) {
    const std::vector<RunRange> runs = schedule_.Grant(rank, Now());
    if (rank == 0) {
      pool_.Add(runs);
    } else if (answer || !runs.empty()) {
      team_.Order(rank, {RankOrder::Kind::kWork, runs});
    }
  }
  void GrantAll() {
    for (int rank = 0; rank < team_.ranks(); ++rank) Grant(rank, false);
  }

  void Tell() {
    constexpr double kBetween = 0.02;  // s
    const double now = Now();
    if (now - told_ < kBetween && !schedule_.is_finished()) return;
    told_ = now;
    options_.tell(schedule_.done(), own_.is_prepared() || schedule_.done() > 0);
  }

  /// Whether those that have not closed have all been silent before.
  bool IsLastLost() const {
    for (int rank = 1; rank < team_.ranks(); ++rank) {
      if (!closed_.contains(rank) && !schedule_.is_lost(rank)) return false;
    }
    return true;
  }

  [[noreturn]] void ThrowFailure() const {
    if (failure_.text.empty()) throw std::runtime_error("no rank is left");
    if (failure_.bad_input) throw InputError(failure_.text);
    throw std::runtime_error(failure_.text);
  }

  RankTeam& team_;
  RunPool& pool_;
  const LeadOptions& options_;
  PoolReport own_;
  RunSchedule schedule_;
  RankReport failure_;  // the last
  std::set<std::int64_t> failed_runs_;
  std::set<int> retired_;
  std::set<int> closed_;
  bool is_closing_ = false;
  double told_ = 0.0;  // [s]
};

}  // namespace

void LeadRuns(RankTeam& team, RunPool& pool, const LeadOptions& options) {
  Leader leader(team, pool, options);
  try {
    leader.MakeAll();
  } catch (...) {
    leader.Close();
    throw;
  }
  leader.Close();
}

std::vector<std::int64_t> MakeRuns(RankTeam& team, RunPool& pool, std::uint64_t study,
                                   double patience, const std::function<bool()>& wish) {
  PoolReport own(pool, study);
  bool leaves = false;
  for (double heard = Now(); Now() - heard < patience;) {
    while (const auto order = team.NextOrder()) {
      heard = Now();
      if (order->kind != RankOrder::Kind::kWork) {
        pool.Stop();
        return own.Rest();
      }
      pool.Add(order->runs);
    }
    if (wish() && !leaves) {
      leaves = true;
      pool.Stop();
      RankReport report;
      report.kind = Kind::kLeaves;
      report.done = own.Rest();
      team.Report(report);
    }
    const auto tick = own.has_waiting() ? kBusyTick : kTick;
    if (const auto report = own.Next(tick)) team.Report(*report);
  }
  team.Abort();
  return {};
}

void ReportClosed(RankTeam& team, const std::vector<std::int64_t>& done) {
  RankReport report;
  report.kind = Kind::kClosed;
  report.done = done;
  team.Report(report);
}

void ReportFailedBeginning(RankTeam& team, std::exception_ptr failure,
                           double patience) {
  RankReport report;
  TellFailure(failure, report);
  team.Report(report);
  for (double heard = Now(), told = heard; Now() - heard < patience;) {
    while (const auto order = team.NextOrder()) {
      heard = Now();
      if (order->kind != RankOrder::Kind::kWork) {
        ReportClosed(team, {});
        return;
      }
    }
    if (Now() - told > 1.0) {
      told = Now();
      team.Report({});
    }
    std::this_thread::sleep_for(kTick);
  }
  team.Abort();
}

}  // namespace mjdiag
