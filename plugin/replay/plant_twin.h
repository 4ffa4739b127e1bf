#pragma once
// The twin of a nonlinear machine: its plant in MuJoCo, run beside the measurement.
// Sensitivities follow the first order of every physics step of h (tangent.h),
//
//   dv' = dv + G (df - K dq - D dv - B_s dv),    dq' = dq + h dv'
//   G = h (M + h D)^-1 M W^-1,    W = M + sum over the joints that stick of r e e^T
//
// with M, D, K of the machine at rest, which it leaves by little, and the joints that
// stick those of the very step. df is the force of a unit of each unknown where the run
// is: a damper's with the velocity at the end of a step, as Euler's method has it; a
// mass's with the acceleration of the step; dry friction's +-1 where the joint slides, 0
// where it sticks. At the end of a tick the gain takes its part, S -= L C S.

#include <mujoco/mujoco.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mjdiag/diagnosis/twin/running_tones.h"
#include "mjdiag/diagnosis/twin/twin.h"
#include "mjdiag/plugin/effects/active_effect.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/replay/uncertain_machine.h"

namespace mjdiag {

class PlantTwin final : public Twin {
 public:
  /// @param gains  at least one, L of 2 nv x ny
  /// @param block  ticks of a block
  PlantTwin(const Machine& machine, UncertainMachine uncertain,
            std::vector<TwinGain> gains, Eigen::Index block);

  Eigen::Index outputs() const override { return C_.rows(); }
  Eigen::Index inputs() const override { return u_.size(); }
  Eigen::Index states() const override { return state_.size(); }
  Eigen::Index unknowns() const override { return theta_.size(); }
  Eigen::Index start_unknowns() const override { return uncertain_.start.cols(); }
  Eigen::Index block() const override { return block_; }
  const std::vector<TwinGain>& gains() const override { return gains_; }

  void UseGain(std::size_t gain) noexcept override {
    gain_ = gain;
    pulled_ = !gains_[gain_].L.isZero(0.0);
  }
  void Start(const Eigen::VectorXd& theta) noexcept override;
  void Start(const Eigen::VectorXd& theta,
             const Eigen::VectorXd& state) noexcept override;
  void StateAt(const Eigen::VectorXd& reading,
               Eigen::VectorXd& state) noexcept override;
  void ReadState(Eigen::VectorXd& state) const noexcept override;
  void Predict(Eigen::VectorXd& reading) noexcept override;
  void Step(std::span<const double> inputs,
            const Eigen::VectorXd& innovation) noexcept override;
  const Eigen::MatrixXd& EndBlock() noexcept override;
  void Shift(const Eigen::VectorXd& change) noexcept override;

 private:
  /// A number of the plant with what a unit of it means where the machine is.
  struct Number {
    PlantNumber number;
    std::vector<Eigen::Index> factors;
    int at = 0;         ///< degree of freedom, or place among the commands
    ModelPart inertia;  ///< of masses
    double value = 1.0;
  };
  /// The map of a step with these joints sticking.
  struct Map {
    std::uint64_t sticking = 0;
    bool known = false;
    Eigen::MatrixXd Q, V, G;
  };

  void SetParameters() noexcept;
  const Map& MapOf(std::uint64_t sticking) noexcept;
  void AddTickForces() noexcept;
  /// Of springs and masses at rest, before a step.
  void AddStepForces() noexcept;
  /// After a step: of what depends on where it went.
  void Substep() noexcept;
  /// Columns of the unknowns of that number.
  void AddForce(Eigen::MatrixXd& forces, const Number& number, Eigen::Index dof,
                double force) const noexcept;
  void AddInertial(const Number& number) noexcept;

  Machine machine_;
  UncertainMachine uncertain_;
  std::vector<TwinGain> gains_;
  std::size_t gain_ = 0;
  bool pulled_ = false;
  Eigen::Index block_;
  ModelPtr model_;
  DataPtr data_;
  ActiveEffects effects_;
  Eigen::VectorXd start_;  // qpos
  Eigen::VectorXd state_;  // work space
  Eigen::MatrixXd C_, Gamma_, M_, K_, D_;
  Eigen::MatrixXd K_rest_, D_rest_;  // what is not of springs and dampers in joints
  Eigen::MatrixXd M_now_;
  std::vector<Number> numbers_;
  bool heavy_ = false;  // masses are among them

  Eigen::MatrixXd place_;    // of coordinates by readings, nq x ny
  Eigen::Index active_ = 0;  // columns of S that are in use
  Eigen::Index first_tone_;  // of the unknowns
  Eigen::VectorXd theta_;
  std::array<Map, 16> maps_;
  std::size_t next_map_ = 0;
  Eigen::MatrixXd inertia_, identity_, work_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  std::vector<double> stick_r_, stick_rb_;  // by dof

  double time_ = 0.0;
  Eigen::VectorXd u_, tone_, before_, acceleration_, inertial_;
  RunningTones tones_;
  std::vector<double> outputs_;
  Eigen::MatrixXd S_, drive_, drive_work_, force_, read_, sensitivity_, sum_;
};

}  // namespace mjdiag
