#include "mjdiag/discovery/screening/bounded_regression.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <vector>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The best amplitudes of the `free` columns beside the others; none if these columns do
/// not differ.
std::optional<VectorXd> Solve(const MatrixXd& G, const VectorXd& b, VectorXd amplitude,
                              const std::vector<Index>& free) {
  if (free.empty()) return amplitude;
  constexpr double kIndependent = 1e-10;
  const VectorXd left = b - G * amplitude;  // free ones are 0 up to here
  const VectorXd scale = G.diagonal()(free).cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<MatrixXd> solver(scale.asDiagonal() * G(free, free) *
                                     scale.asDiagonal());
  if (solver.vectorD().minCoeff() < kIndependent) return std::nullopt;
  amplitude(free) =
      scale.asDiagonal() * solver.solve(scale.asDiagonal() * VectorXd(left(free)));
  return amplitude;
}

}  // namespace

std::optional<BoundedRegression> RegressBounded(const MatrixXd& G, const VectorXd& b,
                                                const VectorXd& least,
                                                const Eigen::ArrayX<bool>& explained) {
  const Index columns = b.size();
  std::optional<BoundedRegression> best;
  for (unsigned held = 0; held < 1u << columns; ++held) {
    VectorXd amplitude = VectorXd::Zero(columns);
    std::vector<Index> free;
    for (Index i = 0; i < columns; ++i) {
      const bool is_held = (held >> i & 1u) != 0;
      if (is_held && least.size() > 0 && !explained[i]) amplitude[i] = least[i];
      if (!is_held && !explained[i]) free.push_back(i);
    }
    const auto solved = Solve(G, b, std::move(amplitude), free);
    if (!solved) continue;
    if (least.size() > 0 && (solved->array() < least.array()).any()) continue;
    const double gain = 2.0 * b.dot(*solved) - solved->dot(G * *solved);
    if (gain > (best ? best->gain : 0.0)) best = {*solved, gain};
  }
  return best;
}

}  // namespace mjdiag
