#pragma once
// Where a model is wrong and over what: forces that it lacks, laws as curves through what the
// rest of the model leaves, and what the last rest depends on.

#include <functional>

#include "mjdiag/discovery/answer/answer_data.h"
#include "mjdiag/discovery/answer/unseen_judgement.h"
#include "mjdiag/discovery/comparison/disturbance_estimate.h"
#include "mjdiag/discovery/discovery.h"
#include "mjdiag/discovery/law.h"
#include "mjdiag/plugin/effects/observed_motion.h"

namespace mjdiag {

/// A law over what it depends on, and the force that all but it leave, at points.
/// @param explained  what it explains of that
void DrawLaw(const LawAxis& axis, const DisturbanceEstimate& force,
             const Eigen::VectorXd& explained, const Cause& cause, LawPlot& plot);

/// The motion that the machine with the answer made in what fits saw.
ObservedMotion MotionOfAnswer(const AnswerData& data, const UnseenJudgement& judged);

/// Forces that are missing before and after, in what fits saw, behind the noise of the
/// machine as given.
void AddForces(const AnswerData& data, const UnseenJudgement& judged,
               Discovery& discovery);

/// Of every cause, the force that the machine with all other members lacks, over what the
/// law is of (law.h): partial residuals. Behind AddForces.
/// @return whether there was time for all of them
bool AddLawPlots(const AnswerData& data, const UnseenJudgement& judged,
                 const ObservedMotion& motion, const std::function<bool()>& is_over,
                 Discovery& discovery);

/// What the largest of the forces that are left depends on (signature.h). Behind AddForces.
void AddResidualDependence(const AnswerData& data, const UnseenJudgement& judged,
                           const ObservedMotion& motion, Discovery& discovery);

}  // namespace mjdiag
