#include "mjdiag/diagnosis/residuals/parity_choice.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd TopEigenvector(const MatrixXd& symmetric) {
  return SymmetricEigenDecomposition(symmetric).vectors.col(symmetric.rows() - 1);
}

MatrixXd NormalisedSum(const std::vector<MatrixXd>& matrices) {
  MatrixXd sum = MatrixXd::Zero(matrices[0].rows(), matrices[0].cols());
  for (const MatrixXd& matrix : matrices) {
    if (matrix.trace() > 0.0) sum += matrix / matrix.trace();
  }
  return sum;
}

/// Each over what a has of it; one of which a has nothing weighs the most.
MatrixXd WeightedSum(const std::vector<MatrixXd>& matrices, const VectorXd& a) {
  constexpr double kLeast = 1e-12;
  MatrixXd sum = MatrixXd::Zero(a.size(), a.size());
  for (const MatrixXd& matrix : matrices) {
    const double share = std::max(a.dot(matrix * a), kLeast * matrix.trace());
    if (share > 0.0) sum += matrix / share;
  }
  return sum;
}

/// sum log a^T G a; minus infinity if a has nothing of one of them.
double LogProduct(const std::vector<MatrixXd>& matrices, const VectorXd& a) {
  double sum = 0.0;
  for (const MatrixXd& matrix : matrices) {
    if (matrix.trace() > 0.0) sum += std::log(std::max(0.0, a.dot(matrix * a)));
  }
  return sum;
}

Eigen::LLT<MatrixXd> Factor(const MatrixXd& nuisance) {
  Eigen::LLT<MatrixXd> factor(nuisance);
  if (factor.info() != Eigen::Success) {
    throw NumericalError("the energy of the nominal runs is not positive definite");
  }
  return factor;
}

}  // namespace

std::vector<MatrixXd> FaultEnergies(const ResidualBank& bank, const MatrixXd& signals) {
  const Index n = bank.residuals;
  const MatrixXd outputs = FilterSignals(bank.filters, signals);
  std::vector<MatrixXd> energies;
  for (std::size_t i = 0; i < bank.faults.size(); ++i) {
    const auto phi = outputs.middleRows((static_cast<Index>(i) + 1) * n, n);
    energies.emplace_back(phi * phi.transpose());
  }
  return energies;
}

VectorXd MostSensitiveRelation(const std::vector<MatrixXd>& energies) {
  const Index size = energies.front().rows();
  return BestRatioRelation(energies, {MatrixXd::Identity(size, size)});
}

VectorXd LeastExcitedRelation(const MatrixXd& nuisance, const MatrixXd& response) {
  const MatrixXd solved = Factor(nuisance).solve(response);
  // Of the programme of column j the least energy is 1 / g_j^T Q^-1 g_j.
  Index best = 0;
  response.cwiseProduct(solved).colwise().sum().maxCoeff(&best);
  return solved.col(best).normalized();
}

VectorXd BestRatioRelation(const MatrixXd& energy, const MatrixXd& nuisance) {
  const auto factor = Factor(nuisance);
  const MatrixXd half = factor.matrixL().solve(energy);
  const MatrixXd ratio = factor.matrixL().solve(half.transpose());
  const VectorXd top = TopEigenvector(0.5 * (ratio + ratio.transpose()));
  return factor.matrixU().solve(top).normalized();
}

VectorXd BestRatioRelation(const std::vector<MatrixXd>& energies,
                           const std::vector<MatrixXd>& nuisances) {
  VectorXd chosen =
      BestRatioRelation(NormalisedSum(energies), NormalisedSum(nuisances));
  // The gradient of sum log a^T G_i a - sum log a^T Q_i a vanishes where a is the best
  // ratio of sum G_i / (a^T G_i a) to sum Q_i / (a^T Q_i a). A step that gains nothing
  // is halved, which keeps two faults that pull apart from taking turns.
  const auto product = [&](const VectorXd& a) {
    return LogProduct(energies, a) - LogProduct(nuisances, a);
  };
  constexpr int kIterations = 200;
  constexpr double kShortest = 1e-8;
  double best = product(chosen);
  double step = 1.0;
  for (int k = 0; k < kIterations && step > kShortest; ++k) {
    VectorXd next = BestRatioRelation(WeightedSum(energies, chosen),
                                      WeightedSum(nuisances, chosen));
    if (next.dot(chosen) < 0.0) next = -next;
    next = (chosen + step * next).normalized();
    const double gained = product(next);
    if (gained > best) {
      chosen = next;
      best = gained;
    } else {
      step *= 0.5;
    }
  }
  return chosen;
}

MatrixXd CompleteBasis(const VectorXd& first, int n) {
  const Index size = first.size();
  const Index count = n == 0 ? size : std::min<Index>(n, size);
  MatrixXd basis = OrthonormalBasis(first).leftCols(count).transpose();
  basis.row(0) = first.transpose();
  return basis;
}

}  // namespace mjdiag
