#include "mjdiag/studies/dataset/plan_run.h"

#include <chrono>
#include <mutex>
#include <vector>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"
#include "mjdiag/studies/dataset/dataset_file.h"
#include "mjdiag/studies/growing_table.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

/// All that the results depend on.
std::string Identity(const LoadedPlan& loaded) {
  const Setup& setup = loaded.machine.setup();
  std::string identity = MJDIAG_VERSION;
  for (const std::string& part :
       {loaded.plan.text, ReadTextFile(FindSetupFile(loaded.plan.setup)),
        ReadTextFile(setup.plant)}) {
    identity += "\n--- " + std::to_string(part.size()) + "\n" + part;
  }
  for (const PlanMotion& motion : loaded.plan.motions) {
    if (!motion.record.empty()) identity += "\n---\n" + ReadTextFile(motion.record);
  }
  if (setup.calibration) {
    for (const char* file : {"calibration.json", kCalibratedFilters}) {
      const fs::path path = setup.folder / file;
      if (fs::is_regular_file(path)) identity += "\n---\n" + ReadTextFile(path);
    }
  }
  return identity;
}

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
  RunJournal::Remove(folder / "runs.journal");
  fs::remove(folder / "dataset.h5");
}

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
  RunJournal journal(options.folder / "runs.journal", Identity(loaded), runs);
  WriteTextFile(options.folder / "plan.toml", loaded.plan.text);

  const fs::path dataset = options.folder / "dataset.h5";
  const bool is_written = fs::exists(dataset);
  const bool series = loaded.plan.keep.Series() && !is_written;
  std::vector<std::int64_t> open;
  for (std::int64_t i = 0; i < runs; ++i) {
    if (!journal.Has(i, series)) open.push_back(i);
  }
  PlanProgress begin;
  begin.total = runs;
  begin.done = begin.found = runs - static_cast<std::int64_t>(open.size());
  Teller teller(options, begin);
  if (!open.empty()) {
    teller.Say("healthy runs");
    work->Prepare([&](double) { teller.Say("healthy runs"); });
    teller.Say("runs");
    ParallelInOrder(static_cast<int>(open.size()), [&](int i) {
      const std::int64_t index = open[static_cast<std::size_t>(i)];
      journal.Add(index, work->Do(index));
      teller.RunDone();
    });
  }
  PlanOutcome outcome{work, {}, std::nullopt, {}};
  if (WritesDatasets()) {
    if (!open.empty() || !is_written) {
      teller.Say("data set");
      WriteDataset(
          dataset, *work,
          {[&](std::int64_t i) -> const RunResult& { return journal.Result(i); },
           [&](std::int64_t i) { return journal.ReadSeries(i); }});
    }
    if (journal.HoldsSeries()) journal.DropSeries();
    outcome.dataset = dataset;
  }
  outcome.results.reserve(static_cast<std::size_t>(runs));
  for (std::int64_t i = 0; i < runs; ++i) outcome.results.push_back(journal.Result(i));
  outcome.progress = teller.progress();
  return outcome;
}

}  // namespace mjdiag
