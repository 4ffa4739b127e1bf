#include "mjdiag/plugin/replay/tracking.h"

#include <algorithm>
#include <functional>

#include "mjdiag/plugin/plant/tangent.h"
#include "mjdiag/plugin/effects/active_effect.h"
#include "mjdiag/plugin/effects/trial_signals.h"
#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/scenery.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/plugin/plant/start_state.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

Eigen::RowVectorXd Samples(const Record& measured, const std::string& name,
                           const std::string& unit) {
  const Channel& channel = measured.At(name);
  if (channel.unit != unit) {
    throw InputError("record", "channel '" + name + "' is in '" + channel.unit + "'",
                     unit + "; a column under [record.channels] may give the unit");
  }
  return channel.samples.transpose();
}

/// Where dry friction in the joints is the only constraint there are as many unknown
/// forces as joints that rub, next to uncoupled, and projected Gauss-Seidel finds them
/// in a few sweeps, closer than Newton's default tolerance and in half of its time.
void ChooseSolver(mjModel& model) {
  const bool limited = std::any_of(model.jnt_limited, model.jnt_limited + model.njnt,
                                   [](mjtByte is) { return is != 0; }) ||
                       model.ntendon > 0;
  const bool contacts =
      model.ngeom > 0 && (model.opt.disableflags & mjDSBL_CONTACT) == 0;
  if (model.neq == 0 && !limited && !contacts) model.opt.solver = mjSOL_PGS;
}

/// Called after every substep and every tick.
struct Watch {
  std::function<void(const mjModel&, const mjData&)> substep;
  std::function<void()> tick;
};

Track Follow(const Setup& setup, const mjModel& plant, const Changes& changes,
             const MeasuredRun& run, const Observer& observer, bool states,
             const Watch& watch) {
  const ModelPtr model = ChangedPlant(plant, changes.faults, changes.effects);
  const VectorXd start = StartPosition(setup, *model, run.start);
  DropScenery(*model);
  ChooseSolver(*model);
  const DataPtr data = MakeData(*model);
  std::copy(start.begin(), start.end(), data->qpos);
  ActiveEffects effects(setup, *model, changes.effects);
  const std::vector<int> sensors = SensorAddresses(setup, *model);
  const std::vector<int> actuators = ActuatorAddresses(setup, *model);

  const Index n = run.samples();
  const Index nv = model->nv;
  Track track;
  track.innovations.resize(run.outputs.rows(), n);
  if (states) {
    track.position.resize(nv, n);
    track.velocity.resize(nv, n);
  }
  Eigen::Map<VectorXd> q(data->qpos, nv);
  Eigen::Map<VectorXd> v(data->qvel, nv);
  VectorXd reading(run.outputs.rows());
  VectorXd correction(2 * nv);
  for (Index k = 0; k < n; ++k) {
    for (int substep = 0; substep < setup.substeps; ++substep) {
      mj_step1(model.get(), data.get());
      if (substep == 0) {
        for (std::size_t i = 0; i < sensors.size(); ++i) {
          reading[static_cast<Index>(i)] = data->sensordata[sensors[i]];
        }
        effects.Distort({reading.data(), sensors.size()},
                        static_cast<double>(k) * run.sample_time);
        track.innovations.col(k) = run.outputs.col(k) - reading;
        if (states) {
          track.position.col(k) = q;
          track.velocity.col(k) = v;
        }
      }
      for (std::size_t i = 0; i < actuators.size(); ++i) {
        data->ctrl[actuators[i]] = run.inputs(static_cast<Index>(i), k);
      }
      effects.Act(*model, *data);
      mj_step2(model.get(), data.get());
      if (watch.substep) watch.substep(*model, *data);
    }
    if (HasDiverged(*data)) {
      throw NumericalError("replay: diverged at " +
                           std::to_string(static_cast<double>(k) * run.sample_time) +
                           " s");
    }
    if (watch.tick) watch.tick();
    correction.noalias() = observer.L * track.innovations.col(k);
    q += correction.head(nv);
    v += correction.tail(nv);
  }
  return track;
}

}  // namespace

MeasuredRun ToMeasuredRun(const Setup& setup, const Record& measured) {
  MeasuredRun run;
  run.sample_time = setup.sample_time();
  run.start = Replay(setup, measured).start;
  run.outputs.resize(static_cast<Index>(setup.sensors.size()), measured.samples());
  run.inputs.resize(static_cast<Index>(setup.actuators.size()), measured.samples());
  for (Index i = 0; i < run.outputs.rows(); ++i) {
    const SensorSetup& sensor = setup.sensors[static_cast<std::size_t>(i)];
    run.outputs.row(i) = Samples(measured, sensor.channel, sensor.unit);
  }
  for (Index i = 0; i < run.inputs.rows(); ++i) {
    const ActuatorSetup& actuator = setup.actuators[static_cast<std::size_t>(i)];
    run.inputs.row(i) = Samples(measured, actuator.channel, actuator.unit);
  }
  return run;
}

Track FollowRun(const Setup& setup, const mjModel& plant, const Changes& changes,
                const MeasuredRun& run, const Observer& observer, bool states) {
  return Follow(setup, plant, changes, run, observer, states, {});
}

Track FollowRun(const Setup& setup, const mjModel& plant, const Changes& changes,
                const MeasuredRun& run, const Observer& observer,
                const MechanicalModel& model, ErrorDynamics& dynamics) {
  TangentRecorder recorder(plant, model);
  const Watch watch{[&recorder](const mjModel& changed, const mjData& data) {
                      recorder.Substep(changed, data);
                    },
                    [&] { dynamics.Add(recorder.EndTick()); }};
  return Follow(setup, plant, changes, run, observer, true, watch);
}

ObservedMotion ObserveMotion(const mjModel& plant, const MeasuredRun& run,
                             const Track& track) {
  ObservedMotion motion;
  motion.sample_time = run.sample_time;
  const Eigen::Map<const VectorXd> rest(plant.qpos0, plant.nv);
  motion.position = track.position.colwise() - rest;
  motion.velocity = track.velocity;
  motion.acceleration = CentralDifferences(track.velocity, run.sample_time);
  motion.inputs = run.inputs;
  motion.outputs = run.outputs;
  return motion;
}

}  // namespace mjdiag
