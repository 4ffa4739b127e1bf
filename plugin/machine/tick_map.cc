#include "mjdiag/plugin/machine/tick_map.h"

#include <algorithm>

#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/plant/scenery.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

/// Differences of ticks are taken: the constraint forces have to be the solution up to
/// rounding, and not what iterations from the last step come to.
void SolveExactly(mjModel& model) {
  model.opt.solver = mjSOL_NEWTON;
  model.opt.tolerance = 1e-14;
  model.opt.iterations = std::max(model.opt.iterations, 30);
  model.opt.disableflags |= mjDSBL_WARMSTART;
}

void Mix(std::uint64_t& hash, std::uint64_t value) {
  hash = (hash ^ value) * 0x100000001b3ULL;  // FNV-1a
}

void SetBodies(const VectorXd& state,
               const std::vector<ActiveEffects::BodyOf>& bodies) {
  if (state.size() != 2 * std::ssize(bodies)) return;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto place = 2 * static_cast<Index>(i);
    *bodies[i].body = {state[place], state[place + 1], true};
  }
}

VectorXd StateOf(const std::vector<ActiveEffects::BodyOf>& bodies) {
  VectorXd state(2 * std::ssize(bodies));
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto place = 2 * static_cast<Index>(i);
    state[place] = bodies[i].body->position;
    state[place + 1] = bodies[i].body->velocity;
  }
  return state;
}

}  // namespace

TickMap::TickMap(const Machine& machine)
    : tick_(machine.rates().tick()),
      steps_(machine.rates().substeps),
      model_(CopyModel(machine.plant())),
      stepper_(machine),
      before_(machine),
      probe_(machine),
      addresses_(machine.sensor_addresses()) {
  DropScenery(*model_);
  SolveExactly(*model_);
  data_ = MakeData(*model_);
  for (const SensorSetup& sensor : machine.channels().sensors) {
    late_.push_back(StageOf(*model_, sensor) == mjSTAGE_ACC);
    reads_at_end_ |= late_.back();
  }
  friction_.resize(static_cast<std::size_t>(model_->nv + model_->ntendon));
  last_.reading = VectorXd::Zero(sensors());
  probed_.reading = last_.reading;
}

PlantState TickMap::Begun(PlantState state) const {
  state.bodies.resize(2 * std::ssize(bodies()));
  Index place = 0;
  for (const ActiveEffects::BodyOf& one : bodies()) {
    state.bodies[place++] =
        state.position[model_->jnt_qposadr[model_->dof_jntid[one.dof]]];
    state.bodies[place++] = state.velocity[one.dof];
  }
  return state;
}

const TickMap::Result& TickMap::Run(const PlantState& from, const VectorXd& forces,
                                    std::int64_t tick, TickControl& control) {
  before_.Recall(stepper_);
  Advance(stepper_, steps_, from, forces, tick, control, last_);
  return last_;
}

const TickMap::Result& TickMap::Probe(const PlantState& from, const VectorXd& forces,
                                      std::int64_t tick, TickControl& control) {
  probe_.Recall(before_);
  Advance(probe_, steps_, from, forces, tick, control, probed_);
  return probed_;
}

const TickMap::Result& TickMap::ProbeStep(const PlantState& from,
                                          const VectorXd& forces, std::int64_t tick,
                                          TickControl& control) {
  probe_.Recall(before_);
  Advance(probe_, 1, from, forces, tick, control, probed_);
  return probed_;
}

// What follows from positions stays what it was in data_, and of that effects that follow
// their joints see nothing.
VectorXd TickMap::PushesAt(const VectorXd& position, const VectorXd& velocity,
                           std::int64_t tick) {
  probe_.Recall(before_);
  std::ranges::copy(position, data_->qpos);
  std::ranges::copy(velocity, data_->qvel);
  data_->time = static_cast<double>(tick) * tick_;
  VectorXd forces(model_->nv);
  probe_.PushInto(*model_, *data_,
                  {forces.data(), static_cast<std::size_t>(forces.size())});
  return forces;
}

