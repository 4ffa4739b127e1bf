#include "mjdiag/diagnosis/residuals/cramer_rao.h"

#include <Eigen/Cholesky>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/simulate_lti.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd Readings(const MechanicalModel& model, const TickTiming& timing,
                  const MatrixXd& commands) {
  return SimulateLti(TickModel(model, timing.step, timing.substeps), commands);
}

}  // namespace

std::vector<MatrixXd> OutputSensitivities(const std::vector<PerturbedModels>& faults,
                                          const TickTiming& timing,
                                          const MatrixXd& commands) {
  std::vector<MatrixXd> sensitivities;
  sensitivities.reserve(faults.size());
  for (const PerturbedModels& fault : faults) {
    sensitivities.emplace_back((Readings(fault.plus, timing, commands) -
                                Readings(fault.minus, timing, commands)) /
                               (2.0 * fault.magnitude));
  }
  return sensitivities;
}

MatrixXd OutputResponse(const MechanicalModel& healthy, const TickTiming& timing,
                        const MatrixXd& waveform) {
  return Readings(healthy, timing, waveform);
}

InformationBound CramerRaoBound(const std::vector<MatrixXd>& sensitivities,
                                const VectorXd& sensor_noise) {
  if (!(sensor_noise.array() > 0.0).all()) {
    throw InputError("information bound", "a sensor without noise",
                     "a noise on every sensor");
  }
  const auto count = static_cast<Index>(sensitivities.size());
  MatrixXd information(count, count);
  const VectorXd weight = sensor_noise.array().square().inverse();
  for (Index i = 0; i < count; ++i) {
    for (Index j = 0; j <= i; ++j) {
      const auto& a = sensitivities[static_cast<std::size_t>(i)];
      const auto& b = sensitivities[static_cast<std::size_t>(j)];
      information(i, j) = a.cwiseProduct(b).rowwise().sum().dot(weight);
      information(j, i) = information(i, j);
    }
  }
  const VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd correlation = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::LLT<MatrixXd> factor(correlation);
  // The pivots are what of each fault those before it do not explain; collinear faults
  // leave rounding.
  constexpr double kUnexplained = 1e-12;
  if (factor.info() != Eigen::Success || !scale.allFinite() ||
      factor.matrixLLT().diagonal().cwiseAbs2().minCoeff() < kUnexplained) {
    throw NumericalError("this motion does not tell all of the faults apart");
  }
  const MatrixXd inverse = factor.solve(MatrixXd::Identity(count, count));
  return {scale, scale.cwiseProduct(inverse.diagonal().cwiseSqrt())};
}

}  // namespace mjdiag
