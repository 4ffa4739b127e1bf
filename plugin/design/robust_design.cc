#include "mjdiag/plugin/design/robust_design.h"

#include <algorithm>

#include "mjdiag/diagnosis/residuals/parity_choice.h"
#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/design/filter_design.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/listed.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::uint64_t kFirstSeed = 5001;

/// Residuals of every parity relation over nominal runs, k x N each.
std::vector<MatrixXd> NominalResiduals(const DiagnosisDesign& design,
                                       const Machine& machine,
                                       const Excitation& excitation) {
  std::vector<MatrixXd> residuals(
      static_cast<std::size_t>(machine.setup().diagnosis.robust.runs));
  ParallelFor(machine.setup().diagnosis.robust.runs, [&](int i) {
    RunOptions options;
    options.seed = kFirstSeed + static_cast<std::uint64_t>(i);
    const Record record = Simulate(machine, excitation, options);
    residuals[static_cast<std::size_t>(i)] =
        FilterSignals(design.bank.filters, Signals(design, record))
            .topRows(design.bank.residuals);
  });
  return residuals;
}

/// Mean energy of the residuals over the runs: of all of it, or of what differs between
/// them.
MatrixXd NuisanceEnergy(const std::vector<MatrixXd>& residuals, bool baseline) {
  const auto runs = static_cast<double>(residuals.size());
  MatrixXd mean = MatrixXd::Zero(residuals[0].rows(), residuals[0].cols());
  for (const MatrixXd& residual : residuals) mean += residual / runs;
  MatrixXd energy = MatrixXd::Zero(mean.rows(), mean.rows());
  for (const MatrixXd& residual : residuals) {
    const MatrixXd rest = baseline ? (residual - mean).eval() : residual;
    energy += rest * rest.transpose() / (baseline ? runs - 1.0 : runs);
  }
  // Unit noise keeps it definite where the runs do not differ.
  return energy + static_cast<double>(mean.cols()) *
                      MatrixXd::Identity(mean.rows(), mean.rows());
}

/// Residuals that a unit of the disturbance leaves, k x N.
MatrixXd DisturbanceResponse(const DiagnosisDesign& design, Index source,
                             Index samples) {
  const FilterBank& bank = design.bank.filters;
  const auto ny = static_cast<Index>(design.outputs.size());
  MatrixXd signals = MatrixXd::Zero(bank.inputs(), samples);
  MatrixXd waveforms(bank.inputs() - ny,
                     static_cast<Index>(design.disturbances.size()));
  for (Index k = 0; k < samples; ++k) {
    Waveforms(design.disturbances, static_cast<double>(k) * bank.sample_time,
              waveforms);
    signals.col(k).tail(waveforms.rows()) = waveforms.col(source);
  }
  return FilterSignals(bank, signals).topRows(design.bank.residuals);
}

/// Residuals that a unit of the fault leaves over the healthy linear run, k x N.
MatrixXd Response(const DiagnosisDesign& design, const Machine& machine,
                  const std::string& fault) {
  const std::vector<std::string> names = design.FaultNames();
  const auto found = std::find(names.begin(), names.end(), fault);
  if (found == names.end()) {
    throw InputError("robust residual", "there is no fault '" + fault + "'",
                     "one of " + Listed(names));
  }
  const Index index = found - names.begin();
  const auto parameters = static_cast<Index>(design.bank.faults.size());
  const MatrixXd signals = Signals(design, LinearRun(machine));
  if (index >= parameters) {
    return DisturbanceResponse(design, index - parameters, signals.cols());
  }
  const Index n = design.bank.residuals;
  return FilterSignals(design.bank.filters, signals).middleRows((index + 1) * n, n);
}

}  // namespace

DiagnosisDesign DesignRobustFilters(const Machine& machine, const std::string& fault,
                                    const Excitation& excitation, bool baseline) {
  const RobustOptions& wanted = machine.setup().diagnosis.robust;
  DiagnosisDesign design = DesignFilters(machine, {wanted.residual, 0});
  const MatrixXd response = Response(design, machine, fault);
  const MatrixXd nuisance =
      NuisanceEnergy(NominalResiduals(design, machine, excitation), baseline);
  design.bank = Mix(design.bank, LeastExcitedRelation(nuisance, response).transpose());
  design.options.estimation_residuals = 1;
  return design;
}

}  // namespace mjdiag
