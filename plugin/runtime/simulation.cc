#include "mjdiag/plugin/runtime/simulation.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/machine/stepper.h"
#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/start_state.h"
#include "mjdiag/plugin/runtime/instance.h"
#include "mjdiag/plugin/runtime/late_faults.h"
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

/// The exact map of a tick, about the rest.
struct LinearPlant {
  StateSpace tick;
  Eigen::VectorXd rest;          // nq
  Eigen::VectorXd rest_reading;  // ny
};

LinearPlant LinearPlantOf(const Machine& machine) {
  const Rates& rates = machine.rates();
  return {TickModel(machine.linear(), rates.step(), rates.substeps), machine.rest(),
          SensorReadings(machine.channels(), machine.plant(), machine.rest())};
}

/// The linear plant has the motors in it as they are when they are on.
void CheckAlwaysOn(const Setup& setup, const Excitation& excitation) {
  for (const std::string& name : setup.channels.Switches()) {
    const Channel* on = excitation.inputs.Find(name);
    if (on == nullptr || (on->samples.array() != 0.0).all()) continue;
    throw InputError("channel '" + name + "'", "switches actuators off",
                     "actuators that stay on, or the nonlinear plant");
  }
}

/// The map of a tick takes what the inputs are on average.
void AddMeanCourse(const TickLoop& loop, int substeps, Eigen::VectorXd& inputs) {
  for (Eigen::Index i = 0; i < inputs.size(); ++i) {
    double sum = 0.0;
    for (int step = 0; step < substeps; ++step) {
      sum += loop.Above(static_cast<std::size_t>(i), step);
    }
    inputs[i] += sum / substeps;
  }
}

void CheckNotEmpty(const Excitation& excitation) {
  if (excitation.samples() == 0) {
    throw InputError("excitation", "no samples", "at least one control tick");
  }
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
  CheckNotEmpty(excitation);
  const std::vector<MachineStage> stages = StagesOf(machine, options.late_faults);
  auto stage = stages.begin();
  const StartedPlant plant = StartPlant(machine, excitation.start);
  const mjModel& model = *plant.model;
  mjData& data = *plant.data;
  Instance instance(machine, excitation, options);
  Attach(model, data, instance);
  const Eigen::Index ticks = excitation.samples();
  for (Eigen::Index tick = 0; tick < ticks; ++tick) {
    for (; stage != stages.end() && stage->tick <= tick; ++stage) {
      CopyFaults(stage->machine.plant(), *plant.model);
    }
    for (int substep = 0; substep < machine.rates().substeps; ++substep) {
      mj_step(&model, &data);
    }
    if (HasDiverged(data)) {
      ReportDivergence(model, data, static_cast<double>(tick) * machine.rates().tick());
    }
    ReportProgress(options, tick, ticks);
  }
  if (instance.loop().ticks_done() != ticks) {
    throw NumericalError("simulation: somebody took the control callback off");
  }
  return instance.ToRecord(model);
}

Record SimulateLinear(const Machine& machine, const Excitation& excitation,
                      const RunOptions& options) {
  CheckNotEmpty(excitation);
  if (!machine.changes().effects.empty()) {
    throw InputError("effect", "the linear plant has no effects",
                     "faults only, or the nonlinear plant");
  }
  const std::vector<PlacedEffect> carried = machine.effects();
  const bool beside =
      std::any_of(carried.begin(), carried.end(), [](const PlacedEffect& placed) {
        return placed.effect->form() != Form::kAttributes;
      });
  if (beside && !options.linear_part) {
    throw InputError(machine.plant().names,
                     "the plant carries effects, which are not linear",
                     "a plant without, or the nonlinear plant");
  }
  CheckAlwaysOn(machine.setup(), excitation);
  const std::vector<MachineStage> stages = StagesOf(machine, options.late_faults);
  auto stage = stages.begin();
  LinearPlant plant = LinearPlantOf(machine);
  const std::vector<std::string>& joint_names = machine.linear().coordinates;
  const auto nq = static_cast<Eigen::Index>(joint_names.size());
  const Eigen::Index ticks = excitation.samples();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * nq);
  x.head(nq) =
      StartPosition(machine.channels(), machine.plant(), plant.rest, excitation.start) -
      plant.rest;
  Eigen::VectorXd next(2 * nq);
  Eigen::VectorXd y(plant.rest_reading.size());
  Eigen::VectorXd u = Eigen::VectorXd::Zero(plant.tick.inputs());
  Eigen::MatrixXd joints(options.log_joints ? nq : 0, ticks);

  TickLoop loop(machine.setup(), excitation, options);
  for (Eigen::Index tick = 0; tick < ticks; ++tick) {
    for (; stage != stages.end() && stage->tick <= tick; ++stage) {
      LinearPlant worn = LinearPlantOf(stage->machine);
      x.head(nq) += plant.rest - worn.rest;
      plant = std::move(worn);
    }
    y.noalias() = plant.tick.C * x;
    y += plant.rest_reading;
    if (options.log_joints) joints.col(tick) = plant.rest + x.head(nq);
    loop.Tick({y.data(), static_cast<std::size_t>(y.size())},
              {u.data(), static_cast<std::size_t>(u.size())});
    AddMeanCourse(loop, machine.rates().substeps, u);
    next.noalias() = plant.tick.A * x;
    next.noalias() += plant.tick.B * u;
    x.swap(next);
    if (Eigen::Index worst = 0; !(x.cwiseAbs().maxCoeff(&worst) < mjMAXVAL)) {
      throw NumericalError(
          "simulation: linear plant diverged at " +
          std::to_string(static_cast<double>(tick) * machine.rates().tick()) +
          " s in joint '" + joint_names[static_cast<std::size_t>(worst % nq)] + "'");
    }
    ReportProgress(options, tick, ticks);
  }
  Record record = loop.ToRecord();
  for (Eigen::Index j = 0; j < joints.rows(); ++j) {
    record.Add(JointChannel(machine.plant(), static_cast<int>(j), joints.row(j)));
  }
  return record;
}

}  // namespace mjdiag
