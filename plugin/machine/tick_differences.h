#pragma once
// The tangent of a control tick of any model, by central differences of the tick itself
// (tick_map.h): effects, constraints, contacts and activations are in it. Steps are 1e-6 of
// what the model is sized in: of a metre times its extent, of a radian, of that a second, and
// the force that makes this velocity in a tick. Truncation and rounding are then both about
// 1e-10. Where a joint sticks by dry friction a tick that ends it at rest has a tangent that
// says so: steps are larger than the zone in which MuJoCo's friction is a damper, and smaller
// than what friction stops in a tick.

#include <Eigen/Core>
#include <span>
#include <vector>

#include "mjdiag/plugin/machine/tick_map.h"
#include "mjdiag/plugin/plant/tangent.h"

namespace mjdiag {

/// Of n physics steps that are one like the other, with forces that are held:
///   A = A_1^n,  B = (I + A_1 + .. + A_1^(n - 1)) B_1
/// A motion changes the tangent little within a tick, and where no constraint switches
/// nothing else does.
TickTangent Repeated(const TickTangent& step, int steps);

/// 0 .. nv - 1
std::vector<Eigen::Index> AllDofs(const mjModel& model);

class TickDifferences {
 public:
  /// @param map   has to outlive it
  /// @param dofs  those with columns in B and D; the others are 0
  TickDifferences(TickMap& map, double tick, std::vector<Eigen::Index> dofs);

  /// About the Run that was the last one. NumericalError if a tick beside it diverges.
  /// @param without  degrees of freedom whose columns q and v are left 0
  TickTangent Of(const PlantState& from, const Eigen::VectorXd& forces,
                 std::int64_t tick, TickControl& control,
                 std::span<const Eigen::Index> without = {});
  /// The same of its first physics step alone, of which forces are a linear function where
  /// nothing sticks.
  TickTangent OfFirstStep(const PlantState& from, const Eigen::VectorXd& forces,
                          std::int64_t tick, TickControl& control,
                          std::span<const Eigen::Index> without = {});
  /// Computes columns q and v of some degrees of freedom anew, and of a whole tick w, as
  /// secants over what is not known of them:
  ///   (F(x + sd_i e_i) - F(x - sd_i e_i)) / (2 sd_i)
  /// M. Norgaard, N. K. Poulsen, O. Ravn, "New developments in state estimation for
  /// nonlinear systems", Automatica 36(11), 2000.
  /// @param of_step    whether the tangent is of the first physics step
  /// @param positions  with columns q
  /// @param sd         of the state, ns
  /// @param force_sd   of the forces, nv
  void Refresh(const PlantState& from, const Eigen::VectorXd& forces, std::int64_t tick,
               TickControl& control, std::span<const Eigen::Index> dofs, bool of_step,
               bool positions, const Eigen::VectorXd& sd,
               const Eigen::VectorXd& force_sd, TickTangent& tangent);
  /// Slopes of what effects that follow their joints push with, by the position and the
  /// velocity of each, over what is not known of them.
  struct PushSlopes {
    Eigen::VectorXd position;  ///< nv [N/m, N m/rad]
    Eigen::VectorXd velocity;  ///< the same s
    /// Takes them out of the tangent of a physics step (-1), or puts them in.
    void AddTo(TickTangent& step, double sign) const;
  };
  /// @param sd  of the state, ns
  PushSlopes SlopesOf(const PlantState& from, std::int64_t tick,
                      const Eigen::VectorXd& sd);
  /// Velocity that a force of 1 gives a degree of freedom in a tick where the model is drawn.
  double VelocityOf(Eigen::Index dof) const {
    return steps_[force_steps_.size() + dof] / force_steps_[dof];
  }

 private:
  /// Of ticks, or of first steps.
  using Probe = const TickMap::Result& (TickMap::*)(const PlantState&,
                                                    const Eigen::VectorXd&,
                                                    std::int64_t, TickControl&);
  TickTangent By(Probe probe, const PlantState& from, const Eigen::VectorXd& forces,
                 std::int64_t tick, TickControl& control,
                 std::span<const Eigen::Index> without);
  void Column(Probe probe, const PlantState& from, const Eigen::VectorXd& forces,
              std::int64_t tick, TickControl& control, Eigen::Index state, double step,
              TickTangent& tangent);
  void ForceColumn(Probe probe, const PlantState& from, const Eigen::VectorXd& forces,
                   std::int64_t tick, TickControl& control, Eigen::Index dof,
                   double step, TickTangent& tangent);

  TickMap& map_;
  std::vector<Eigen::Index> dofs_;
  Eigen::VectorXd steps_;        // of the state
  Eigen::VectorXd force_steps_;  // of every degree of freedom
};

}  // namespace mjdiag
