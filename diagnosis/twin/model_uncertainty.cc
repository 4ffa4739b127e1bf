#include "mjdiag/diagnosis/twin/model_uncertainty.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/signals/decompositions.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// What a part tells of a direction, over what it tells best: less is rounding.
constexpr double kTold = 1e-6;
/// That parts of a run of the very model contradict each other by so much.
constexpr double kChance = 1e-3;

/// What one part says of the faults, all else unknown.
struct Score {
  MatrixXd N;
  VectorXd s;
};

Score ScoreOf(const PartInformation& part, const MatrixXd& prior,
              const std::vector<Index>& faults, const std::vector<Index>& others) {
  if (others.empty()) return {part.H(faults, faults), part.g(faults)};
  const MatrixXd across = part.H(faults, others);
  const MatrixXd own = part.H(others, others) + prior(others, others);
  // In units of the diagonal, which may be of any.
  const VectorXd scale = own.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd by = Solve(scale.asDiagonal() * own * scale.asDiagonal(),
                            scale.asDiagonal() * across.transpose())
                          .transpose() *
                      scale.asDiagonal();
  return {part.H(faults, faults) - by * across.transpose(),
          part.g(faults) - by * part.g(others)};
}

/// Sum of the squares of what it says in standard deviations, and in how many directions.
std::pair<double, double> SquaresOf(const Score& score, const MatrixXd& prior) {
  const ScaledEigenPairs modes = ScaledEigenDecomposition(score.N + kTold * prior);
  const VectorXd pull = modes.vectors.transpose() * score.s.cwiseQuotient(modes.scale);
  std::pair<double, double> squares{0.0, 0.0};
  for (Index i = 0; i < pull.size(); ++i) {
    if (!(modes.values[i] > kTold * modes.values.maxCoeff())) continue;
    squares.first += pull[i] * pull[i] / modes.values[i];
    squares.second += 1.0;
  }
  return squares;
}

/// What of a symmetric matrix is a covariance.
MatrixXd BeyondNothing(const MatrixXd& A) {
  const SymmetricEigenPairs modes = SymmetricEigenDecomposition(A);
  return modes.vectors * modes.values.cwiseMax(0.0).asDiagonal() *
         modes.vectors.transpose();
}

}  // namespace

double ModelUncertainty::Times(double of_run) const noexcept {
  return 1.0 + std::max(static_cast<double>(runs), duration / of_run);
}

double ModelUncertainty::Stretch(double probability, double normal) const {
  return StudentQuantile(0.5 * probability, freedom) / TwoSidedNormalQuantile(normal);
}

ModelUncertainty ScatterOfParts(const std::vector<std::vector<PartInformation>>& runs,
                                const MatrixXd& prior, const std::vector<Index>& faults,
                                bool certain) {
  std::vector<Index> others;
  for (Index i = 0; i < prior.rows(); ++i) {
    if (std::ranges::find(faults, i) == faults.end()) others.push_back(i);
  }
  const auto n = static_cast<Index>(faults.size());
  MatrixXd N = prior(faults, faults);
  std::vector<std::vector<Score>> scores;
  for (const std::vector<PartInformation>& parts : runs) {
    scores.emplace_back();
    for (const PartInformation& part : parts) {
      scores.back().push_back(ScoreOf(part, prior, faults, others));
      N += scores.back().back().N;
    }
  }
  const ScaledEigenPairs modes = ScaledEigenDecomposition(N);
  const VectorXd told = modes.values.cwiseMax(kTold * modes.values.maxCoeff());
  /// N^-1 = root root^T.
  const MatrixXd root = modes.scale.cwiseInverse().asDiagonal() * modes.vectors *
                        told.cwiseSqrt().cwiseInverse().asDiagonal();
  double shares = 0.0, squared_shares = 0.0, squares = 0.0, directions = 0.0;
  MatrixXd scatter = MatrixXd::Zero(n, n);  // in units of N^-1
  MatrixXd of_runs = scatter;
  for (const std::vector<Score>& run : scores) {
    VectorXd together = VectorXd::Zero(n);
    for (const Score& score : run) {
      const double share = (root.transpose() * score.N * root).trace();
      shares += share;
      squared_shares += share * share;
      const VectorXd said = root.transpose() * score.s;
      scatter += said * said.transpose();
      together += said;
      const auto [sum, count] = SquaresOf(score, prior(faults, faults));
      squares += sum;
      directions += count;
    }
    of_runs += together * together.transpose();
  }
  ModelUncertainty uncertainty;
  const double count = squared_shares > 0.0 ? shares * shares / squared_shares : 0.0;
  if (!(count > 1.5)) return uncertainty;
  const double small = (count + 1.0) / (count - 1.0);
  if (!certain && squares < ChiSquaredQuantile(kChance, directions)) {
    return uncertainty;
  }
  scatter *= small;
  if (const auto m = static_cast<double>(runs.size()); m > 1.0) {
    scatter += BeyondNothing((m + 1.0) / (m - 1.0) * of_runs - scatter);
  }
  const auto p = static_cast<double>(n);
  uncertainty.freedom = count - 1.0;
  const MatrixXd usual = scatter.trace() / p * MatrixXd::Identity(n, n);
  const MatrixXd judged =
      (uncertainty.freedom * scatter + p * usual) / (uncertainty.freedom + p);
  // In units of N^-1, noise is 1 in every direction.
  const MatrixXd excess = BeyondNothing(judged - MatrixXd::Identity(n, n));
  uncertainty.covariance = root * excess * root.transpose();
  return uncertainty;
}

}  // namespace mjdiag
