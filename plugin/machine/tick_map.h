#pragma once
// A control tick of a machine as a function,
//
//   (x, f, u) -> (x', y, y'),
//
// x the state of any MuJoCo model (plant_state.h), f generalised forces that are held over
// the tick beside all others, u the commands of a TickControl. y is what the sensors read at
// its start, those that MuJoCo computes from positions and velocities; y' what sensors of
// accelerations and forces read at its end, under the commands of the tick: a controller that
// reads those at a tick reads what the one before has made.
//
// Bodies that effects add are where the state says; what else effects remember goes on from
// one Run to the next, and Probe leaves it as it is.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/machine/plant_state.h"
#include "mjdiag/plugin/machine/stepper.h"

namespace mjdiag {

class TickMap {
 public:
  struct Result {
    PlantState state;         ///< x'
    Eigen::VectorXd reading;  ///< ny: y, and y' of sensors that read at the end
    /// Of what decides by switching: constraints that are active and how, in every
    /// physics step, of dry friction in all steps together, and actuators that are off.
    std::uint64_t pattern = 0;
    /// Any constraint in any step, but for dry friction that slides: a constant force.
    bool is_constrained = false;
    bool diverged = false;
  };

  explicit TickMap(const Machine& machine);

  const mjModel& model() const { return *model_; }
  Eigen::Index sensors() const { return static_cast<Eigen::Index>(late_.size()); }
  /// Whether a sensor reads at the end of a tick what happened in it.
  bool ReadsAtEnd(Eigen::Index sensor) const {
    return late_[static_cast<std::size_t>(sensor)];
  }

  /// Numbers of a deviation from a state.
  Eigen::Index states() const {
    return TangentSize(*model_) + 2 * static_cast<Eigen::Index>(bodies().size());
  }
  /// Those that effects add, in the order of the state.
  const std::vector<ActiveEffects::BodyOf>& bodies() const { return stepper_.bodies(); }
  /// A state with every body where its joint is.
  PlantState Begun(PlantState state) const;

  /// Of the last Run.
  const Result& last() const { return last_; }

  /// Tick `tick` since the start of a record. The control is asked for that tick.
  /// @param forces  nv [N, N m]
  const Result& Run(const PlantState& from, const Eigen::VectorXd& forces,
                    std::int64_t tick, TickControl& control);
  /// The same from what effects remembered before the last Run.
  const Result& Probe(const PlantState& from, const Eigen::VectorXd& forces,
                      std::int64_t tick, TickControl& control);
  /// The same, of the first physics step of the tick alone.
  const Result& ProbeStep(const PlantState& from, const Eigen::VectorXd& forces,
                          std::int64_t tick, TickControl& control);
  /// ActiveEffects::FollowTheirJoints
  bool EffectsFollowTheirJoints() const { return stepper_.EffectsFollowTheirJoints(); }
  /// What effects push with at the beginning of a tick that starts as the last Run did, but from
  /// these positions and velocities; where they follow their joints. nv [N, N m]
  Eigen::VectorXd PushesAt(const Eigen::VectorXd& position,
                           const Eigen::VectorXd& velocity, std::int64_t tick);
  /// As Stepper::TellPushesOf, of Run.
  void TellPushesOf(const std::vector<Machine>& others) {
    stepper_.TellPushesOf(others);
  }
  /// nv x others [N, N m]
  Eigen::MatrixXd OtherPushes() const { return stepper_.OtherPushes(); }
  /// Physics steps of a tick.
  int steps() const { return steps_; }
  bool reads_at_end() const { return reads_at_end_; }
  /// What the sensors read at the start of a tick, without one. Those of its end: 0.
  Eigen::VectorXd Read(const PlantState& at, std::int64_t tick);

 private:
  void Advance(Stepper& stepper, int steps, const PlantState& from,
               const Eigen::VectorXd& forces, std::int64_t tick, TickControl& control,
               Result& result);

  /// What the dry friction of a joint or a tendon does in a tick.
  struct Friction {
    bool sticks = false;
    bool slides = false;
  };

  double tick_;  // [s]
  int steps_;
  ModelPtr model_;
  DataPtr data_;
  Stepper stepper_;  // as it goes on
  Stepper before_;   // as it was before the last Run
  Stepper probe_;
  std::vector<int> addresses_;
  std::vector<bool> late_;
  bool reads_at_end_ = false;
  std::vector<Friction> friction_;  // of joints, then of tendons
  // Those of which data_ have what follows from positions; of no size: none.
  Eigen::VectorXd computed_at_;
  Result last_;  // of Run
  Result probed_;
};

}  // namespace mjdiag
