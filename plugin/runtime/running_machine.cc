#include "mjdiag/plugin/runtime/running_machine.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/machine/stepper.h"
#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/start_state.h"
#include "mjdiag/plugin/runtime/instance.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/wide_product.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

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

void CheckNotEmpty(const Excitation& excitation) {
  if (excitation.samples() == 0) {
    throw InputError("excitation", "no samples", "at least one control tick");
  }
}

class NonlinearRun final : public RunningMachine {
 public:
  NonlinearRun(const Machine& machine, const Excitation& excitation,
               const RunOptions& options)
      : rates_(machine.rates()),
        plant_(excitation.state ? StartPlant(machine, {})
                                : StartPlant(machine, excitation.start)),
        instance_(machine, excitation, options) {
    if (excitation.state) SetState(*plant_.model, *excitation.state, *plant_.data);
    Attach(*plant_.model, *plant_.data, instance_);
  }

  void Tick() override {
    if (becoming_ > 0) Wear();
    for (int substep = 0; substep < rates_.substeps; ++substep) {
      mj_step(plant_.model.get(), plant_.data.get());
    }
    ++tick_;
    if (HasDiverged(*plant_.data)) {
      ReportDivergence(*plant_.model, *plant_.data,
                       static_cast<double>(tick_ - 1) * rates_.tick());
    }
    if (instance_.loop().ticks_done() != tick_) {
      throw NumericalError("simulation: somebody took the control callback off");
    }
  }

  void Become(const Machine& machine, Index ticks) override {
    becoming_ = ticks;
    target_ = CopyModel(machine.plant());
    if (ticks == 0) CopyFaults(*target_, *plant_.model);
  }

  Record ToRecord() const override { return instance_.ToRecord(*plant_.model); }

 private:
  void Wear() noexcept {
    ApproachFaults(*target_, 1.0 / static_cast<double>(becoming_), *plant_.model);
    --becoming_;
  }

  Rates rates_;
  StartedPlant plant_;
  Instance instance_;
  ModelPtr target_;
  Index becoming_ = 0;  // ticks until it is that
  Index tick_ = 0;
};

/// The exact map of a tick, about the rest.
struct LinearPlant {
  StateSpace tick;
  VectorXd rest;          // nq
  VectorXd rest_reading;  // ny
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
void AddMeanCourse(const TickLoop& loop, int substeps, VectorXd& inputs) {
  for (Index i = 0; i < inputs.size(); ++i) {
    double sum = 0.0;
    for (int step = 0; step < substeps; ++step) {
      sum += loop.Above(static_cast<std::size_t>(i), step);
    }
    inputs[i] += sum / substeps;
  }
}

class LinearRun final : public RunningMachine {
 public:
  LinearRun(const Machine& machine, const Excitation& excitation,
            const RunOptions& options)
      : machine_(machine),
        plant_(LinearPlantOf(machine)),
        loop_(machine.setup(), excitation, options) {
    const Index nq = plant_.rest.size();
    x_ = VectorXd::Zero(2 * nq);
    x_.head(nq) = StartPosition(machine.channels(), machine.plant(), plant_.rest,
                                excitation.start) -
                  plant_.rest;
    y_ = VectorXd::Zero(plant_.rest_reading.size());
    u_ = VectorXd::Zero(plant_.tick.inputs());
    MakeMaps();
    joints_.resize(options.log_joints ? nq : 0, excitation.samples());
  }

  void Tick() override {
    if (becoming_ > 0) Wear();
    const Index nq = plant_.rest.size();
    WideProduct(from_x_, x_.data(), of_x_.data());
    y_ = of_x_.segment(x_.size(), y_.size()) + plant_.rest_reading;
    if (loop_.ticks_done() < joints_.cols() && joints_.rows() > 0) {
      joints_.col(loop_.ticks_done()) = plant_.rest + x_.head(nq);
    }
    loop_.Tick({y_.data(), static_cast<std::size_t>(y_.size())},
               {u_.data(), static_cast<std::size_t>(u_.size())});
    AddMeanCourse(loop_, machine_.rates().substeps, u_);
    WideProduct(from_u_, u_.data(), of_u_.data());
    x_ = of_x_.head(x_.size()) + of_u_.head(x_.size());
    if (Index worst = 0; !(x_.cwiseAbs().maxCoeff(&worst) < mjMAXVAL)) {
      const double time =
          static_cast<double>(loop_.ticks_done() - 1) * machine_.rates().tick();
      const std::string& joint =
          machine_.linear().coordinates[static_cast<std::size_t>(worst % nq)];
      throw NumericalError("simulation: linear plant diverged at " +
                           std::to_string(time) + " s in joint '" + joint + "'");
    }
  }

  void Become(const Machine& machine, Index ticks) override {
    becoming_ = ticks;
    target_ = LinearPlantOf(machine);
    if (ticks == 0) MoveTo(target_);
  }

  Record ToRecord() const override {
    Record record = loop_.ToRecord();
    for (Index j = 0; j < joints_.rows(); ++j) {
      record.Add(JointChannel(machine_.plant(), static_cast<int>(j),
                              joints_.row(j).head(record.samples())));
    }
    return record;
  }

 private:
  /// Where it is stays where it is.
  void MoveTo(const LinearPlant& plant) {
    x_.head(plant.rest.size()) += plant_.rest - plant.rest;
    plant_ = plant;
    MakeMaps();
  }

  void Wear() {
    const double part = 1.0 / static_cast<double>(becoming_);
    x_.head(plant_.rest.size()) -= part * (target_.rest - plant_.rest);
    plant_.rest += part * (target_.rest - plant_.rest);
    plant_.rest_reading += part * (target_.rest_reading - plant_.rest_reading);
    plant_.tick.A += part * (target_.tick.A - plant_.tick.A);
    plant_.tick.B += part * (target_.tick.B - plant_.tick.B);
    plant_.tick.C += part * (target_.tick.C - plant_.tick.C);
    --becoming_;
    MakeMaps();
  }

  void MakeMaps() {
    const StateSpace& tick = plant_.tick;
    const Index rows = WideRows(tick.states() + tick.outputs());
    from_x_.setZero(rows, tick.states());
    from_x_.topRows(tick.states()) = tick.A;
    from_x_.middleRows(tick.states(), tick.outputs()) = tick.C;
    from_u_.setZero(rows, tick.inputs());
    from_u_.topRows(tick.states()) = tick.B;
    of_x_.resize(rows);
    of_u_.resize(rows);
  }

  Machine machine_;
  LinearPlant plant_, target_;
  // Of a tick, in whole registers: A above C, and B.
  MatrixXd from_x_, from_u_;
  VectorXd of_x_, of_u_;
  Index becoming_ = 0;  // ticks until it is that
  TickLoop loop_;
  VectorXd x_, y_, u_;
  Eigen::MatrixXd joints_;  // nq x ticks, empty: not logged
};

}  // namespace

std::unique_ptr<RunningMachine> StartNonlinear(const Machine& machine,
                                               const Excitation& excitation,
                                               const RunOptions& options) {
  CheckNotEmpty(excitation);
  return std::make_unique<NonlinearRun>(machine, excitation, options);
}

std::unique_ptr<RunningMachine> StartLinear(const Machine& machine,
                                            const Excitation& excitation,
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
  return std::make_unique<LinearRun>(machine, excitation, options);
}

}  // namespace mjdiag
