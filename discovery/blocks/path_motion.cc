#include "mjdiag/discovery/blocks/path_motion.h"

#include <algorithm>

#include "mjdiag/plugin/machine/tick_map.h"
#include "mjdiag/plugin/plant/operating_point.h"
#include "mjdiag/plugin/plant/tangent_coordinates.h"
#include "mjdiag/plugin/replay/recorded_inputs.h"
#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

ObservedMotion MotionAlong(const Machine& machine, const MeasuredRun& run,
                           const FilterPath& path) {
  const mjModel& model = machine.plant();
  const Index nv = model.nv;
  const Index samples = path.samples();
  ObservedMotion motion;
  motion.sample_time = path.sample_time;
  motion.time = run.Time();
  motion.position.resize(nv, samples);
  motion.velocity.resize(nv, samples);
  motion.acceleration.resize(nv, samples);
  motion.outputs = run.outputs - path.innovations;
  const PlantState drawn{VectorXd::Map(model.qpos0, model.nq), VectorXd::Zero(nv),
                         VectorXd::Zero(model.na)};
  ParallelFor(static_cast<int>(path.first.size()), [&](int number) {
    const auto record = static_cast<std::size_t>(number);
    const Index first = path.first[record];
    const Machine during = DuringRecord(run.records[record], machine);
    TickMap map(during);
    RecordedInputs inputs(during, run);
    VectorXd forces = VectorXd::Zero(nv);
    for (Index k = first; k < first + run.SamplesOf(record); ++k) {
      const PlantState& state = path.states[static_cast<std::size_t>(k)];
      motion.position.col(k) = Deviation(model, drawn, state).head(nv);
      motion.velocity.col(k) = state.velocity;
      forces(path.dofs) = path.forces.col(k);
      inputs.StayAt(k);
      const Index tick = run.TickOf(k);
      motion.acceleration.col(k) =
          (map.Run(state, forces, tick, inputs).state.velocity - state.velocity) /
          path.sample_time;
    }
  });
  Eigen::MatrixXd position(model.nq, samples);
  for (Index k = 0; k < samples; ++k) {
    position.col(k) = path.states[static_cast<std::size_t>(k)].position;
  }
  // Latent forces are forces of a tick like any other: a mass that is another one makes
  // another thing of them, too.
  motion.own_acceleration = motion.acceleration;
  motion.inputs = InputsThatAct(machine, run, position, motion.velocity);
  const std::vector<int>& actuators = machine.actuator_addresses();
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    const int activation = ActivationOf(model, actuators[i]);
    if (activation < 0) continue;
    for (Index k = 0; k < samples; ++k) {
      motion.inputs(static_cast<Index>(i), k) =
          path.states[static_cast<std::size_t>(k)].activation[activation];
    }
  }
  return motion;
}

}  // namespace mjdiag
