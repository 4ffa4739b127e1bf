#pragma once
// Forces that nobody has a name for, as blocks: at every joint a curve
// (plugin/effects/structure/force_curve.h) over its position, its velocity or the position of
// another joint, every knot an amplitude of its own. They come in where no law does any more.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mjdiag/discovery/blocks/block.h"
#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/plugin/effects/candidate_regressor.h"
#include "mjdiag/plugin/effects/kind.h"
#include "mjdiag/plugin/effects/observed_motion.h"
#include "mjdiag/plugin/machine/machine.h"

namespace mjdiag {

/// At all joints where one of the candidates may act.
std::vector<Candidate> CurveCandidates(const Machine& machine,
                                       const std::vector<Candidate>& candidates,
                                       const ObservedMotion& motion);
/// What makes the knots of a curve, over their spread, white as they are known beforehand: a
/// smooth function, of covariance
///   k(d) = exp(-s^2 / 2),   s = d / (a quarter of the axis)
/// (C. E. Rasmussen, C. K. I. Williams, Gaussian Processes for Machine Learning, MIT Press 2006,
/// 4.2.1), rough to 1e-4 of the spread, on either side of 0 its own where it is split. Many
/// knots cost what the function that they describe does, then. Upper triangular.
Eigen::MatrixXd WhiteningOfKnots(const Candidate& curve);

bool IsCurve(const Candidate& candidate);
bool IsCurve(const Block& block);
/// A curve over how fast its own joint is.
bool IsOverOwnVelocity(const Block& block);
/// Whether a curve can be what a resistance with a name is: that one stays beside it.
bool IsCurveOf(const Block& curve, const Block& named);

/// The force of every knot along the motion.
CandidateRegressor RegressorOfCurve(const SiteMotion& at, const Candidate& candidate);

/// What a curve depends on: "load position".
std::string CurveVariableName(const mjModel& plant, const Candidate& candidate);
/// The same along the motion.
struct CurveCourse {
  std::string name;
  std::string unit;
  Eigen::VectorXd x;
};
CurveCourse CourseOfCurve(const mjModel& plant, const Candidate& candidate,
                          const ObservedMotion& motion);

/// The kind of physics of a curve with those values, choices first, at a joint.
Kind KindOfCurve(const Eigen::VectorXd& values, Eigen::Index joint);

}  // namespace mjdiag
