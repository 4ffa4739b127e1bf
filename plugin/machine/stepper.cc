#include "mjdiag/plugin/machine/stepper.h"

#include <algorithm>

#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/plant/scenery.h"
#include "mjdiag/plugin/plant/start_state.h"

namespace mjdiag {

void ReadForces(const mjModel& model, mjData& data) noexcept {
  mj_fwdActuation(&model, &data);
  mj_fwdAcceleration(&model, &data);
  mj_fwdConstraint(&model, &data);
  mj_sensorAcc(&model, &data);
}

namespace {

/// mj_step1 without what follows from positions alone.
void BeginStepInPlace(const mjModel& model, mjData& data) {
  mj_checkVel(&model, &data);
  if (data.nefc > 0) {
    // Effects change bounds of friction.
    mj_makeConstraint(&model, &data);
    mj_projectConstraint(&model, &data);
  }
  mj_fwdVelocity(&model, &data);
  mj_sensorVel(&model, &data);
}

}  // namespace

Stepper::Stepper(const Machine& machine)
    : effects_(machine.channels(), machine.plant(), machine.effects()),
      tick_(machine.rates().tick()),
      substeps_(machine.rates().substeps),
      sensors_(machine.sensor_addresses()),
      actuators_(machine.actuator_addresses()),
      outputs_(sensors_.size()),
      inputs_(actuators_.size()) {
  off_.reserve(actuators_.size());
  for (const SensorSetup& sensor : machine.channels().sensors) {
    reads_forces_ |= StageOf(machine.plant(), sensor) == mjSTAGE_ACC;
  }
}

void Stepper::OnStep(const mjModel& model, mjData& data,
                     TickControl& control) noexcept {
  const int stages = model.opt.integrator == mjINT_RK4 ? 4 : 1;
  if (stage_ == 0) Act(model, data, control);
  stage_ = (stage_ + 1) % stages;
}

void Stepper::Act(const mjModel& model, mjData& data, TickControl& control) noexcept {
  if (substep_ == 0) {
    // MuJoCo has those of the step before.
    if (reads_forces_) ReadForces(model, data);
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
      outputs_[i] = data.sensordata[sensors_[i]];
    }
    effects_.Distort(model, data, outputs_, static_cast<double>(ticks_) * tick_);
    control.Tick(outputs_, inputs_);
    ++ticks_;
    off_.clear();
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
      if (!control.IsOn(i)) off_.push_back(actuators_[i]);
    }
  }
  for (std::size_t j = 0; j < others_.size(); ++j) {
    Command(data, control);
    others_[j].Act(model, data, off_);
    other_pushes_.col(static_cast<Eigen::Index>(j)) +=
        Eigen::VectorXd::Map(data.qfrc_applied, model.nv);
    others_[j].Release(data);
  }
  Command(data, control);
  if (++substep_ == substeps_) substep_ = 0;
  effects_.Act(model, data, off_);
  if (!others_.empty()) {
    other_pushes_.colwise() -= Eigen::VectorXd::Map(data.qfrc_applied, model.nv);
  }
}

void Stepper::Command(mjData& data, const TickControl& control) const noexcept {
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    data.ctrl[actuators_[i]] = inputs_[i] + control.Above(i, substep_);
  }
}

void Stepper::TellPushesOf(const std::vector<Machine>& others) {
  others_.clear();
  for (const Machine& other : others) {
    others_.emplace_back(other.channels(), other.plant(), other.effects());
  }
}

void Stepper::Advance(const mjModel& model, mjData& data, TickControl& control,
                      const std::function<void()>& after_step) {
  AdvanceSteps(substeps_, model, data, control, after_step);
}

void Stepper::AdvanceSteps(int steps, const mjModel& model, mjData& data,
                           TickControl& control,
                           const std::function<void()>& after_step,
                           bool has_positions) {
  if (!others_.empty()) {
    other_pushes_.setZero(model.nv, std::ssize(others_));
    told_steps_ = steps;
  }
  for (int i = 0; i < steps; ++i) {
    if (i == 0 && has_positions) {
      BeginStepInPlace(model, data);
    } else {
      mj_step1(&model, &data);
    }
    if (!held_.empty()) mju_zero(data.qfrc_applied, static_cast<int>(model.nv));
    Act(model, data, control);
    if (!held_.empty()) {
      mju_addTo(data.qfrc_applied, held_.data(), static_cast<int>(model.nv));
    }
    if (model.opt.integrator == mjINT_RK4) {
      // mj_step2 would take an Euler step.
      ReadForces(model, data);
      mj_checkAcc(&model, &data);
      mj_RungeKutta(&model, &data, 4);
    } else {
      mj_step2(&model, &data);
    }
    if (after_step) after_step();
  }
}

void Stepper::Recall(const Stepper& other) noexcept {
  effects_.Recall(other.effects_);
  ticks_ = other.ticks_;
  substep_ = other.substep_;
  stage_ = other.stage_;
}

void Stepper::Release(mjData& data) noexcept {
  for (const int address : actuators_) data.ctrl[address] = 0.0;
  effects_.Release(data);
}

StartedPlant StartPlant(const Machine& machine,
                        const std::map<std::string, double>& start) {
  StartedPlant plant{CopyModel(machine.plant()), nullptr};
  const Eigen::VectorXd position =
      StartPosition(machine.channels(), *plant.model, machine.rest(), start);
  DropScenery(*plant.model);
  plant.data = MakeData(*plant.model);
  std::copy(position.begin(), position.end(), plant.data->qpos);
  return plant;
}

// Only the warning counters tell.
bool HasDiverged(const mjData& data) {
  return data.warning[mjWARN_BADQPOS].number > 0 ||
         data.warning[mjWARN_BADQVEL].number > 0 ||
         data.warning[mjWARN_BADQACC].number > 0 ||
         data.warning[mjWARN_BADCTRL].number > 0;
}

}  // namespace mjdiag
