#pragma once
// Faults of any size from a record: Gauss-Newton on the residuals. Prefilters that are
// made about the healthy machine are exact for small faults only; here
// relations, prefilters and noise are made anew about the estimate until it moves no
// more,
//
//   f <- f + (G(f)^T G(f))^-1 G(f)^T r(f),
//
// where r(f) is the residual of the machine with the faults f. At the solution r is
// noise alone, so the errors in the regressors do no harm and the covariance of the
// last step is that of the estimate.

#include <Eigen/Core>
#include <functional>

#include "mjdiag/diagnosis/diagnosis_design.h"
#include "mjdiag/diagnosis/residuals/fault_estimator.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

/// The linear model of the machine at these fault parameters (1: healthy).
using ModelAt = std::function<MechanicalModel(const Eigen::VectorXd& parameters)>;

struct RefinedEstimate {
  FaultEstimate
      estimate;  ///< deviations from healthy: fault parameters, then disturbances
  int steps = 0;
};

/// Each fault parameter changed by -c and +c about a point, its model from `model_at`.
std::vector<PerturbedModels> PerturbAbout(const std::vector<std::string>& names,
                                          const Eigen::VectorXd& parameters,
                                          const Eigen::VectorXd& magnitudes,
                                          const ModelAt& model_at);

/// @param magnitudes  c of every fault parameter
/// @param from        first sample that is regressed
/// NumericalError if the regression is rank deficient or the steps do not converge.
RefinedEstimate RefineEstimate(const DiagnosisDesign& design,
                               const SynthesisOptions& options, const ModelAt& model_at,
                               const Eigen::VectorXd& magnitudes, const Record& record,
                               Eigen::Index from = 0);

}  // namespace mjdiag
