#include "mjdiag/discovery/blocks/curve_block.h"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <map>

#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/scales.h"
#include "mjdiag/plugin/effects/structure/force_curve.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Every knot costs, and a curve has as many as it needs; of the velocity, half on either side
// of 0.
constexpr std::array kKnotsOverPosition{9, 13, 17};
constexpr int kKnotsOverVelocity = 10;
// Of the largest speed: below, a joint has no direction.
constexpr double kStill = 1.0 / 200.0;

/// Of a curve over the joint's own velocity: what jumps at rest beside what is in proportion.
Kind KindOfResistance(const VectorXd& values) {
  const CurveAxis axis = CurveAxisOf(values);
  Eigen::MatrixX2d shapes(axis.knots, 2);
  for (int i = 0; i < axis.knots; ++i) {
    const double v = axis.KnotAt(i);
    const bool is_second_half =
        axis.shape == CurveShapes::kSplit && 2 * i >= axis.knots;
    const double sign = axis.shape == CurveShapes::kSplit
                            ? (is_second_half ? 1.0 : -1.0)
                            : std::copysign(1.0, v);
    shapes.row(i) << sign, v;
  }
  const VectorXd force = values.segment(force_curve::kFirst, axis.knots);
  const Eigen::Vector2d size = (shapes.transpose() * shapes)
                                   .ldlt()
                                   .solve(shapes.transpose() * force)
                                   .cwiseProduct(shapes.colwise().norm().transpose())
                                   .cwiseAbs();
  return size[0] > size[1] ? Kind::kDryFriction : Kind::kViscousFriction;
}

/// Of a joint over what `variable` of degree of freedom `of` is.
Candidate CurveOver(const Candidate& at, CurveVariable variable, Index of,
                    const CurveAxis& axis, double spread) {
  Candidate curve{.effect = Lasting(ForceCurve()),
                  .site = at.site,
                  .joint = at.joint,
                  .parameters = {}};
  curve.chosen = VectorXd::Zero(force_curve::kFirst);
  curve.chosen[force_curve::kVariable] = static_cast<double>(variable);
  curve.chosen[force_curve::kOf] = static_cast<double>(of);
  curve.chosen[force_curve::kStill] = axis.still;
  curve.chosen[force_curve::kLow] = axis.low;
  curve.chosen[force_curve::kWidth] = axis.high - axis.low;
  curve.chosen[force_curve::kShape] = static_cast<double>(axis.shape);
  curve.chosen[force_curve::kKnots] = axis.knots;
  const auto& parameters = ForceCurve().parameters();
  for (int i = 0; i < axis.knots; ++i) {
    const EffectParameter& p =
        parameters[static_cast<std::size_t>(force_curve::kFirst + i)];
    curve.parameters.push_back({p.name, p.role, p.minimum, p.maximum, 0.0, spread});
  }
  return curve;
}

bool IsOverPosition(const Candidate& candidate) {
  return candidate.chosen[force_curve::kVariable] ==
         static_cast<double>(CurveVariable::kPosition);
}

VectorXd CourseOf(const Candidate& candidate, const ObservedMotion& motion) {
  const auto of = static_cast<Index>(candidate.chosen[force_curve::kOf]);
  if (IsOverPosition(candidate)) return motion.position.row(of);
  return motion.velocity.row(of);
}

}  // namespace

std::vector<Candidate> CurveCandidates(const Machine& machine,
                                       const std::vector<Candidate>& candidates,
                                       const ObservedMotion& motion) {
  std::map<Index, const Candidate*> joints;  // by degree of freedom
  for (const Candidate& one : candidates) {
    if (one.effect->element() == mjOBJ_JOINT) joints.try_emplace(one.joint, &one);
  }
  std::vector<Candidate> curves;
  for (const auto& [joint, at] : joints) {
    const Site site{at->site, joint, -1};
    const double spread =
        ScalesOf({machine.plant(), machine.mechanics(), motion, site}).FrictionForce();
    for (const auto& [of, other] : joints) {
      const VectorXd q = motion.position.row(of);
      if (!(q.maxCoeff() > q.minCoeff())) continue;
      for (const int knots : kKnotsOverPosition) {
        if (of != joint && knots != kKnotsOverPosition.front()) continue;
        const CurveAxis axis{q.minCoeff(), q.maxCoeff(), CurveShapes::kPlain, knots};
        curves.push_back(CurveOver(*at, CurveVariable::kPosition, of, axis, spread));
      }
    }
    const VectorXd v = motion.velocity.row(joint);
    const double fastest = v.cwiseAbs().maxCoeff();
    if (!(v.minCoeff() < 0.0 && v.maxCoeff() > 0.0)) continue;
    const CurveAxis axis{v.minCoeff(), v.maxCoeff(), CurveShapes::kSplit,
                         kKnotsOverVelocity, kStill * fastest};
    curves.push_back(CurveOver(*at, CurveVariable::kVelocity, joint, axis, spread));
  }
  return curves;
}

