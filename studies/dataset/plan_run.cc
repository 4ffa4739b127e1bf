#include "mjdiag/studies/dataset/plan_run.h"

#include <chrono>
#include <mutex>
#include <utility>
#include <vector>

#include "mjdiag/plugin/runtime/threads.h"
#include "mjdiag/signals/text_file.h"
#include "mjdiag/studies/dataset/dataset_file.h"
#include "mjdiag/studies/dataset/plan_identity.h"
#include "mjdiag/studies/dataset/run_journals.h"
#include "mjdiag/studies/growing_table.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// Tells how far it is, one thread at a time.
class Teller {
 public:
  Teller(const PlanRunOptions& options, PlanProgress begin)
      : options_(options), progress_(begin), start_(Clock::now()) {}

  void Say(const char* doing) {
    const std::lock_guard lock(mutex_);
    progress_.doing = doing;
    Tell();
  }
  void RunDone() {
    const std::lock_guard lock(mutex_);
    ++progress_.done;
    Tell();
  }
  void Made(std::int64_t runs, const char* doing) {
    const std::lock_guard lock(mutex_);
    progress_.done = progress_.found + runs;
    progress_.doing = doing;
    Tell();
  }
  const PlanProgress& progress() const { return progress_; }

 private:
  void Tell() {
    progress_.seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    if (options_.progress) options_.progress(progress_);
  }

  const PlanRunOptions& options_;
  std::mutex mutex_;
  PlanProgress progress_;
  Clock::time_point start_;
};

void Forget(const fs::path& folder) {
  RunJournals::Remove(folder);
  fs::remove(folder / "dataset.h5");
}

/// The runs that are missing.
class MissingRuns {
 public:
  MissingRuns(const PlanRunOptions& options, RunWork& work, RunJournals& journals,
              std::uint64_t study, std::vector<std::int64_t> open, Teller& teller)
      : options_(options),
        work_(work),
        journals_(journals),
        study_(study),
        open_(std::move(open)),
        teller_(teller) {}

  void Make() {
    teller_.Say("healthy runs");
    if (options_.team != nullptr) MakeWithOthers();
    if (!open_.empty()) OnThreads(options_.threads, [this] { MakeAlone(); });
  }

 private:
  void MakeOne(std::int64_t index) { journals_.Add(index, work_.Do(index)); }

  void MakeAlone() {
    work_.Prepare([this](double) { teller_.Say("healthy runs"); });
    teller_.Say("runs");
    ParallelInOrder(static_cast<int>(open_.size()), [this](int i) {
      MakeOne(open_[static_cast<std::size_t>(i)]);
      teller_.RunDone();
    });
  }

  void MakeWithOthers() {
    LeadOptions lead;
    lead.open = open_;
    lead.runs = work_.loaded().plan.Runs();
    lead.study = study_;
    lead.patience = options_.patience;
    lead.tell = [this](std::int64_t made, bool prepared) {
      teller_.Made(made, prepared ? "runs" : "healthy runs");
    };
    lead.note = options_.note;
    RunPool pool(options_.threads, {[this](const std::function<void()>& check) {
                                      work_.Prepare([&](double) { check(); });
                                    },
                                    [this](std::int64_t run) { MakeOne(run); }});
    LeadRuns(*options_.team, pool, lead);
    options_.team->End();
    journals_.ReadOthers();
    // What a computer had not yet written when it died.
    std::erase_if(open_, [this](std::int64_t run) {
      return journals_.Has(run, work_.loaded().plan.keep.Series());
    });
    if (open_.empty()) return;
    teller_.Made(static_cast<std::int64_t>(lead.open.size() - open_.size()), "runs");
    options_.note(std::to_string(open_.size()) +
                  " runs that were made are not in the folder: made again here. Do all "
                  "ranks share it?");
  }

  const PlanRunOptions& options_;
  RunWork& work_;
  RunJournals& journals_;
  std::uint64_t study_;
  std::vector<std::int64_t> open_;
  Teller& teller_;
};

}  // namespace

double PlanProgress::RunsASecond() const {
  return seconds > 0.0 ? static_cast<double>(done - found) / seconds : 0.0;
}

std::optional<double> PlanProgress::SecondsLeft() const {
  const double rate = RunsASecond();
  if (!(rate > 0.0)) return std::nullopt;
  return static_cast<double>(total - done) / rate;
}

PlanOutcome RunPlan(const LoadedPlan& loaded, const PlanRunOptions& options) {
  const auto work = std::make_shared<RunWork>(loaded);
  MakeOutputFolder(options.folder);
  if (options.restart) Forget(options.folder);
  const std::int64_t runs = loaded.plan.Runs();
  const std::string identity = PlanIdentity(loaded);
  RunJournals journals(options.folder, identity, runs);
  WriteTextFile(options.folder / "plan.toml", loaded.plan.text);

  const fs::path dataset = options.folder / "dataset.h5";
  const bool is_written = fs::exists(dataset);
  const bool series = loaded.plan.keep.Series() && !is_written;
  std::vector<std::int64_t> open;
  for (std::int64_t i = 0; i < runs; ++i) {
    if (!journals.Has(i, series)) open.push_back(i);
  }
  PlanProgress begin;
  begin.total = runs;
  begin.done = begin.found = runs - static_cast<std::int64_t>(open.size());
  Teller teller(options, begin);
  const bool is_complete = open.empty();
  if (!is_complete) {
    MissingRuns(options, *work, journals, ChecksumOf(identity), std::move(open), teller)
        .Make();
  }
  if (options.team != nullptr) options.team->End();
  PlanOutcome outcome{work, {}, std::nullopt, {}};
  if (WritesDatasets()) {
    if (!is_complete || !is_written) {
      teller.Say("data set");
      WriteDataset(
          dataset, *work,
          {[&](std::int64_t i) -> const RunResult& { return journals.Result(i); },
           [&](std::int64_t i) { return journals.ReadSeries(i); }});
    }
    outcome.dataset = dataset;
  }
  journals.Settle();
  outcome.results.reserve(static_cast<std::size_t>(runs));
  for (std::int64_t i = 0; i < runs; ++i) outcome.results.push_back(journals.Result(i));
  outcome.progress = teller.progress();
  return outcome;
}

}  // namespace mjdiag
