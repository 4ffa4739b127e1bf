#pragma once
// The twin of a nonlinear machine: its plant in MuJoCo, run beside the measurement.
// Sensitivities follow the first order of every physics step of h (tangent.h),
//
//   dv' = dv + G (df - K dq - D dv - B_s dv),    dq' = dq + h dv'
//   G = h (M + h D)^-1 M W^-1,    W = M + sum over the joints that stick of r e e^T
//
// with M, D, K of the machine at rest, which it leaves by little, and the joints that
// stick those of the very step. df is the force of a unit of each unknown (Lever) where
// the run is: a damper's with the velocity at the end of a step, as Euler's method has
// it; dry friction's +-1 where the joint slides, 0 where it sticks.

#include <mujoco/mujoco.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mjdiag/diagnosis/twin/linear_twin.h"
#include "mjdiag/diagnosis/twin/twin.h"
#include "mjdiag/plugin/effects/active_effect.h"
#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/plant/fault.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {

/// What is not known of a machine, in this order: its fault parameters, the dry
/// friction of joints that have some, and tones on its commands.
struct UncertainPlant {
  std::vector<FaultParameter> faults;
  std::vector<int> rubbing;  ///< joints with dry friction
  std::vector<UnknownTone> tones;
  std::vector<Unknown> unknowns;
  Eigen::MatrixXd start;  ///< see UncertainModel
};

class PlantTwin final : public Twin {
 public:
  /// @param gain   L, 2 nv x ny
  /// @param block  ticks of a block
  PlantTwin(const Machine& machine, UncertainPlant uncertain,
            const Eigen::MatrixXd& gain, Eigen::Index block);

  Eigen::Index outputs() const override { return C_.rows(); }
  Eigen::Index inputs() const override { return u_.size(); }
  Eigen::Index unknowns() const override { return theta_.size(); }
  Eigen::Index start_unknowns() const override { return start_directions_.cols(); }
  Eigen::Index block() const override { return block_; }

  void Start(const Eigen::VectorXd& theta, bool at_rest) noexcept override;
  void Place(const Eigen::VectorXd& reading) noexcept override;
  void Remember() noexcept override;
  void Predict(Eigen::VectorXd& reading) noexcept override;
  void Step(std::span<const double> inputs,
            const Eigen::VectorXd& innovation) noexcept override;
  const Eigen::MatrixXd& EndBlock() noexcept override;
  void Shift(const Eigen::VectorXd& change) noexcept override;

 private:
  struct Pull {
    Eigen::Index unknown;
    int dof;
    double coefficient;
  };
  /// The map of a step with these joints sticking.
  struct Map {
    std::uint64_t sticking = 0;
    bool known = false;
    Eigen::MatrixXd Q, V, G;
  };

  void SetParameters() noexcept;
  const Map& MapOf(std::uint64_t sticking) noexcept;
  void Substep() noexcept;

  Machine machine_;
  UncertainPlant uncertain_;
  Eigen::MatrixXd L_;
  Eigen::Index block_;
  ModelPtr model_;
  DataPtr data_;
  ActiveEffects effects_;
  Eigen::VectorXd start_;  // qpos
  Eigen::VectorXd state_;  // work space
  Eigen::MatrixXd C_, Gamma_, M_, K_, D_;
  Eigen::MatrixXd K_rest_, D_rest_;  // what is not of springs and dampers in joints
  std::vector<Pull> dampers_, springs_;
  struct Gear {
    Eigen::Index unknown;
    Eigen::Index input;
  };
  std::vector<Gear> gears_;

  Eigen::MatrixXd place_;             // of coordinates by readings, nq x ny
  Eigen::VectorXd remembered_;        // deviation from rest, 2 nq
  Eigen::MatrixXd start_directions_;  // of the state, by a standard deviation
  Eigen::Index active_ = 0;           // columns of S that are in use
  Eigen::VectorXd theta_, slope_;
  std::array<Map, 16> maps_;
  std::size_t next_map_ = 0;
  Eigen::MatrixXd inertia_, identity_, work_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  std::vector<double> stick_r_, stick_rb_;  // by dof

  double time_ = 0.0;
  Eigen::Index in_block_ = 0;
  Eigen::VectorXd u_, tone_, phase_, turn_;
  std::vector<double> outputs_;
  Eigen::MatrixXd S_, drive_, drive_work_, force_, sensitivity_, sum_;
};

/// With standard deviations of `spread` of every logarithm and 1 of every tone.
UncertainPlant MakeUncertainPlant(const Machine& machine);

}  // namespace mjdiag
