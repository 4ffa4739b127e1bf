#pragma once
// A force that no law explains, learned as a curve over what predicts it
// (plugin/effects/structure/force_curve.h): a signature says over what, linear least
// squares on the unexplained force f where it begins,
//
//   min over the knots of  sum (f[k] - m[k] g(x[k]))^2,
//
// and a fit like that of any law what it is.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/discovery/hypotheses/fitted_cause.h"
#include "mjdiag/discovery/unexplained/motion_variables.h"
#include "mjdiag/discovery/unexplained/unknown_input.h"

namespace mjdiag {

struct LearnedCurve {
  Candidate candidate;    ///< force_curve at the joint, with so many knots
  Eigen::VectorXd start;  ///< their values
  /// What it is a curve over, with its unit and its course, of a periodic one within a
  /// period.
  std::string over;
  std::string unit;
  Eigen::VectorXd x;
};

/// The wave of the list of laws that a periodic force over the joint's own position or
/// over time is, where one of the candidates is that, with values to start from.
std::optional<FittedCause> WaveOf(const std::vector<Candidate>& candidates,
                                  const UnknownSignal& force,
                                  const Signature& signature,
                                  const std::vector<MotionVariable>& variables,
                                  const ObservedMotion& motion, Eigen::Index joint);

/// @param signature  of the force, significant
/// @param joint      of the force (nv)
/// @param spread     how large forces at the joint are (Effect::Spread)
/// None where what predicts the force is no state of the machine.
std::optional<LearnedCurve> LearnCurve(const UnknownSignal& force,
                                       const Signature& signature,
                                       const std::vector<MotionVariable>& variables,
                                       const ObservedMotion& motion, Eigen::Index joint,
                                       double spread, int knots);

}  // namespace mjdiag
