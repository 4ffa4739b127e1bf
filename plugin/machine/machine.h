#pragma once
// A machine: a setup with its plant loaded, and what follows from the two. It is made
// once, does not change, and is cheap to copy and to vary: copies share the model and
// what has been derived from it.
//
//   const Machine bonder(ReadSetup("mjcf/ab383"));
//   const Machine worn = bonder.With({{{"zeta_x", 1.2}}, {}});

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "mjdiag/plugin/effects/changes.h"
#include "mjdiag/plugin/plant/fault.h"
#include "mjdiag/plugin/plant/rest.h"
#include "mjdiag/plugin/setup/setup.h"

namespace mjdiag {

class Machine {
 public:
  /// Loads the plant and makes it what the setup says: gravity, static friction, the
  /// effects that the MJCF carries. InputError if its time step does not fit the rates
  /// or an element that the setup names is missing.
  explicit Machine(Setup setup);
  /// Of a copy of a model that PreparePlant has made ready.
  Machine(Setup setup, const mjModel& prepared);

  /// With the noise that effects add in its channels.
  const Setup& setup() const { return *setup_; }
  const Rates& rates() const { return setup_->rates; }
  const Channels& channels() const { return setup_->channels; }
  /// The nonlinear plant, native effects and faults in it.
  const mjModel& plant() const { return *plant_; }
  /// Index into mjData.sensordata and mjData.ctrl of every sensor and actuator channel.
  const std::vector<int>& sensor_addresses() const { return sensor_addresses_; }
  const std::vector<int>& actuator_addresses() const { return actuator_addresses_; }

  /// What With has put in so far.
  const Changes& changes() const { return changes_; }
  /// All that act: those that the MJCF carries, then those of the changes.
  std::vector<PlacedEffect> effects() const;

  /// Where it settles without input, else how it is drawn (FindRest; held where the setup
  /// has controllers), found when first asked for.
  const RestPose& rest_pose() const&;
  /// The configuration of it, nq: where runs begin.
  const Eigen::VectorXd& rest() const& { return rest_pose().qpos; }
  Eigen::VectorXd rest() const&& { return std::as_const(*this).rest(); }
  /// M, D, K, Gamma and b about it, as if no constraint acted (Linearize), found when
  /// first asked for: of any machine what pushes and what sees where, with b of sensors
  /// that read velocities (VelocityOutputMatrix).
  const MechanicalModel& mechanics() const&;
  MechanicalModel mechanics() const&& { return std::as_const(*this).mechanics(); }
  /// That, of a machine whose motion about rest it tells. InputError as
  /// RequireScalarJoints.
  const MechanicalModel& linear() const&;
  MechanicalModel linear() const&& { return std::as_const(*this).linear(); }

  /// This machine with numbers, faults and effects besides those that it has. InputError
  /// names a fault parameter, effect, site or value that the plant does not allow.
  Machine With(const Changes& changes) const;
  /// With numbers of the plant that many times what they are.
  Machine WithNumbers(const NumberFactors& factors) const;
  /// The same physics in that many steps a control tick.
  Machine WithSubsteps(int substeps) const;
  /// The same physics as if its steps h were none, to second order: semi-implicit Euler is a
  /// leapfrog, whose velocities are half a step behind its positions,
  ///
  ///   (M + h D / 2) (v' - v) / h = f - D (v + v') / 2
  ///
  /// of dampers D that it takes at the end of a step, (M - h D / 2) of those that it takes at
  /// the beginning: inputs act h / 2 later here, and rotors make up for what damps.
  /// @param share  of them that is taken away: of a record in steps of h / 10 nine tenths
  Machine WithoutSteps(double share = 1.0) const;
  /// With what With and WithoutSteps have made of another one since it had the changes of
  /// this one, in its steps: this machine with another load, for example.
  Machine ChangedAs(const Machine& other) const;
  /// Whether another one is this machine but for effects that push at joints, and add no
  /// bodies: from the same state and with the same commands they differ by forces alone.
  bool DiffersInPushes(const Machine& other) const;
  /// The same plant, resting where it does, under another setup that names the same
  /// channels.
  Machine WithSetup(Setup setup) const;
  /// The same machine with that noise of the sensors [unit of each]; what effects add
  /// comes on top.
  Machine WithSensorNoise(const Eigen::VectorXd& sd) const;

 private:
  struct Derived;

  void Adopt(std::shared_ptr<const mjModel> plant);
  void DampBetweenSteps(double share);

  std::shared_ptr<const Setup> setup_;
  std::shared_ptr<const mjModel> plant_;
  std::vector<int> sensor_addresses_;
  std::vector<int> actuator_addresses_;
  Changes changes_;
  double without_steps_ = 0.0;  // a share of them
  std::shared_ptr<Derived> derived_;
};

/// Makes a loaded model the plant of a setup: gravity, static friction, native effects
/// that the MJCF carries, and the slot for the mark of an instance. Once a model.
void PreparePlant(const Physics& physics, mjModel& model);

}  // namespace mjdiag
