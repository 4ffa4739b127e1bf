#include "mjdiag/discovery/unexplained/active_curve.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/effects/structure/force_curve.h"

namespace mjdiag {

bool DrivesItsJoint(const mjModel& plant, Eigen::Index joint,
                    const Eigen::VectorXd& values, const Eigen::VectorXd& low,
                    const Eigen::VectorXd& high) {
  const auto chosen = [&](force_curve::Place place) {
    return std::lround(values[place]);
  };
  const double damping = std::max(0.0, plant.dof_damping[joint]);
  const double friction = std::max(0.0, plant.dof_frictionloss[joint]);
  // With v or its direction as a factor, where the knot has the sign of v.
  switch (static_cast<CurveFactor>(chosen(force_curve::kFactor))) {
    case CurveFactor::kVelocity:
      return low.maxCoeff() > damping;
    case CurveFactor::kDirection:
      return low.maxCoeff() > friction;
    case CurveFactor::kNone:
      break;
  }
  const auto variable = static_cast<CurveVariable>(chosen(force_curve::kVariable));
  if (variable != CurveVariable::kVelocity || chosen(force_curve::kOf) != joint) {
    return false;
  }
  const CurveAxis axis = CurveAxisOf(values);
  for (Eigen::Index i = 0; i < low.size(); ++i) {
    const double v = axis.KnotAt(static_cast<int>(i));
    const double takes = damping * std::abs(v) + friction;
    if ((v > 0.0 && low[i] > takes) || (v < 0.0 && high[i] < -takes)) return true;
  }
  return false;
}

}  // namespace mjdiag
