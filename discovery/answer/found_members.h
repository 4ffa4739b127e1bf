#pragma once
// Members of an answer as people read them: causes with their parameters, numbers of the
// plant as factors, and kinds of physics.
//
// Values have the standard deviations of the fit, or those that differences between parts of
// the records say where they are larger: with g_f the gradient of half of what the fit makes
// least in fold f, and H its second derivative,
//
//   Cov = H^-1 (sum_f g_f g_f^T) H^-1     [Huber 1967]
//
// in 20 folds of time. 95 % intervals are symmetric in the coordinates of the fit (model.h),
// within what the law allows.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/discovery/answer/posterior.h"
#include "mjdiag/discovery/answer/unseen_judgement.h"
#include "mjdiag/discovery/discovery.h"

namespace mjdiag {

/// How the coordinates of a model (CoordinatesOf) are off.
struct CoordinateErrors {
  Eigen::VectorXd sd;
  Eigen::MatrixXd correlation;
};

CoordinateErrors CoordinateErrorsOf(const AnswerData& data, const ModelOnRuns& answer);

/// Causes, numbers and kinds of the answer.
/// @param sd  of its coordinates
void AddMembers(const AnswerData& data, const UnseenJudgement& judged,
                const std::vector<MemberPosterior>& posterior,
                const Eigen::VectorXd& sd, Discovery& discovery);

}  // namespace mjdiag
