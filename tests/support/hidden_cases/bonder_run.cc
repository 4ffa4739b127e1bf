#include "support/hidden_cases/bonder_run.h"

#include "mjdiag/plugin/runtime/tick_loop.h"
#include "support/hidden_cases/own_simulator.h"

namespace mjdiag::test {

Record MeasureOwn(const Machine& machine, const HiddenPhysics& hidden,
                  const Trajectory& motion, const Measurement& how) {
  RunOptions options;
  options.seed = how.seed;
  options.noise_scale = how.noise_scale;
  const Excitation excitation = FollowTrajectory(machine.setup(), motion);
  TickLoop computer(machine.setup(), excitation, options);
  RunOwn(machine, hidden, computer, {excitation.samples(), how.steps, {}});
  return computer.ToRecord();
}

}  // namespace mjdiag::test
