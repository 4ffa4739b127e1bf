#include "mjdiag/plugin/plant/rest.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mjdiag/plugin/plant/plant_forces.h"
#include "mjdiag/plugin/plant/tangent_coordinates.h"
#include "mjdiag/signals/decompositions.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMostSteps = 400;
constexpr double kAtRest = 1e-6;      // m/s^2 or rad/s^2
constexpr double kTolerance = 1e-13;  // m or rad
/// A step that does not help any more is what rounding leaves.
constexpr double kRounding = 1e-9;  // m or rad
/// Stiffness over mass of what nothing holds, as rounding leaves it [1/s^2].
constexpr double kFree = 1e-8;
/// The same of what falls over.
constexpr double kUnstable = -1e-5;

/// In coordinates of unit mass, x = W^1/2 q.
struct Slope {
  MatrixXd stiffness;
  SymmetricEigenPairs symmetric;  // of its symmetric part
};

class RestSearch {
 public:
  explicit RestSearch(const mjModel& model)
      : model_(model),
        drawn_(VectorXd::Map(model.qpos0, model.nq)),
        bare_model_(WithoutJointSprings(model)),
        forces_(model, drawn_),
        bare_(*bare_model_, drawn_),
        unit_(forces_.Mass().diagonal().cwiseSqrt().cwiseInverse()),
        reach_(model.nv) {
    for (int dof = 0; dof < model.nv; ++dof) {
      reach_[dof] = IsLength(model, dof) ? std::max(model.stat.extent, 1e-3) : 1.0;
    }
  }

  RestPose Find(bool held) {
    const bool drawn_at_rest = AtRest(ForceAt(drawn_));
    std::optional<VectorXd> balanced;
    VectorXd from = drawn_;
    constexpr int kPushes = 5;
    steps_ = 0;
    for (int push = 0; push <= kPushes; ++push) {
      const std::optional<VectorXd> rest = Settle(from);
      if (!rest) break;
      const Slope slope = SlopeAt(*rest);
      if (slope.symmetric.values[0] >= UnstableBelow(slope))
        return {*rest, true, NoForce(), true};
      if (!balanced) balanced = rest;
      if (held && drawn_at_rest) break;
      from = Displaced(model_, *rest, PushOff(slope));
    }
    if (balanced) return {*balanced, true, NoForce(), false};
    if (const auto rest = SettleInMotion()) return {*rest, true, NoForce(), true};
    return At(drawn_);
  }

  RestPose At(const VectorXd& qpos) {
    const VectorXd force = ForceAt(qpos);
    const Slope slope = SlopeAt(qpos);
    const bool stable = slope.symmetric.values[0] >= UnstableBelow(slope);
    if (AtRest(force)) return {qpos, true, NoForce(), stable};
    return {qpos, false, -force, stable};
  }

 private:
  VectorXd NoForce() const { return VectorXd::Zero(model_.nv); }

  bool AtRest(const VectorXd& force) const {
    return (force.array() * unit_.array().square()).abs().maxCoeff() < kAtRest;
  }

  VectorXd ForceAt(const VectorXd& qpos) {
    forces_.MoveTo(qpos);
    return forces_.Total();
  }

  Slope SlopeAt(const VectorXd& qpos) {
    // Newton's method needs no exact slope, and constraints change over their width.
    constexpr double kStep = 1e-3;
    constexpr double kConstraintStep = 1e-6;
    bare_.MoveTo(qpos);
    MatrixXd K = -ByPosition(
        bare_, [&] { return bare_.Smooth(); }, kStep);
    K += ScalarSprings(model_).asDiagonal();
    forces_.MoveTo(qpos);
    forces_.Update();
    if (forces_.data().nefc > 0) {
      const auto of_constraints = [&] {
        forces_.Update();
        return forces_.OfConstraints();
      };
      K -= ByPosition(forces_, of_constraints, kConstraintStep);
    }
    Slope slope;
    slope.stiffness = unit_.asDiagonal() * K * unit_.asDiagonal();
    slope.symmetric = SymmetricEigenDecomposition(
        0.5 * (slope.stiffness + slope.stiffness.transpose()));
    return slope;
  }

  /// Below: it falls over. Of stiff machines rounding alone is more.
  static double UnstableBelow(const Slope& slope) {
    return std::min(kUnstable, -1e-12 * slope.symmetric.values.cwiseAbs().maxCoeff());
  }

  /// A little of the coordinates that fall fastest.
  VectorXd PushOff(const Slope& slope) const {
    constexpr double kPush = 1e-3;
    VectorXd way = unit_.cwiseProduct(slope.symmetric.vectors.col(0));
    Index most = 0;
    const double size = way.cwiseQuotient(reach_).cwiseAbs().maxCoeff(&most);
    return way * (kPush / (way[most] > 0.0 ? size : -size));
  }

  double SizeOf(const VectorXd& step) const {
    return step.cwiseQuotient(reach_).cwiseAbs().maxCoeff();
  }

  /// (K + mu W)^-1 f of the directions that a force acts in or a stiffness holds.
  VectorXd StepOf(const Slope& slope, const VectorXd& force, double mu) const {
    const auto& [values, vectors] = slope.symmetric;
    const double free = std::max(kFree, 1e-15 * static_cast<double>(values.size()) *
                                            values.cwiseAbs().maxCoeff());
    const VectorXd along = vectors.transpose() * unit_.cwiseProduct(force);
    std::vector<Index> kept;
    for (Index i = 0; i < values.size(); ++i) {
      const double acceleration =
          std::abs(along[i]) * unit_.cwiseProduct(vectors.col(i)).cwiseAbs().maxCoeff();
      if (std::abs(values[i]) > free || acceleration > kAtRest) kept.push_back(i);
    }
    if (kept.empty()) return VectorXd::Zero(force.size());
    const MatrixXd basis = vectors(Eigen::all, kept);
    MatrixXd K = basis.transpose() * slope.stiffness * basis;
    K.diagonal().array() += mu;
    const VectorXd there = Solve(K, along(kept));
    return unit_.cwiseProduct(basis * there);
  }

