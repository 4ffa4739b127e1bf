#include "mjdiag/plugin/runtime/simulation.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/runtime/instance.h"
#include "mjdiag/plugin/plant/linearize.h"
#include "mjdiag/plugin/effects/native_effect.h"
#include "mjdiag/plugin/plant/scenery.h"
#include "mjdiag/plugin/plant/start_state.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr Eigen::Index kTicksBetweenProgress = 512;

int JointOfPosition(const mjModel& model, int address) {
  int joint = model.njnt - 1;
  while (joint > 0 && model.jnt_qposadr[joint] > address) --joint;
  return joint;
}

[[noreturn]] void ReportDivergence(const mjModel& model, const mjData& data,
                                   double time) {
  std::string where = "the controls";
  for (const int kind : {mjWARN_BADQACC, mjWARN_BADQVEL, mjWARN_BADQPOS}) {
    if (data.warning[kind].number == 0) continue;
    const int last = data.warning[kind].lastinfo;
    const int joint =
        kind == mjWARN_BADQPOS ? JointOfPosition(model, last) : model.dof_jntid[last];
    where = "joint '" + ElementName(model, mjOBJ_JOINT, joint) + "'";
  }
  throw NumericalError("simulation: diverged at " + std::to_string(time) + " s in " +
                       where);
}

void ReportProgress(const RunOptions& options, Eigen::Index tick, Eigen::Index ticks) {
  if (options.progress && tick % kTicksBetweenProgress == 0) {
    options.progress(static_cast<double>(tick) / static_cast<double>(ticks));
  }
}

void CheckNotEmpty(const Excitation& excitation) {
  if (excitation.samples() == 0) {
    throw InputError("excitation", "no samples", "at least one control tick");
  }
}

}  // namespace

void CheckTimeStep(const Setup& setup, const mjModel& model) {
  if (model.opt.integrator != mjINT_EULER && model.opt.integrator != mjINT_IMPLICIT) {
    throw InputError(setup.plant.string(),
                     "an integrator that takes several looks a step",
                     "integrator=\"Euler\" or \"implicit\"");
  }
  const double step = setup.sample_time() / setup.substeps;
  if (std::abs(model.opt.timestep / step - 1.0) > 1e-9) {
    throw InputError(setup.plant.string(),
                     "time step " + std::to_string(model.opt.timestep * 1e6) + " us",
                     std::to_string(step * 1e6) +
                         " us, the control tick of the setup over its substeps");
  }
}

void CheckMode(const Setup& setup, ControlMode mode) {
  if (mode == ControlMode::kBoth) return;
  for (const AxisSetup& axis : setup.axes) {
    if (!axis.nested) continue;
    throw InputError("mode", "axis '" + axis.name + "' has nested loops only",
                     "both; they have no feedforward");
  }
}

void PreparePlant(const Setup& setup, mjModel& model) {
  if (!setup.gravity) model.opt.disableflags |= mjDSBL_GRAVITY;
  if (!setup.static_friction) {
    // The plant's own; friction that an effect adds stays.
    std::fill_n(model.dof_frictionloss, model.nv, 0.0);
    std::fill_n(model.tendon_frictionloss, model.ntendon, 0.0);
  }
  for (const EffectSpec& effect : EffectsOf(model)) ApplyNativeEffect(model, effect);
  ReserveInstanceSlot(model);
}

ModelPtr LoadPlant(const Setup& setup) {
  ModelPtr model = LoadModel(setup.plant);
  CheckTimeStep(setup, *model);
  PreparePlant(setup, *model);
  SensorAddresses(setup, *model);
  ActuatorAddresses(setup, *model);
  FaultKnobs(*model);
  return model;
}

ModelPtr ChangedPlant(const mjModel& plant, const std::vector<Fault>& faults,
                      const std::vector<EffectSpec>& effects) {
  ModelPtr model = CopyModel(plant);
  for (const Fault& fault : faults) ApplyFault(*model, fault);
  for (const EffectSpec& effect : effects) ApplyNativeEffect(*model, effect);
  return model;
}