MatrixXd WhiteningOfKnots(const Candidate& curve) {
  const CurveAxis axis = CurveAxisOf(curve.chosen);
  const bool is_split = axis.shape == CurveShapes::kSplit;
  const double length = 0.25 * (axis.high - axis.low);
  MatrixXd K(axis.knots, axis.knots);
  for (int i = 0; i < axis.knots; ++i) {
    for (int j = 0; j < axis.knots; ++j) {
      const bool is_apart = is_split && (2 * i < axis.knots) != (2 * j < axis.knots);
      const double s = (axis.KnotAt(i) - axis.KnotAt(j)) / length;
      K(i, j) = is_apart ? 0.0 : std::exp(-0.5 * s * s);
    }
  }
  constexpr double kRough = 1e-4;
  K.diagonal().array() += kRough * kRough;
  // K^-1 = R^T R
  const MatrixXd precision = K.llt().solve(MatrixXd::Identity(axis.knots, axis.knots));
  return precision.llt().matrixU();
}

bool IsCurve(const Candidate& candidate) {
  return candidate.effect.get() == &ForceCurve();
}

bool IsCurve(const Block& block) {
  return block.candidate && IsCurve(*block.candidate);
}

bool IsOverOwnVelocity(const Block& block) {
  if (!IsCurve(block)) return false;
  const VectorXd& chosen = block.candidate->chosen;
  return chosen[force_curve::kVariable] ==
             static_cast<double>(CurveVariable::kVelocity) &&
         chosen[force_curve::kFactor] == static_cast<double>(CurveFactor::kNone) &&
         static_cast<Index>(chosen[force_curve::kOf]) == block.candidate->joint;
}

bool IsCurveOf(const Block& curve, const Block& named) {
  return IsOverOwnVelocity(curve) && !IsCurve(named) && !named.resists.empty() &&
         curve.candidate->site == named.resists;
}

CandidateRegressor RegressorOfCurve(const SiteMotion& at, const Candidate& candidate) {
  const CurveAxis axis = CurveAxisOf(candidate.chosen);
  const VectorXd x = CourseOf(candidate, at.motion);
  MatrixXd design = MatrixXd::Zero(x.size(), axis.knots);
  for (Index k = 0; k < x.size(); ++k) {
    const CurveAxis::Weights weights = axis.At(x[k]);
    for (std::size_t i = 0; i < weights.place.size(); ++i) {
      design(k, weights.place[i]) += weights.weight[i];
    }
  }
  return {std::move(design), at.JointEntry(axis.knots),
          [](const Amplitudes& a) -> RegressorValues { return a; }};
}

std::string CurveVariableName(const mjModel& plant, const Candidate& candidate) {
  const auto of = static_cast<int>(candidate.chosen[force_curve::kOf]);
  return ElementName(plant, mjOBJ_JOINT, plant.dof_jntid[of]) +
         (IsOverPosition(candidate) ? " position" : " velocity");
}

CurveCourse CourseOfCurve(const mjModel& plant, const Candidate& candidate,
                          const ObservedMotion& motion) {
  const auto of = static_cast<int>(candidate.chosen[force_curve::kOf]);
  const bool hinge = plant.jnt_type[plant.dof_jntid[of]] == mjJNT_HINGE;
  const std::string length = hinge ? "rad" : "m";
  return {CurveVariableName(plant, candidate),
          IsOverPosition(candidate) ? length : length + "/s",
          CourseOf(candidate, motion)};
}

Kind KindOfCurve(const VectorXd& values, Index joint) {
  const auto variable =
      static_cast<CurveVariable>(static_cast<int>(values[force_curve::kVariable]));
  const auto factor =
      static_cast<CurveFactor>(static_cast<int>(values[force_curve::kFactor]));
  const auto of = static_cast<Index>(values[force_curve::kOf]);
  if (factor == CurveFactor::kVelocity) return Kind::kViscousFriction;
  if (factor == CurveFactor::kDirection) {
    return variable == CurveVariable::kCommand ? Kind::kLoadFriction
                                               : Kind::kDryFriction;
  }
  switch (variable) {
    case CurveVariable::kTime:
      return Kind::kVibration;
    case CurveVariable::kCommand:
      return Kind::kCoupling;  // of a joint's own motor it is none (IsAnswer)
    case CurveVariable::kVelocity:
      return of == joint ? KindOfResistance(values) : Kind::kCoupling;
    case CurveVariable::kPosition:
      break;
  }
  if (of != joint) return Kind::kCoupling;
  return CurveAxisOf(values).shape == CurveShapes::kPeriodic ? Kind::kForceAlongStroke
                                                             : Kind::kCompliance;
}

}  // namespace mjdiag
