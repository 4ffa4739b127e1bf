#include "mjdiag/diagnosis/residuals/residual_bank.h"

#include <algorithm>
#include <unsupported/Eigen/KroneckerProduct>

#include "mjdiag/diagnosis/model/left_null_space.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Sensor noise as noise of z = [y; u]; the commands are known exactly.
VectorXd NoiseOfSignals(const SynthesisOptions& options, Index signals) {
  const VectorXd& noise = options.sensor_noise;
  VectorXd all = VectorXd::Zero(signals);
  all.head(noise.size()) = noise.isZero(0.0) ? VectorXd::Ones(noise.size()) : noise;
  return all;
}

/// Column j of the forces and of the readings is one signal.
void RequireShape(const MatrixXd& columns, Index rows, Index count, const char* what) {
  if (columns.cols() == 0) return;
  if (columns.rows() == rows && columns.cols() == count) return;
  throw InputError("unknown inputs",
                   std::string(what) + " of " + std::to_string(columns.rows()) + " x " +
                       std::to_string(columns.cols()),
                   std::to_string(rows) + " x " + std::to_string(count));
}

/// Where the unknown inputs enter the delta form of a machine.
SignalEntry Entry(const MechanicalModel& model, const StateSpace& system,
                  const SynthesisOptions& options) {
  const UnknownInputs& unknown = options.unknown_inputs;
  const Index count = std::max(unknown.forces.cols(), unknown.readings.cols());
  if (count == 0) return NoSignal(system);
  RequireShape(unknown.forces, model.M.rows(), count, "forces");
  RequireShape(unknown.readings, system.outputs(), count, "readings");
  SignalEntry entry{MatrixXd::Zero(system.states(), count),
                    MatrixXd::Zero(system.outputs(), count)};
  if (unknown.forces.cols() > 0) {
    entry.B = HeldForces(model, options.timing, unknown.forces).B;
  }
  if (unknown.readings.cols() > 0) entry.D = unknown.readings;
  return entry;
}

Numerators Stack(const std::vector<Numerators>& parts) {
  Index rows = 0;
  for (const Numerators& part : parts) rows += part.front().rows();
  Numerators stacked(parts.front().size(),
                     MatrixXd(rows, parts.front().front().cols()));
  for (std::size_t k = 0; k < stacked.size(); ++k) {
    Index row = 0;
    for (const Numerators& part : parts) {
      stacked[k].middleRows(row, part[k].rows()) = part[k];
      row += part[k].rows();
    }
  }
  return stacked;
}

MatrixXd Covariance(const Numerators& relations, const SynthesisOptions& options) {
  return OutputCovariance(
      MakeFilterBank(relations, options.residual.denominator, options.timing.tick()),
      NoiseOfSignals(options, relations.front().cols()));
}

/// Orthonormal in the metric of the output noise. The covariance squares the condition
/// of the relations, so a pass resolves half of the digits; the next ones do the rest.
Numerators Orthonormalised(Numerators relations, const SynthesisOptions& options) {
  constexpr int kPasses = 6;
  constexpr double kFloor = 1e-13;
  for (int pass = 0; pass < kPasses; ++pass) {
    const MatrixXd covariance = Covariance(relations, options);
    const VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
    const SymmetricEigenPairs eigen = SymmetricEigenDecomposition(
        scale.asDiagonal() * covariance * scale.asDiagonal());
    const VectorXd root = eigen.values.cwiseMax(kFloor).cwiseSqrt().cwiseInverse();
    relations = Combine(
        root.asDiagonal() * eigen.vectors.transpose() * scale.asDiagonal(), relations);
  }
  const MatrixXd covariance = Covariance(relations, options);
  if (!covariance.isIdentity(1e-3)) {
    throw NumericalError("the parity relations of degree " +
                         std::to_string(options.residual.degree) + " at " +
                         std::to_string(options.residual.denominator.cutoff) +
                         " Hz cannot be told apart in double precision");
  }
  return relations;
}

