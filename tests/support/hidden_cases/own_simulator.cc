#include "support/hidden_cases/own_simulator.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"
#include "support/hidden_cases/dry_friction.h"

namespace mjdiag::test {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

struct State {
  VectorXd q;  // qpos
  VectorXd v;
  VectorXd z;
};

State Moved(const State& from, const State& rate, double h) {
  return {from.q + h * rate.q, from.v + h * rate.v, from.z + h * rate.z};
}

class OwnMachine {
 public:
  OwnMachine(const Machine& machine, const HiddenPhysics& hidden, const OwnRun& run)
      : machine_(machine),
        hidden_(hidden),
        plant_(StartPlant(machine, {})),
        model_(*plant_.model),
        data_(*plant_.data),
        tick_(machine.rates().tick()),
        step_(tick_ / run.steps),
        steps_(run.steps),
        drawn_(Eigen::Map<VectorXd>(model_.qpos0, model_.nq)),
        bound_(Eigen::Map<VectorXd>(model_.dof_frictionloss, model_.nv)) {
    for (int j = 0; j < model_.njnt; ++j) {
      if (model_.jnt_type[j] == mjJNT_SLIDE || model_.jnt_type[j] == mjJNT_HINGE) {
        continue;
      }
      throw InputError("joint", "is neither slide nor hinge", "scalar joints");
    }
    std::fill_n(model_.dof_frictionloss, model_.nv, 0.0);
    state_.q = run.start.size() > 0
                   ? run.start
                   : VectorXd(Eigen::Map<VectorXd>(data_.qpos, model_.nq));
    state_.v = VectorXd::Zero(model_.nv);
    state_.z = hidden.memory;
  }

  void Run(TickControl& computer, Index ticks) {
    for (Index k = 0; k < ticks; ++k) {
      Tick(computer, k);
      if (state_.v.allFinite()) continue;
      throw NumericalError("the simulator of the tests diverged at " +
                           std::to_string(tick_ * static_cast<double>(k)) + " s");
    }
  }

 private:
  void Tick(TickControl& computer, Index k) {
    VectorXd readings = Read(tick_ * static_cast<double>(k));
    VectorXd command(static_cast<Index>(machine_.actuator_addresses().size()));
    computer.Tick({readings.data(), static_cast<std::size_t>(readings.size())},
                  {command.data(), static_cast<std::size_t>(command.size())});
    commands_.push_back(std::move(command));
    for (int i = 0; i < steps_; ++i) Step(k, i);
  }

  VectorXd Read(double t) {
    std::copy(state_.q.begin(), state_.q.end(), data_.qpos);
    std::copy(state_.v.begin(), state_.v.end(), data_.qvel);
    mj_fwdPosition(&model_, &data_);
    mj_sensorPos(&model_, &data_);
    mj_fwdVelocity(&model_, &data_);
    mj_sensorVel(&model_, &data_);
    const std::vector<int>& addresses = machine_.sensor_addresses();
    VectorXd y(static_cast<Index>(addresses.size()));
    for (Index i = 0; i < y.size(); ++i) {
      y[i] = data_.sensordata[addresses[static_cast<std::size_t>(i)]];
    }
    const VectorXd q = state_.q - drawn_;
    const VectorXd none = VectorXd::Zero(commands_.empty() ? 0 : commands_[0].size());
    for (const auto& law : hidden_.readings) {
      law({t, q, state_.v, none, none, state_.z}, y);
    }
    return y;
  }

  /// Of a step: it is the command in its middle, so that a change between two steps is
  /// in none of them by halves.
  VectorXd Command(Index tick, int step) const {
    VectorXd command = commands_.back();
    for (Index i = 0; i < hidden_.input_delay.size(); ++i) {
      const double ago = hidden_.input_delay[i] / tick_ - (step + 0.5) / steps_;
      const auto whole = std::max<Index>(0, static_cast<Index>(std::ceil(ago)));
      command[i] =
          commands_[static_cast<std::size_t>(std::max<Index>(0, tick - whole))][i];
    }
    return command;
  }