void TickMap::Advance(Stepper& stepper, int steps, const PlantState& from,
                      const VectorXd& forces, std::int64_t tick, TickControl& control,
                      Result& result) {
  const bool has_positions = computed_at_.size() > 0 && computed_at_ == from.position;
  computed_at_.resize(0);
  SetState(*model_, from, *data_);
  SetBodies(from.bodies, stepper.bodies());
  data_->time = static_cast<double>(tick) * tick_;
  stepper.Hold({forces.data(), static_cast<std::size_t>(forces.size())});
  result.pattern = 0xcbf29ce484222325ULL;
  result.is_constrained = false;
  std::ranges::fill(friction_, Friction{});
  const auto note_constraints = [&] {
    for (int row = 0; row < data_->nefc; ++row) {
      const int type = data_->efc_type[row];
      const int id = data_->efc_id[row];
      const int state = data_->efc_state[row];
      if (type == mjCNSTR_FRICTION_DOF || type == mjCNSTR_FRICTION_TENDON) {
        Friction& friction = friction_[static_cast<std::size_t>(
            type == mjCNSTR_FRICTION_DOF ? id : model_->nv + id)];
        // Which way a joint slides makes no difference to its first order.
        const bool slides =
            state == mjCNSTRSTATE_LINEARNEG || state == mjCNSTRSTATE_LINEARPOS;
        (slides ? friction.slides : friction.sticks) = true;
        result.is_constrained |= !slides;
        continue;
      }
      result.is_constrained = true;
      Mix(result.pattern, static_cast<std::uint64_t>(type));
      Mix(result.pattern, static_cast<std::uint64_t>(id));
      Mix(result.pattern, static_cast<std::uint64_t>(state));
    }
    for (const int motor : stepper.off()) {
      Mix(result.pattern, static_cast<std::uint64_t>(motor) + 1000);
    }
  };
  stepper.AdvanceSteps(steps, *model_, *data_, control, note_constraints,
                       has_positions);
  // In which steps of a tick a joint sticks that slides in others is noise.
  for (const Friction& friction : friction_) {
    Mix(result.pattern, (friction.sticks ? 1U : 0U) + (friction.slides ? 2U : 0U));
  }
  std::ranges::copy(stepper.outputs(), result.reading.begin());
  if (reads_at_end_) {
    mj_step1(model_.get(), data_.get());
    ReadForces(*model_, *data_);
  }
  for (std::size_t i = 0; i < late_.size(); ++i) {
    if (!late_[i]) continue;
    result.reading[static_cast<Index>(i)] = data_->sensordata[addresses_[i]];
  }
  result.state = StateOf(*model_, *data_);
  result.state.bodies = StateOf(stepper.bodies());
  result.diverged = HasDiverged(*data_);
  if (result.diverged) {
    mj_resetData(model_.get(), data_.get());
  } else if (steps == 1 && !reads_at_end_ && model_->opt.integrator != mjINT_RK4) {
    computed_at_ = from.position;
  }
}

VectorXd TickMap::Read(const PlantState& at, std::int64_t tick) {
  SetState(*model_, at, *data_);
  computed_at_ = at.position;
  mj_fwdPosition(model_.get(), data_.get());
  mj_sensorPos(model_.get(), data_.get());
  mj_fwdVelocity(model_.get(), data_.get());
  mj_sensorVel(model_.get(), data_.get());
  VectorXd reading(sensors());
  for (std::size_t i = 0; i < late_.size(); ++i) {
    reading[static_cast<Index>(i)] = late_[i] ? 0.0 : data_->sensordata[addresses_[i]];
  }
  stepper_.Distort(*model_, *data_,
                   {reading.data(), static_cast<std::size_t>(reading.size())}, tick);
  return reading;
}

}  // namespace mjdiag
