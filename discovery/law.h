#pragma once
// A found cause as a law over what it depends on, for people: the force that the other
// causes do not explain, as points, and the cause's own force as a curve.

#include <Eigen/Core>
#include <string>

#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/plugin/effects/observed_motion.h"

namespace mjdiag {

/// Series of what a law is drawn over at the candidate's joint, its name and its SI unit.
struct LawAxis {
  Eigen::VectorXd x;
  std::string name;
  std::string unit;
};
LawAxis AxisOf(LawVariable variable, const Candidate& candidate,
               const ObservedMotion& motion, bool hinge, const std::string& input_unit);

/// The law over the range of x: in closed form if the cause is a function of that
/// variable alone, else the mean of what it explains, `explained`, in bins of x.
/// Columns x and force.
Eigen::MatrixX2d LawCurve(const Cause& cause, const Eigen::VectorXd& x,
                          const Eigen::VectorXd& explained);

}  // namespace mjdiag