/// The relations of `space` nearest to `reference` in the metric of the output noise.
Numerators Nearest(const Numerators& reference, const Numerators& space,
                   const SynthesisOptions& options) {
  const MatrixXd joint = Covariance(Stack({reference, space}), options);
  const Index n = reference.front().rows();
  return Combine(joint.topRightCorner(n, space.front().rows()), space);
}

/// Residuals with the prefilters of the faults about the machine they are blind to.
ResidualBank BankOf(const Numerators& residual,
                    const std::vector<PerturbedModels>& faults,
                    const SynthesisOptions& options) {
  const auto perturbed = [&](const MechanicalModel& model) {
    return Nearest(residual, MakeResidualSpace(model, options).relations, options);
  };
  ResidualBank bank;
  bank.residuals = residual.front().rows();
  bank.relations = residual;
  std::vector<Numerators> outputs{residual};
  for (const PerturbedModels& fault : faults) {
    bank.faults.push_back(fault.name);
    const Numerators minus = perturbed(fault.minus);
    const Numerators plus = perturbed(fault.plus);
    Numerators derivative;
    for (std::size_t k = 0; k < plus.size(); ++k) {
      derivative.push_back((minus[k] - plus[k]) / (2.0 * fault.magnitude));
    }
    outputs.push_back(std::move(derivative));
  }
  bank.filters = MakeFilterBank(Stack(outputs), options.residual.denominator,
                                options.timing.tick());
  return bank;
}

}  // namespace

Numerators Combine(const MatrixXd& combinations, const Numerators& relations) {
  Numerators result;
  for (const MatrixXd& coefficient : relations) {
    result.push_back(combinations * coefficient);
  }
  return result;
}

ResidualBank Mix(const ResidualBank& bank, const MatrixXd& combinations) {
  const Index groups = bank.filters.outputs() / bank.residuals;
  const MatrixXd mixing =
      Eigen::kroneckerProduct(MatrixXd::Identity(groups, groups), combinations);
  ResidualBank mixed = bank;
  mixed.residuals = combinations.rows();
  mixed.relations = Combine(combinations, bank.relations);
  mixed.filters.D = mixing * bank.filters.D;
  mixed.filters.B.resize(mixing.rows() * bank.filters.order(), bank.filters.inputs());
  for (Index k = 0; k < bank.filters.order(); ++k) {
    mixed.filters.B.middleRows(k * mixing.rows(), mixing.rows()) =
        mixing * bank.filters.B.middleRows(k * mixing.cols(), mixing.cols());
  }
  return mixed;
}

ResidualSpace MakeResidualSpace(const MechanicalModel& model,
                                const SynthesisOptions& options) {
  const StateSpace system = DeltaForm(model, options.timing);
  const SignalEntry unknown = Entry(model, system, options);
  const NullSpace null = LeftNullSpace(system, unknown, options.residual.degree);
  if (null.relations.rows() == 0) {
    // Says from which degree on there is one, or that there is none at all.
    constexpr int kHighest = 40;
    const int degree = MinimalDegree(system, unknown, kHighest);
    throw InputError(
        "residual",
        "no parity relation of degree " + std::to_string(options.residual.degree),
        "a degree of at least " + std::to_string(degree));
  }
  const PolynomialMatrix residual =
      CompleteRelations(system, null.relations) * MakeDae(system).L;
  Numerators relations(residual.coefficients.begin(), residual.coefficients.end());
  return {options.residual.degree, null.separation,
          Orthonormalised(std::move(relations), options)};
}

ResidualBank SynthesiseBank(const ResidualSpace& space, const MatrixXd& combinations,
                            const std::vector<PerturbedModels>& faults,
                            const SynthesisOptions& options) {
  return BankOf(Combine(combinations, space.relations), faults, options);
}

}  // namespace mjdiag
