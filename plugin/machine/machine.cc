#include "mjdiag/plugin/machine/machine.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <utility>

#include "mjdiag/plugin/effects/active_effect.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/machine/same_plant.h"
#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/plant/instance_slot.h"
#include "mjdiag/plugin/plant/linearize.h"
#include "mjdiag/plugin/plant/motor_force.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/scale_number.h"
#include "mjdiag/plugin/plant/time_step.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

/// Found when first asked for, by whichever copy of the machine is asked.
struct Machine::Derived {
  explicit Derived(const Setup& setup) : held(!setup.control.axes.empty()) {}

  bool held;  // by controllers
  std::once_flag rest_once;
  std::once_flag mechanics_once;
  RestPose rest;
  MechanicalModel mechanics;
};

namespace {

void ApplyCalibration(const Setup& setup, mjModel& model) {
  const Calibration& calibration = *setup.calibration;
  if (calibration.sensor_noise.size() !=
      static_cast<Eigen::Index>(setup.channels.sensors.size())) {
    throw InputError(
        "calibration of '" + setup.name + "'",
        "it is of " + std::to_string(calibration.sensor_noise.size()) + " sensors",
        "one of this setup");
  }
  NumberFactors factors;
  for (std::size_t i = 0; i < calibration.numbers.size(); ++i) {
    factors.emplace_back(FindModelParameter(model, calibration.numbers[i]),
                         calibration.factors[static_cast<Eigen::Index>(i)]);
  }
  ScaleNumbers(model, factors);
}

ModelPtr LoadPlant(const Setup& setup) {
  ModelPtr model = LoadModel(setup.plant);
  AdoptTimeStep(setup, *model);
  PreparePlant(setup.physics, *model);
  if (setup.calibration) ApplyCalibration(setup, *model);
  return model;
}

/// Noise as it was measured.
Setup WithNoiseOf(Setup setup, const Calibration& calibration) {
  for (std::size_t i = 0; i < setup.channels.sensors.size(); ++i) {
    setup.channels.sensors[i].noise_sd =
        calibration.sensor_noise[static_cast<Eigen::Index>(i)];
  }
  return setup;
}

Setup WithNoiseOf(Setup setup, const std::vector<PlacedEffect>& effects) {
  setup.channels = WithNoiseOf(std::move(setup.channels), effects);
  return setup;
}

}  // namespace

Machine::Machine(Setup setup) {
  ModelPtr model = LoadPlant(setup);
  FaultParameters(*model);  // complains of those that are malformed
  CheckKnownNumbers(*model);
  if (setup.calibration) setup = WithNoiseOf(setup, *setup.calibration);
  setup_ = std::make_shared<Setup>(WithNoiseOf(std::move(setup), EffectsOf(*model)));
  Adopt(std::move(model));
}

Machine::Machine(Setup setup, const mjModel& prepared)
    : setup_(
          std::make_shared<Setup>(WithNoiseOf(std::move(setup), EffectsOf(prepared)))) {
  Adopt(CopyModel(prepared));
}

void Machine::Adopt(std::shared_ptr<const mjModel> plant) {
  plant_ = std::move(plant);
  sensor_addresses_ = SensorAddresses(channels(), *plant_);
  actuator_addresses_ = ActuatorAddresses(channels(), *plant_);
  for (std::size_t i = 0; i < actuator_addresses_.size(); ++i) {
    if (channels().actuators[i].enabled_by.empty()) continue;
    CheckOpenCircuit(*plant_, actuator_addresses_[i]);
  }
  derived_ = std::make_shared<Derived>(setup());
}

std::vector<PlacedEffect> Machine::effects() const {
  std::vector<PlacedEffect> all = EffectsOf(*plant_);
  all.insert(all.end(), changes_.effects.begin(), changes_.effects.end());
  return all;
}

const RestPose& Machine::rest_pose() const& {
  std::call_once(derived_->rest_once,
                 [this] { derived_->rest = FindRest(*plant_, derived_->held); });
  return derived_->rest;
}

const MechanicalModel& Machine::mechanics() const& {
  std::call_once(derived_->mechanics_once, [this] {
    MechanicalModel& model = derived_->mechanics;
    model = Linearize(*plant_, channels(), rest());
    model.b += VelocityOutputMatrix(*plant_, channels(), rest());
  });
  return derived_->mechanics;
}

const MechanicalModel& Machine::linear() const& {
  RequireScalarJoints(*plant_, channels());
  return mechanics();
}

Machine Machine::With(const Changes& changes) const {
  Machine changed = *this;
  if (changes == Changes{}) return changed;
  ModelPtr model = CopyModel(*plant_);
  ScaleNumbers(*model, changes.numbers);
  for (const Fault& fault : changes.faults) ApplyFault(*model, fault);
  for (const PlacedEffect& effect : changes.effects) ApplyEffect(*model, effect);
  changed.setup_ = std::make_shared<Setup>(WithNoiseOf(*setup_, changes.effects));
  changed.Adopt(std::move(model));
  auto& [faults, effects, numbers] = changed.changes_;
  faults.insert(faults.end(), changes.faults.begin(), changes.faults.end());
  effects.insert(effects.end(), changes.effects.begin(), changes.effects.end());
  numbers.insert(numbers.end(), changes.numbers.begin(), changes.numbers.end());
  return changed;
}

