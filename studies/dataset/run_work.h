#pragma once
// The work of a plan: what is kept of a run, from its number alone. MPI ranks, threads
// or a loop may share the numbers out as they like.

#include <functional>
#include <memory>

#include "mjdiag/plugin/design/diagnosis.h"
#include "mjdiag/studies/dataset/dataset_layout.h"
#include "mjdiag/studies/dataset/run_result.h"
#include "mjdiag/studies/plan/planned_run.h"

namespace mjdiag {

class RunWork {
 public:
  /// The plan must outlive it. InputError as LayoutOf.
  explicit RunWork(const LoadedPlan& loaded);

  /// Filters and limits of the plan's machine, if what is kept asks for them: once, before
  /// the first run. A run is diagnosed as the machine of the setup, which knows nothing of
  /// what was drawn.
  void Prepare(const std::function<void(double fraction)>& progress = {});

  /// From any thread. A run that diverges is a result.
  RunResult Do(std::int64_t index) const;

  const LoadedPlan& loaded() const { return loaded_; }
  const RunPlanner& planner() const { return planner_; }
  const RunMaker& maker() const { return maker_; }
  const DatasetLayout& layout() const { return layout_; }

 private:
  void KeepVerdict(const Diagnosis& diagnosis, RunResult& result) const;

  const LoadedPlan& loaded_;
  RunPlanner planner_;
  RunMaker maker_;
  DatasetLayout layout_;
  std::unique_ptr<PreparedDiagnosis> prepared_;
};

}  // namespace mjdiag