  /// Slopes of a state under the forces `held` of dry friction.
  State Slopes(const State& at, double t, const VectorXd& command,
               const VectorXd& held) {
    const VectorXd q = at.q - drawn_;
    VectorXd u = command;
    for (const auto& law : hidden_.drives) law({t, q, at.v, command, command, at.z}, u);
    const Moment moment{t, q, at.v, command, u, at.z};
    VectorXd force = held;
    for (const auto& law : hidden_.forces) law(moment, force);
    State rate{at.v, VectorXd(model_.nv), VectorXd::Zero(at.z.size())};
    for (const auto& law : hidden_.remembers) law(moment, rate.z);
    std::copy(at.q.begin(), at.q.end(), data_.qpos);
    std::copy(at.v.begin(), at.v.end(), data_.qvel);
    for (Index i = 0; i < u.size(); ++i) {
      data_.ctrl[machine_.actuator_addresses()[static_cast<std::size_t>(i)]] = u[i];
    }
    std::copy(force.begin(), force.end(), data_.qfrc_applied);
    mj_fwdPosition(&model_, &data_);
    mj_fwdVelocity(&model_, &data_);
    mj_fwdActuation(&model_, &data_);
    mj_fwdAcceleration(&model_, &data_);
    mj_fwdConstraint(&model_, &data_);
    std::copy_n(data_.qacc, model_.nv, rate.v.data());
    return rate;
  }

  State RungeKutta(double t, const State& first, const VectorXd& command,
                   const VectorXd& held) {
    const double h = step_;
    const State second =
        Slopes(Moved(state_, first, 0.5 * h), t + 0.5 * h, command, held);
    const State third =
        Slopes(Moved(state_, second, 0.5 * h), t + 0.5 * h, command, held);
    const State fourth = Slopes(Moved(state_, third, h), t + h, command, held);
    State end = Moved(state_, first, h / 6.0);
    end = Moved(end, second, h / 3.0);
    end = Moved(end, third, h / 3.0);
    return Moved(end, fourth, h / 6.0);
  }

  /// Bounds of dry friction at the start of a step, in which the data are.
  VectorXd Bounds(double t, const VectorXd& command) const {
    const VectorXd q = state_.q - drawn_;
    VectorXd u = command;
    for (const auto& law : hidden_.drives) {
      law({t, q, state_.v, command, command, state_.z}, u);
    }
    VectorXd bound = bound_;
    for (const auto& law : hidden_.dry) {
      law({t, q, state_.v, command, u, state_.z}, bound);
    }
    return bound.cwiseMax(0.0);
  }

  void Step(Index tick, int step) {
    const double t = tick_ * static_cast<double>(tick) + step_ * step;
    const VectorXd command = Command(tick, step);
    const VectorXd none = VectorXd::Zero(model_.nv);
    const State slopes = Slopes(state_, t, command, none);
    const VectorXd bound = Bounds(t, command);
    if ((bound.array() == 0.0).all()) {
      state_ = RungeKutta(t, slopes, command, none);
      return;
    }
    Eigen::MatrixXd mass(model_.nv, model_.nv);
    mj_fullM(&model_, mass.data(), data_.qM);
    const Eigen::MatrixXd per_force =
        step_ * mass.llt().solve(Eigen::MatrixXd::Identity(model_.nv, model_.nv));
    const State free = RungeKutta(t, slopes, command, none);
    const VectorXd held = DryFriction(per_force, free.v, bound);
    State first = slopes;
    first.v += per_force * held / step_;
    state_ = RungeKutta(t, first, command, held);
  }

  const Machine& machine_;
  const HiddenPhysics& hidden_;
  StartedPlant plant_;
  mjModel& model_;
  mjData& data_;
  double tick_;  // [s]
  double step_;  // [s]
  int steps_;
  VectorXd drawn_;
  VectorXd bound_;  // of the plant's own dry friction
  State state_;
  std::vector<VectorXd> commands_;  // of every tick so far
};

}  // namespace

void RunOwn(const Machine& machine, const HiddenPhysics& hidden, TickControl& computer,
            const OwnRun& run) {
  OwnMachine(machine, hidden, run).Run(computer, run.ticks);
}

}  // namespace mjdiag::test