Machine Machine::WithNumbers(const NumberFactors& factors) const {
  Machine changed = *this;
  ModelPtr model = CopyModel(*plant_);
  ScaleNumbers(*model, factors);
  changed.Adopt(std::move(model));
  return changed;
}

Machine Machine::WithSubsteps(int substeps) const {
  Machine changed = *this;
  Setup setup = *setup_;
  ModelPtr model = CopyModel(*plant_);
  model->opt.timestep *= static_cast<double>(setup.rates.substeps) / substeps;
  setup.rates.substeps = substeps;
  changed.setup_ = std::make_shared<Setup>(std::move(setup));
  changed.Adopt(std::move(model));
  return changed;
}

Machine Machine::WithoutSteps(double share) const {
  const double half = 0.5 * share * plant_->opt.timestep;
  Changes late;
  for (const ActuatorSetup& actuator : setup_->channels.actuators) {
    late.effects.push_back(
        {Lasting(InputDelay()), actuator.element, Eigen::VectorXd::Constant(1, half)});
  }
  Machine changed = With(late);
  changed.DampBetweenSteps(share);
  return changed;
}

void Machine::DampBetweenSteps(double share) {
  ModelPtr model = CopyModel(*plant_);
  const double half = 0.5 * share * model->opt.timestep;
  const Eigen::VectorXd of_motors = MotorBiasAtQpos0(*model).damping.diagonal();
  for (int dof = 0; dof < model->nv; ++dof) {
    model->dof_armature[dof] += half * (of_motors[dof] - model->dof_damping[dof]);
  }
  // The inertia of bodies that move by themselves is a constant (dof_M0).
  const DataPtr data = MakeData(*model);
  mj_setConst(model.get(), data.get());
  Adopt(std::move(model));
  without_steps_ = share;
}

Machine Machine::ChangedAs(const Machine& other) const {
  const auto further = [](const auto& all, const auto& own) {
    const auto known = std::min(own.size(), all.size());
    return std::decay_t<decltype(all)>(all.begin() + static_cast<std::ptrdiff_t>(known),
                                       all.end());
  };
  const Changes& all = other.changes_;
  Changes changes;
  changes.faults = further(all.faults, changes_.faults);
  changes.effects = further(all.effects, changes_.effects);
  changes.numbers = further(all.numbers, changes_.numbers);
  Machine changed = WithSubsteps(other.rates().substeps).With(changes);
  if (without_steps_ == 0.0 && other.without_steps_ > 0.0) {
    changed.DampBetweenSteps(other.without_steps_);
  }
  return changed;
}

namespace {

/// Those that do not push at joints.
std::vector<PlacedEffect> OtherEffects(const Machine& machine) {
  std::vector<PlacedEffect> effects = machine.effects();
  std::erase_if(effects, [](const PlacedEffect& placed) {
    return placed.effect->element() == mjOBJ_JOINT &&
           placed.effect->form() == Form::kNumeric;
  });
  return effects;
}

bool HasBodiesOfEffects(const Machine& machine) {
  const ActiveEffects effects(machine.channels(), machine.plant(), machine.effects());
  return !effects.bodies().empty();
}

}  // namespace

bool Machine::DiffersInPushes(const Machine& other) const {
  return rates().substeps == other.rates().substeps &&
         AreSamePlant(plant(), other.plant()) &&
         OtherEffects(*this) == OtherEffects(other) && !HasBodiesOfEffects(*this) &&
         !HasBodiesOfEffects(other);
}

Machine Machine::WithSetup(Setup setup) const {
  Machine changed = *this;
  changed.setup_ = std::make_shared<Setup>(std::move(setup));
  return changed;
}

Machine Machine::WithSensorNoise(const Eigen::VectorXd& sd) const {
  Setup setup = *setup_;
  for (std::size_t i = 0; i < setup.channels.sensors.size(); ++i) {
    setup.channels.sensors[i].noise_sd = sd[static_cast<Eigen::Index>(i)];
  }
  return WithSetup(WithNoiseOf(std::move(setup), effects()));
}

namespace {

/// A bit of opt.disableflags that is none of MuJoCo's, and which copies of a model keep.
constexpr int kPrepared = 1 << 30;

}  // namespace

void PreparePlant(const Physics& physics, mjModel& model) {
  if ((model.opt.disableflags & kPrepared) != 0) {
    throw InputError("model", "is prepared already",
                     "one as it was loaded: friction that it carries would come twice");
  }
  model.opt.disableflags |= kPrepared;
  if (!physics.gravity) model.opt.disableflags |= mjDSBL_GRAVITY;
  if (!physics.static_friction) {
    // The plant's own; friction that an effect adds stays.
    std::fill_n(model.dof_frictionloss, model.nv, 0.0);
    std::fill_n(model.tendon_frictionloss, model.ntendon, 0.0);
  }
  for (const PlacedEffect& effect : EffectsOf(model)) ApplyEffect(model, effect);
  ReserveInstanceSlot(model);
}

}  // namespace mjdiag
