#pragma once
// A control tick of the nonlinear machine, physics step by physics step: at the first
// one the sensors are read and the actuator signals decided, which hold for the tick;
// effects act in every one. What acts at the beginning of a step acts in all of the four
// stages that a Runge-Kutta step has. Sensors of accelerations and forces read what acts there under
// the signals of the tick before.
//
// The same steps are taken inside MuJoCo's control callback, where a caller's mj_step
// drives (OnStep), and by Advance, which takes a whole tick by itself.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "mjdiag/plugin/effects/active_effect.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {

/// Decides the actuator signals of a tick: a controller, or a record.
class TickControl {
 public:
  virtual ~TickControl() = default;
  /// Nothing in it may allocate, lock, throw or do I/O.
  /// @param outputs  readings of the sensor channels at the start of the tick
  /// @param inputs   receives the signals of the actuator channels until the next tick
  virtual void Tick(std::span<const double> outputs,
                    std::span<double> inputs) noexcept = 0;
  /// What the signal of an actuator is in a physics step of the tick, above the one
  /// that Tick gave: recorded inputs may go on between their samples.
  virtual double Above(std::size_t /*actuator*/, int /*substep*/) const noexcept {
    return 0.0;
  }
  /// Whether an actuator is on in this tick; one that is off is an open circuit.
  virtual bool IsOn(std::size_t /*actuator*/) const noexcept { return true; }
};

/// Has the sensors of accelerations and forces read what acts now, after positions and
/// velocities.
void ReadForces(const mjModel& model, mjData& data) noexcept;

class Stepper {
 public:
  /// InputError as CheckEffect.
  explicit Stepper(const Machine& machine);

  /// One physics step, after positions and velocities and before accelerations: where
  /// MuJoCo calls the control callback, in a Runge-Kutta step at each of its stages.
  void OnStep(const mjModel& model, mjData& data, TickControl& control) noexcept;
  /// A whole tick. @param after_step  called after every physics step; may be empty
  void Advance(const mjModel& model, mjData& data, TickControl& control,
               const std::function<void()>& after_step = {});
  /// Its first physics steps.
  /// @param has_positions  whether `data` have what follows from their positions, as behind a
  ///                       step of Euler's from the same positions: what MuJoCo takes most of
  ///                       its time for
  void AdvanceSteps(int steps, const mjModel& model, mjData& data, TickControl& control,
                    const std::function<void()>& after_step = {},
                    bool has_positions = false);
  /// Whether the next physics step is the first of a tick.
  bool AtTickStart() const { return substep_ == 0 && stage_ == 0; }
  /// What the sensors read at the start of this tick, as the control was told.
  std::span<const double> outputs() const { return outputs_; }
  /// Actuators that are an open circuit in this tick, by their place in the model.
  std::span<const int> off() const { return off_; }
  /// Sets the actuators and the forces of effects to zero.
  void Release(mjData& data) noexcept;

  /// From now on these generalised forces act beside all others, in Advance. nv [N, N m]
  void Hold(std::span<const double> forces) {
    held_.assign(forces.begin(), forces.end());
  }
  /// What effects of the sensors make of readings, at a tick since the start.
  void Distort(const mjModel& model, const mjData& data, std::span<double> outputs,
               std::int64_t tick) noexcept {
    effects_.Distort(model, data, outputs, static_cast<double>(tick) * tick_);
  }
  const std::vector<ActiveEffects::BodyOf>& bodies() const { return effects_.bodies(); }

  /// ActiveEffects
  bool EffectsFollowTheirJoints() const { return effects_.FollowTheirJoints(); }
  void PushInto(const mjModel& model, mjData& data, std::span<double> forces) noexcept {
    effects_.PushInto(model, data, forces);
  }
  /// From now on tells in AdvanceSteps what effects of other machines would push with where
  /// this one is (Machine::DiffersInPushes): they remember what they do there, and do nothing.
  /// Only while forces are held.
  void TellPushesOf(const std::vector<Machine>& others);
  /// Of each, its forces less those of this machine, means of the steps. nv x others [N, N m]
  Eigen::MatrixXd OtherPushes() const { return other_pushes_ / told_steps_; }
  /// Goes on as another one of the same machine would: the tick that it is at, and what
  /// its effects remember.
  void Recall(const Stepper& other) noexcept;

 private:
  void Act(const mjModel& model, mjData& data, TickControl& control) noexcept;
  void Command(mjData& data, const TickControl& control) const noexcept;

  ActiveEffects effects_;
  std::vector<ActiveEffects> others_;
  Eigen::MatrixXd other_pushes_;  // nv x others, sums
  double told_steps_ = 1.0;
  double tick_;  // [s]
  int substeps_;
  int substep_ = 0;
  int stage_ = 0;  // of a Runge-Kutta step
  std::int64_t ticks_ = 0;
  bool reads_forces_ = false;   // or accelerations
  std::vector<int> sensors_;    // addresses
  std::vector<int> actuators_;  // addresses
  std::vector<int> off_;
  std::vector<double> outputs_;
  std::vector<double> inputs_;
  std::vector<double> held_;  // empty: none
};

/// A plant about to run.
struct StartedPlant {
  ModelPtr model;  ///< without what is only to be looked at
  DataPtr data;    ///< at rest
};

/// @param start  sensor channel -> reading at rest (StartPosition)
StartedPlant StartPlant(const Machine& machine,
                        const std::map<std::string, double>& start);

/// Whether the run has diverged: MuJoCo resets the state then and goes on.
bool HasDiverged(const mjData& data);

}  // namespace mjdiag
