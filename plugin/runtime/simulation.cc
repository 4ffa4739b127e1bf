#include "mjdiag/plugin/runtime/simulation.h"

#include <memory>
#include <vector>

#include "mjdiag/plugin/runtime/late_faults.h"
#include "mjdiag/plugin/runtime/running_machine.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr Eigen::Index kTicksBetweenProgress = 512;

/// All ticks of the excitation, with what becomes of the machine in their course.
Record RunThrough(RunningMachine& running, const std::vector<MachineStage>& stages,
                  Eigen::Index ticks, const RunOptions& options) {
  auto stage = stages.begin();
  for (Eigen::Index tick = 0; tick < ticks; ++tick) {
    for (; stage != stages.end() && stage->tick <= tick; ++stage) {
      running.Become(stage->machine, stage->ticks);
    }
    running.Tick();
    if (options.progress && tick % kTicksBetweenProgress == 0) {
      options.progress(static_cast<double>(tick) / static_cast<double>(ticks));
    }
  }
  return running.ToRecord();
}

}  // namespace

void CheckMode(const Control& control, ControlMode mode) {
  if (mode == ControlMode::kBoth) return;
  for (const AxisSetup& axis : control.axes) {
    if (!axis.nested) continue;
    throw InputError("mode", "axis '" + axis.name + "' has nested loops only",
                     "both; they have no feedforward");
  }
}

Record Simulate(const Machine& machine, const Excitation& excitation,
                const RunOptions& options) {
  const std::unique_ptr<RunningMachine> running =
      StartNonlinear(machine, excitation, options);
  return RunThrough(*running, StagesOf(machine, options.late_faults),
                    excitation.samples(), options);
}

Record SimulateLinear(const Machine& machine, const Excitation& excitation,
                      const RunOptions& options) {
  const std::unique_ptr<RunningMachine> running =
      StartLinear(machine, excitation, options);
  return RunThrough(*running, StagesOf(machine, options.late_faults),
                    excitation.samples(), options);
}

}  // namespace mjdiag
