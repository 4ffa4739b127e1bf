#pragma once
// The machine of a planned run, and the run itself.

#include <string>
#include <utility>
#include <vector>

#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/studies/plan/planned_run.h"

namespace mjdiag {

/// The machine of the plan with numbers of its setup that are others. InputError as
/// ReadSetup.
Machine MachineWithKeys(const StudyPlan& plan, const Machine& machine,
                        const std::vector<std::pair<std::string, double>>& keys);

/// What runs, and how.
struct ReadyRun {
  Machine machine;
  Excitation motion;
  RunOptions options;
};

/// Runs of a plan. Made once; its methods may be called from any thread.
class RunMaker {
 public:
  /// The plan must outlive it. InputError as SampleTrajectory, ReadMeasured and Replay.
  explicit RunMaker(const LoadedPlan& plan);

  /// InputError where setup or plant do not take the values.
  ReadyRun Make(const PlannedRun& run) const;
  /// The record of the run. NumericalError if it diverges.
  Record Simulate(const PlannedRun& run) const;
  Record Simulate(const ReadyRun& ready) const;

  /// Of the longest run [ticks].
  Eigen::Index longest() const { return longest_; }
  /// Of the machine's own motions, in the order of the plan.
  const std::vector<Excitation>& motions() const { return motions_; }

 private:
  Excitation MotionOf(const Setup& setup, std::size_t motion) const;

  const LoadedPlan& loaded_;
  std::vector<Record> records_;  // of motions that are replayed; others have none
  std::vector<Excitation> motions_;
  Eigen::Index longest_ = 0;
};

}  // namespace mjdiag
