// A rank above 0: makes the runs that it is given, into a journal of its own.

#include <optional>

#include "mjdiag/studies/dataset/plan_identity.h"
#include "mjdiag/studies/dataset/plan_run.h"
#include "mjdiag/studies/dataset/run_journals.h"

namespace mjdiag {
namespace {

/// Rank 0 reads its journals, then others may begin [s].
constexpr double kLongestBeginning = 1800.0;

class Member {
 public:
  Member(const std::filesystem::path& plan, const PlanRunOptions& options)
      : loaded_(ReadPlan(plan)),
        identity_(PlanIdentity(loaded_)),
        work_(loaded_),
        journal_(std::in_place,
                 RunJournals::FileOf(options.folder, options.team->rank()), identity_,
                 loaded_.plan.Runs()),
        options_(options) {}

  void MakeRunsAndClose() {
    std::vector<std::int64_t> done;
    {
      RunPool pool(options_.threads,
                   {[this](const std::function<void()>& check) {
                      work_.Prepare([&](double) { check(); });
                    },
                    [this](std::int64_t run) { journal_->Add(run, work_.Do(run)); }});
      done = MakeRuns(*options_.team, pool, ChecksumOf(identity_), options_.patience,
                      [this] { return IsAskedToEnd(); });
    }
    journal_.reset();
    ReportClosed(*options_.team, done);
  }

 private:
  bool IsAskedToEnd() const {
    try {
      if (options_.progress) options_.progress({});
      return false;
    } catch (...) {
      return true;
    }
  }

  LoadedPlan loaded_;
  std::string identity_;
  RunWork work_;
  std::optional<RunJournal> journal_;
  const PlanRunOptions& options_;
};

}  // namespace

void ServePlan(const std::filesystem::path& plan, const PlanRunOptions& options) {
  RankTeam& team = *options.team;
  RankOrder order = team.AwaitOrder(kLongestBeginning);
  if (order.kind == RankOrder::Kind::kBegin) {
    std::optional<Member> member;
    try {
      member.emplace(plan, options);
    } catch (...) {
      ReportFailedBeginning(team, std::current_exception(), options.patience);
    }
    if (member) member->MakeRunsAndClose();
    order = team.AwaitOrder(2.0 * options.patience);
  }
  team.Leave(order);
}

}  // namespace mjdiag