// Only the warning counters tell.
bool HasDiverged(const mjData& data) {
  return data.warning[mjWARN_BADQPOS].number > 0 ||
         data.warning[mjWARN_BADQVEL].number > 0 ||
         data.warning[mjWARN_BADQACC].number > 0 ||
         data.warning[mjWARN_BADCTRL].number > 0;
}

Record Simulate(const Setup& setup, const mjModel& plant, const Excitation& excitation,
                const RunOptions& options) {
  CheckNotEmpty(excitation);
  const ModelPtr model = ChangedPlant(plant, options.faults, options.effects);
  const Eigen::VectorXd start = StartPosition(setup, *model, excitation.start);
  DropScenery(*model);
  const DataPtr data = MakeData(*model);
  std::copy(start.begin(), start.end(), data->qpos);

  Instance instance(setup, *model, excitation, options);
  Attach(*model, *data, instance);
  const Eigen::Index ticks = excitation.samples();
  for (Eigen::Index tick = 0; tick < ticks; ++tick) {
    for (int substep = 0; substep < setup.substeps; ++substep) {
      mj_step(model.get(), data.get());
    }
    if (HasDiverged(*data)) {
      ReportDivergence(*model, *data, static_cast<double>(tick) * setup.sample_time());
    }
    ReportProgress(options, tick, ticks);
  }
  if (instance.loop().ticks_done() != ticks) {
    throw NumericalError("simulation: somebody took the control callback off");
  }
  return instance.ToRecord(*model);
}

Record SimulateLinear(const Setup& setup, const mjModel& plant,
                      const Excitation& excitation, const RunOptions& options) {
  CheckNotEmpty(excitation);
  if (!options.effects.empty()) {
    throw InputError("effect", "the linear plant has no effects",
                     "faults only, or the nonlinear plant");
  }
  const ModelPtr model = ChangedPlant(plant, options.faults, options.effects);
  const std::vector<EffectSpec> carried = EffectsOf(*model);
  if (std::any_of(carried.begin(), carried.end(), [](const EffectSpec& effect) {
        return !FindEffect(effect.effect).native;
      })) {
    throw InputError(model->names, "the plant carries effects, which are not linear",
                     "a plant without, or the nonlinear plant");
  }
  const MechanicalModel machine = Linearize(*model, setup);
  const StateSpace tick_model =
      TickModel(machine, setup.sample_time() / setup.substeps, setup.substeps);
  const Eigen::VectorXd rest = StaticEquilibrium(*model);
  const Eigen::VectorXd rest_reading = SensorReadings(setup, *model, rest);

  const Eigen::Index nq = machine.M.rows();
  const Eigen::Index ticks = excitation.samples();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * nq);
  x.head(nq) = StartPosition(setup, *model, excitation.start) - rest;
  Eigen::VectorXd next(2 * nq);
  Eigen::VectorXd y(rest_reading.size());
  Eigen::VectorXd u = Eigen::VectorXd::Zero(tick_model.inputs());
  Eigen::MatrixXd joints(options.log_joints ? nq : 0, ticks);

  TickLoop loop(setup, excitation, options);
  for (Eigen::Index tick = 0; tick < ticks; ++tick) {
    y.noalias() = tick_model.C * x;
    y += rest_reading;
    if (options.log_joints) joints.col(tick) = rest + x.head(nq);
    loop.Tick({y.data(), static_cast<std::size_t>(y.size())},
              {u.data(), static_cast<std::size_t>(u.size())});
    next.noalias() = tick_model.A * x;
    next.noalias() += tick_model.B * u;
    x.swap(next);
    if (Eigen::Index worst; !(x.cwiseAbs().maxCoeff(&worst) < mjMAXVAL)) {
      throw NumericalError(
          "simulation: linear plant diverged at " +
          std::to_string(static_cast<double>(tick) * setup.sample_time()) +
          " s in joint '" + machine.coordinates[worst % nq] + "'");
    }
    ReportProgress(options, tick, ticks);
  }
  Record record = loop.ToRecord();
  for (Eigen::Index j = 0; j < joints.rows(); ++j) {
    record.Add(JointChannel(*model, static_cast<int>(j), joints.row(j)));
  }
  return record;
}

}  // namespace mjdiag
