#pragma once
// The twin of a nonlinear machine: its plant in MuJoCo, run beside the measurement.
// Sensitivities follow the first order of every physics step (tangent.h), its map that of what
// sticks in the very step (sticking_maps.h), with M, D, K and moments of tendons of the machine
// at rest, which it leaves by little. The force df is that of a unit of each unknown where the
// run is: a damper's with the velocity at the end of a step, as Euler's method has it; a mass's
// with the acceleration of the step; dry friction's +-1 where the joint or the tendon slides, 0
// where it sticks; that of numbers that have no law of their own here, as of tendons and of
// drives that feed back, what they add to M, D, K and Gamma at rest. At the end of a tick the
// gain takes its part, S -= L C S.

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "mjdiag/diagnosis/twin/moved_rest.h"
#include "mjdiag/diagnosis/twin/twin.h"
#include "mjdiag/plugin/effects/active_effect.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/replay/sticking_maps.h"
#include "mjdiag/plugin/replay/uncertain_machine.h"

namespace mjdiag {

class PlantTwin final : public Twin {
 public:
  /// @param gains  at least one, L of 2 nv x ny
  /// @param block  ticks of a block
  PlantTwin(const Machine& machine, UncertainMachine uncertain,
            std::vector<TwinGain> gains, Eigen::Index block);

  void UseGain(std::size_t gain) noexcept override {
    gain_ = gain;
    pulled_ = !this->gain().L.isZero(0.0);
  }
  void Start(const Eigen::VectorXd& theta) noexcept override;
  void Start(const Eigen::VectorXd& theta, const TwinState& state,
             Eigen::Index tick) noexcept override;
  void StateAt(const Eigen::VectorXd& reading, TwinState& state) noexcept override;
  void ReadState(TwinState& state) const noexcept override;
  void Predict(Eigen::VectorXd& reading) noexcept override;
  void Step(std::span<const double> inputs,
            const Eigen::VectorXd& innovation) noexcept override;
  const Eigen::MatrixXd& EndBlock() noexcept override;
  void Shift(const Eigen::VectorXd& change) noexcept override;
  void Drifted(const Eigen::VectorXd& rates) noexcept override;

 private:
  /// A number of the plant with what a unit of it means where the machine is.
  struct Number {
    ModelParameter number;
    std::vector<Eigen::Index> factors;
    int at = 0;        ///< degree of freedom, place among the commands, or tendon
    ModelPart part{};  ///< of those without a law of their own
    bool at_command = false;
    bool inertial = false;  ///< a mass or a rotor
    double slope = 1.0;     ///< of the number by the logarithm of its factor
    double change = 0.0;    ///< of the number, in what it is
  };
  /// Friction that effects make, as it is in this step.
  struct Resistance {
    int dof = 0;
    Eigen::Index unknown = 0;
    double times = 1.0;
    double force = 0.0;
  };

  void Reset() noexcept;
  void SetParameters() noexcept;
  /// Of a step in which these joints, then tendons, stick.
  const StickingMaps::Map& MapOf(std::uint64_t sticking) noexcept;
  /// What effects do in a step, their friction as it is known to be.
  void Act() noexcept;
  void AddTickForces() noexcept;
  /// Of springs and masses at rest, before a step.
  void AddStepForces() noexcept;
  /// After a step: of what depends on where it went.
  void Substep() noexcept;
  /// Sensitivities over a step, the first `forced` of them under forces.
  void Lift(const StickingMaps::Map& map, Eigen::Index count, Eigen::Index forced,
            const Eigen::MatrixXd& force, Eigen::MatrixXd& S) noexcept;
  /// Columns of the unknowns of that number.
  void AddForce(Eigen::MatrixXd& forces, const Number& number, Eigen::Index dof,
                double force) const noexcept;
  /// Of the force in work_force_, at a unit of the number.
  void AddWorkForce(const Number& number) noexcept;
  void AddFriction(int type, Eigen::Index at, double force) noexcept;

  Machine machine_;
  UncertainMachine uncertain_;
  bool pulled_ = false;
  ModelPtr model_;
  DataPtr data_;
  ActiveEffects effects_;
  /// Those of friction once more, to know what is due to them.
  ActiveEffects friction_;
  std::vector<Resistance> resistances_;
  MovedRest moved_rest_;
  Eigen::VectorXd start_;  // qpos
  Eigen::VectorXd state_;  // work space
  Eigen::MatrixXd C_, Gamma_, M_, K_, D_;
  Eigen::MatrixXd K_rest_, D_rest_;  // what is not of springs and dampers in joints
  Eigen::MatrixXd M_now_;
  std::vector<Number> numbers_;
  bool heavy_ = false;       // MuJoCo derives constants from some
  Eigen::MatrixXd moments_;  // of tendons at rest, nv x tendons

  Eigen::MatrixXd place_;  // of coordinates by readings, nq x ny
  StickingMaps maps_;

  double time_ = 0.0;
  Eigen::VectorXd tone_, before_, acceleration_, work_force_;
  Eigen::VectorXd lifted_, by_force_;  // in whole registers
  std::vector<double> outputs_;
  Eigen::Index in_block_ = 0;
  Eigen::MatrixXd drive_, force_, sensitivity_, drift_force_;
};

}  // namespace mjdiag
