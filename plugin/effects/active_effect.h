#pragma once
// Effects that MuJoCo does not have, as they act while the machine runs: on the sensor
// readings once a control tick, on the commands and as generalised forces in every
// physics step. What an effect does is in its own file (effect.h).

#include <mujoco/mujoco.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag {

struct PlacedEffect;

/// Where a body is that an effect adds to its joint: a state of the machine like the joint's
/// own.
struct CarriedBody {
  double position = 0.0;
  double velocity = 0.0;
  bool has_begun = false;  ///< before, it is where its joint is
};

/// Nothing in it allocates, locks or throws. Effects with a memory begin at rest, at
/// the state of their first step; values are read when it is made.
class ActiveEffect {
 public:
  virtual ~ActiveEffect() = default;
  /// Changes readings, one for each sensor channel of the setup, taken at `time` [s]
  /// since the start of the run, where data have positions and velocities.
  virtual void Distort(const mjModel&, const mjData&, std::span<double> /*readings*/,
                       double /*time*/) noexcept {}
  /// Changes the command in data.ctrl, of this physics step.
  virtual void Drive(const mjModel&, mjData&) noexcept {}
  /// What it adds to the damping of its joint in this step [N s/m]. Less than nothing
  /// takes off what the joint has: all effects together take no more than that.
  virtual double Damping(const mjModel&, const mjData&) const noexcept { return 0.0; }
  /// Adds its force to data.qfrc_applied, from positions and velocities of this step.
  virtual void Push(const mjModel&, mjData&) noexcept {}
  /// Whether its force follows from where its own joint is and how fast, from time and from what
  /// it remembers: it looks at nothing else in mjData.
  virtual bool FollowsItsJoint() const noexcept { return false; }
  /// Changes the bounds of dry friction, when all commands and forces of this step
  /// are known.
  virtual void Bind(const mjModel&, mjData&) noexcept {}
  /// Null of one that adds no body.
  virtual CarriedBody* Body() noexcept { return nullptr; }
  /// Takes the memory of another one of the same effect at the same site.
  virtual void Recall(const ActiveEffect&) noexcept {}
};

/// An effect with a memory, which its class holds as plain values.
template <class Self>
class RememberingEffect : public ActiveEffect {
 public:
  void Recall(const ActiveEffect& other) noexcept final {
    static_cast<Self&>(*this) = static_cast<const Self&>(other);
  }
};

/// All active effects of a run.
class ActiveEffects {
 public:
  /// @param model    has the native effects in it already
  /// @param effects  all that act, those that the MJCF carries among them
  /// InputError as CheckEffect.
  ActiveEffects(const Channels& channels, const mjModel& model,
                const std::vector<PlacedEffect>& effects);

  /// The readings of a control tick, setup order.
  void Distort(const mjModel& model, const mjData& data, std::span<double> readings,
               double time) noexcept;
  /// Once a physics step, after positions and velocities and before accelerations,
  /// with the commands of the tick in data.ctrl: changes them and sets
  /// data.qfrc_applied of the joints that have such effects.
  /// @param off  actuators that are an open circuit, whatever their command
  void Act(const mjModel& model, mjData& data, std::span<const int> off = {}) noexcept;
  /// Whether whatever pushes at a joint follows that alone (FollowsItsJoint), and no effect adds
  /// a body.
  bool FollowTheirJoints() const;
  /// What they push with then, by qpos, qvel and time of `data` alone: the same as Act does,
  /// without commands. nv
  void PushInto(const mjModel& model, mjData& data, std::span<double> forces) noexcept;
  /// Takes the forces off again.
  void Release(mjData& data) noexcept;
  /// Takes the memory of all from another run of the same machine.
  void Recall(const ActiveEffects& other) noexcept;

  struct BodyOf {
    std::string effect;  ///< "flexible_mode@X"
    int number = 0;      ///< of those with that name, from 0
    int dof = 0;
    CarriedBody* body = nullptr;
  };
  /// Those that effects add.
  const std::vector<BodyOf>& bodies() const { return bodies_; }

 private:
  /// The force of all that damps the joints.
  void Damp(const mjModel& model, mjData& data) noexcept;

  std::vector<std::unique_ptr<ActiveEffect>> effects_;
  std::vector<int> dofs_;    // of those that act at joints, in their order
  std::vector<int> dof_of_;  // of every effect; -1: not at a joint
  std::vector<BodyOf> bodies_;
  std::vector<double> damping_;  // nv, of a step
};

/// The channels with what effects add to the noise of their sensors.
Channels WithNoiseOf(Channels channels, const std::vector<PlacedEffect>& effects);

}  // namespace mjdiag
