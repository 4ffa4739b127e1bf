#pragma once
// A study of one's own, from its plan to its data set, in a folder:
//
//   plan.toml      the plan
//   runs.journal   the results of all runs that are finished (run_journals.h)
//   dataset.h5     the data set (dataset_file.h), once all are
//
// Whoever runs the same plan in the same folder goes on where it ended, be it that it was
// killed; what comes out has the same bits, whatever the number of threads, and of ranks.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "mjdiag/studies/cluster/shared_runs.h"
#include "mjdiag/studies/dataset/run_work.h"

namespace mjdiag {

/// How far a study is.
struct PlanProgress {
  std::int64_t done = 0;   ///< runs that are finished
  std::int64_t found = 0;  ///< of these, those that were there when it began
  std::int64_t total = 0;
  double seconds = 0.0;    ///< since it began
  const char* doing = "";  ///< "healthy runs", "runs", "data set"

  /// Of the runs that were made now; 0 before the first.
  double RunsASecond() const;
  /// Until all runs are done [s]; none before one is.
  std::optional<double> SecondsLeft() const;
};

struct PlanRunOptions {
  std::filesystem::path folder;
  bool restart = false;  ///< forget what is there
  /// May be called from any thread, one at a time; what it throws ends the study, which
  /// can go on later.
  std::function<void(const PlanProgress&)> progress{};
  int threads = 0;  ///< that make runs; 0: as many as there are cores for this process

  // With other ranks (studies/cluster/), of which this process is the first.

  RankTeam* team = nullptr;         ///< none: alone
  double patience = kRankPatience;  ///< with a rank that does not answer [s]
  /// What became of a rank, in a line.
  std::function<void(const std::string& line)> note = [](const std::string&) {};
};

/// Results by number of the run.
struct PlanOutcome {
  std::shared_ptr<const RunWork> work;
  std::vector<RunResult> results;                ///< without series
  std::optional<std::filesystem::path> dataset;  ///< none: built without HDF5
  PlanProgress progress;                         ///< at the end
};

/// InputError if the folder holds another study, or cannot be written to.
PlanOutcome RunPlan(const LoadedPlan& loaded, const PlanRunOptions& options);

/// What another rank than the first does of it, till the first ends the job. `progress` is
/// called now and then; when it throws, this rank makes no more runs. What goes wrong is
/// told to the first.
void ServePlan(const std::filesystem::path& plan, const PlanRunOptions& options);

}  // namespace mjdiag