  /// The longest step downhill that is not longer than that.
  VectorXd StepWithin(const Slope& slope, const VectorXd& force, double longest) const {
    const double least = slope.symmetric.values[0];
    const double most = slope.symmetric.values.cwiseAbs().maxCoeff();
    double mu = least < -kFree ? -1.5 * least : 0.0;
    VectorXd step = StepOf(slope, force, mu);
    if (step.allFinite() && SizeOf(step) <= longest) return step;
    mu = std::max(mu, 1e-6 * std::max(1.0, most));
    for (int i = 0; i < 200; ++i) {
      step = StepOf(slope, force, mu);
      if (step.allFinite() && SizeOf(step) <= longest) break;
      mu *= 2.0;
    }
    return step;
  }

  /// Goes downhill until it rests; nothing if it does not.
  std::optional<VectorXd> Settle(VectorXd qpos) {
    constexpr double kLongest = 1.0;
    double longest = 0.3;
    VectorXd force = ForceAt(qpos);
    Slope slope = SlopeAt(qpos);
    for (; steps_ < kMostSteps; ++steps_) {
      if (!force.allFinite()) return std::nullopt;
      const VectorXd step = StepWithin(slope, force, longest);
      const double size = step.cwiseAbs().maxCoeff();
      const VectorXd next = Displaced(model_, qpos, step);
      if (size <= kTolerance && AtRest(force)) return next;
      const VectorXd there = ForceAt(next);
      // Work that the forces do on the way, and power that is left at its end.
      const double before = force.dot(step);
      const double after = there.dot(step);
      const bool smaller = unit_.cwiseProduct(there).norm() <
                           (1.0 - 1e-4) * unit_.cwiseProduct(force).norm();
      const bool downhill = before > 0.0 && after >= -0.5 * before;
      if (there.allFinite() && (smaller || downhill) && after >= -2.0 * before) {
        const bool as_expected = std::abs(after) <= 0.9 * std::abs(before);
        if (as_expected || size < longest) longest = std::min(kLongest, 2.0 * longest);
        qpos = next;
        force = there;
        slope = SlopeAt(qpos);
        continue;
      }
      if (size <= kRounding && AtRest(force)) return qpos;
      longest = 0.25 * std::min(longest, SizeOf(step));
      if (longest < 1e-14) return std::nullopt;
    }
    return std::nullopt;
  }

  /// Moves as MuJoCo does, in a thick fluid, until it rests or creeps. For what falls on
  /// something in many ways, and what only the friction of contacts holds.
  std::optional<VectorXd> SettleInMotion() {
    constexpr int kMostMoves = 8000;
    constexpr double kFluid = 10.0;   // 1/s
    constexpr double kStill = 1e-4;   // 1/s, of what is far
    constexpr double kCreeps = 2e-3;  // the same
    const ModelPtr fluid = CopyModel(model_);
    fluid->opt.disableflags |= mjDSBL_FRICTIONLOSS;
    for (int dof = 0; dof < model_.nv; ++dof) {
      fluid->dof_damping[dof] += kFluid / (unit_[dof] * unit_[dof]);
    }
    const DataPtr data = MakeData(*fluid);
    VectorXd::Map(data->qpos, model_.nq) = drawn_;
    const auto speed = [&] {
      return VectorXd::Map(data->qvel, model_.nv)
          .cwiseQuotient(reach_)
          .cwiseAbs()
          .maxCoeff();
    };
    // mj_step without the control callback.
    const auto run = [&](const mjModel& in, int moves) {
      for (int i = 0; i < moves; ++i) {
        mj_fwdPosition(&in, data.get());
        mj_fwdVelocity(&in, data.get());
        mj_fwdActuation(&in, data.get());
        mj_fwdAcceleration(&in, data.get());
        mj_fwdConstraint(&in, data.get());
        mj_Euler(&in, data.get());
      }
    };
    constexpr int kMoves = 200;
    for (int i = 0; i < kMostMoves; i += kMoves) {
      run(*fluid, kMoves);
      if (!(speed() > kStill)) break;
    }
    const VectorXd here = VectorXd::Map(data->qpos, model_.nq);
    if (data->nefc == 0 || !here.allFinite()) return std::nullopt;
    steps_ = 0;
    if (const auto rest = Settle(here)) return rest;
    // Without the fluid, it would go on.
    std::copy_n(model_.dof_damping, model_.nv, fluid->dof_damping);
    run(*fluid, 5 * kMoves);
    if (!(speed() < kCreeps)) return std::nullopt;
    return VectorXd::Map(data->qpos, model_.nq);
  }

  const mjModel& model_;
  VectorXd drawn_;
  ModelPtr bare_model_;
  PlantForces forces_;
  PlantForces bare_;
  VectorXd unit_;   // of mass
  VectorXd reach_;  // what is far, of every coordinate [m, rad]
  int steps_ = 0;
};

}  // namespace

RestPose FindRest(const mjModel& model, bool held) {
  if (model.nv == 0) return {VectorXd::Map(model.qpos0, model.nq), true, {}, true};
  return RestSearch(model).Find(held);
}

RestPose PoseAt(const mjModel& model, const VectorXd& qpos) {
  if (model.nv == 0) return {qpos, true, {}, true};
  return RestSearch(model).At(qpos);
}

}  // namespace mjdiag
