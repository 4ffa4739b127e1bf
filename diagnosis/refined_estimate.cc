#include "mjdiag/diagnosis/refined_estimate.h"

#include "mjdiag/diagnosis/diagnosis_recording.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

std::vector<PerturbedModels> PerturbAbout(const std::vector<std::string>& names,
                                          const VectorXd& parameters,
                                          const VectorXd& magnitudes,
                                          const ModelAt& model_at) {
  std::vector<PerturbedModels> perturbed;
  for (Index i = 0; i < parameters.size(); ++i) {
    VectorXd minus = parameters;
    VectorXd plus = parameters;
    minus[i] -= magnitudes[i];
    plus[i] += magnitudes[i];
    perturbed.push_back({names[static_cast<std::size_t>(i)], magnitudes[i],
                         model_at(minus), model_at(plus)});
  }
  return perturbed;
}

RefinedEstimate RefineEstimate(const DiagnosisDesign& design,
                               const SynthesisOptions& options, const ModelAt& model_at,
                               const VectorXd& magnitudes, const Record& record,
                               Index from) {
  constexpr int kSteps = 12;
  // Of the standard deviation: what rounding in the relations leaves of a step.
  constexpr double kConverged = 0.25;
  const auto count = static_cast<Index>(design.bank.faults.size());
  VectorXd parameters = VectorXd::Ones(count);
  DiagnosisDesign moved = design;
  moved.limits = {};
  for (int step = 1; step <= kSteps; ++step) {
    if (step > 1) {
      moved.bank = MoveBank(
          design.bank.relations, MakeResidualSpace(model_at(parameters), options),
          PerturbAbout(design.bank.faults, parameters, magnitudes, model_at), options);
    }
    DiagnosisMonitor monitor(moved);
    monitor.RegressFrom(from);
    Run(monitor, record);
    FaultEstimate estimate = monitor.estimator().Estimate();
    const VectorXd change = estimate.value.head(count);
    const VectorXd sd = estimate.covariance.diagonal().head(count).cwiseSqrt();
    const bool converged = (change.array().abs() <= kConverged * sd.array()).all();
    parameters = (parameters + change).cwiseMax(magnitudes);
    if (converged) {
      estimate.value.head(count) = parameters.array() - 1.0;
      return {estimate, step};
    }
  }
  throw NumericalError("the fault estimates have not settled after " +
                       std::to_string(kSteps) + " steps");
}

}  // namespace mjdiag
