#include "mjdiag/discovery/unexplained/input_smoother.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "mjdiag/plugin/replay/riccati.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Standard deviation of the state at the first sample, in multiples of the noise.
constexpr double kFree = 1e4;
/// From the n-th doubling on, a sum over 2^n samples is one over any record.
constexpr int kDoublings = 60;

struct Filter {
  MatrixXd F;         ///< A - K C
  MatrixXd G;         ///< K - L: x+ = F x + G e
  MatrixXd P_inputs;  ///< rows of P that belong to the inputs
  MatrixXd weight;    ///< S^-1
  MatrixXd to_state;  ///< C^T S^-1
  MatrixXd W;         ///< see header
  double log_det = 0.0;
  Index memory = 0;  ///< samples after which F has forgotten
  VectorXd sd;       ///< of the smoothed inputs, in z0
  std::vector<Index> edge;
};

/// W, its memory, and sd and edge, which follow from the sums over fewer samples.
void AddSmoother(const MatrixXd& C, Filter& filter) {
  const MatrixXd& P = filter.P_inputs;
  const Index inputs = P.rows();
  const Index offset = P.cols() - inputs;
  std::vector<VectorXd> variance;
  MatrixXd power = filter.F;
  filter.W = filter.to_state * C;
  for (int i = 0; i < kDoublings; ++i) {
    VectorXd now(inputs);
    for (Index j = 0; j < inputs; ++j) {
      now[j] = P(j, offset + j) - P.row(j).dot(filter.W * P.row(j).transpose());
    }
    variance.push_back(now);
    const MatrixXd added = power.transpose() * filter.W * power;
    filter.W += added;
    if (added.norm() <= 1e-14 * filter.W.norm()) break;
    power = power * power;
  }
  filter.memory = Index{1} << std::min<std::size_t>(variance.size(), 40);
  filter.sd = variance.back().cwiseMax(0.0).cwiseSqrt();
  for (Index j = 0; j < inputs; ++j) {
    std::size_t i = 0;
    while (i + 1 < variance.size() && variance[i][j] > 1.44 * variance.back()[j]) ++i;
    filter.edge.push_back(Index{1} << i);
  }
}

/// @param grid  i of every input, b = slowest 2^i
Filter DesignFilter(const AugmentedSystem& system, const VectorXd& grid) {
  const Index n = system.A.rows();
  const Index inputs = system.inputs();
  // Inputs in units of the error of their prediction, s / sqrt(b): entries of P are
  // then alike, without which the doubling loses its digits at slow bandwidths.
  VectorXd unit = VectorXd::Ones(n);
  MatrixXd Q = system.Q;
  for (Index j = 0; j < inputs; ++j) {
    const double b = system.slowest * std::exp2(grid[j]);
    unit[n - inputs + j] = std::pow(b, system.power - 0.5);
    Q(n - inputs + j, n - inputs + j) = b;
  }
  const MatrixXd A = unit.cwiseInverse().asDiagonal() * system.A * unit.asDiagonal();
  const MatrixXd P = unit.asDiagonal() *
                     SolveRiccati(A, system.C * unit.asDiagonal(), Q, 1e-11,
                                  "unknown inputs: the covariance does not converge") *
                     unit.asDiagonal();
  const MatrixXd& C = system.C;
  const MatrixXd S = C * P * C.transpose() + MatrixXd::Identity(C.rows(), C.rows());
  const Eigen::LLT<MatrixXd> factor(S);
  Filter filter;
  filter.weight = factor.solve(MatrixXd::Identity(C.rows(), C.rows()));
  filter.to_state = C.transpose() * filter.weight;
  const MatrixXd K = system.A * P * filter.to_state;
  filter.F = system.A - K * C;
  filter.G = K - system.L;
  filter.P_inputs = P.bottomRows(inputs);
  filter.log_det = 2.0 * factor.matrixLLT().diagonal().array().log().sum();
  AddSmoother(C, filter);
  return filter;
}

/// nu, ny x samples, of the filter that starts at x; inputs x samples of the predicted
/// inputs go to `predicted` unless it is null.
MatrixXd Innovations(const AugmentedSystem& system, const Filter& filter,
                     const MatrixXd& e, const VectorXd& x, MatrixXd* predicted) {
  const Index inputs = system.inputs();
  const Index n = x.size();
  const Index ny = e.rows();
  // [x+; nu] = both [x; e]
  MatrixXd both(n + ny, n + ny);
  both << filter.F, filter.G, -system.C, MatrixXd::Identity(ny, ny);
  VectorXd now(n + ny);
  VectorXd next(n + ny);
  next.head(n) = x;
  MatrixXd nu(ny, e.cols());
  for (Index k = 0; k < e.cols(); ++k) {
    now.head(n) = next.head(n);
    now.tail(ny) = e.col(k);
    if (predicted != nullptr) predicted->col(k) = now.segment(n - inputs, inputs);
    next.noalias() = both * now;
    nu.col(k) = next.tail(ny);
  }
  return nu;
}

/// The backward pass of the smoother: r[k-1], and for every k what it adds to the
/// inputs in `value` unless that is null.
VectorXd PullBackwards(const Filter& filter, const MatrixXd& nu, Index samples,
                       MatrixXd* value) {
  const Index n = filter.F.rows();
  const Index ny = nu.rows();
  MatrixXd both(n, n + ny);
  both << filter.F.transpose(), filter.to_state;
  VectorXd now = VectorXd::Zero(n + ny);
  VectorXd r = VectorXd::Zero(n);
  for (Index k = samples; k-- > 0;) {
    now.head(n) = r;
    now.tail(ny) = nu.col(k);
    r.noalias() = both * now;
    if (value != nullptr) value->col(k).noalias() += filter.P_inputs * r;
  }
  return r;
}

struct FirstState {
  VectorXd state;
  double log_likelihood = 0.0;
};

/// The free state at the first sample, and the log likelihood of all samples.
FirstState EstimateFirst(const AugmentedSystem& system, const Filter& filter,
                         const MatrixXd& e) {
  const Index n = system.A.rows();
  const MatrixXd nu = Innovations(system, filter, e, VectorXd::Zero(n), nullptr);
  const VectorXd pull =
      PullBackwards(filter, nu, std::min(nu.cols(), filter.memory), nullptr);
  const MatrixXd information = kFree * kFree * filter.W + MatrixXd::Identity(n, n);
  const Eigen::LLT<MatrixXd> factor(information);
  FirstState first;
  first.state = kFree * kFree * factor.solve(pull);
  const double misfit = (filter.weight * nu).cwiseProduct(nu).sum();
  first.log_likelihood = -0.5 * (static_cast<double>(e.cols()) * filter.log_det +
                                 misfit - pull.dot(first.state)) -
                         factor.matrixLLT().diagonal().array().log().sum();
  return first;
}

/// The grid point of the largest likelihood.
class BandwidthSearch {
 public:
  BandwidthSearch(const AugmentedSystem& system, const MatrixXd& e)
      : system_(system), e_(e) {}

  VectorXd Run() {
    const Index inputs = system_.inputs();
    for (Index i = 0; i <= system_.fastest; i += 2) {
      Try(VectorXd::Constant(inputs, static_cast<double>(i)));
    }
    for (Index j = 0; j < inputs && inputs > 1; ++j) {
      const VectorXd before = best_;
      for (Index i = 0; i <= system_.fastest; i += 2) {
        Try(Moved(before, j, static_cast<double>(i)));
      }
    }
    for (Index j = 0; j < inputs; ++j) {
      for (const double step : {1.0, 0.5, 0.25}) {
        const double middle = best_[j];
        for (const double to : {middle - step, middle + step}) {
          if (to >= 0.0 && to <= static_cast<double>(system_.fastest)) {
            Try(Moved(best_, j, to));
          }
        }
      }
    }
    return best_;
  }

 private:
  static VectorXd Moved(VectorXd grid, Index j, double to) {
    grid[j] = to;
    return grid;
  }

  void Try(const VectorXd& grid) {
    const double found =
        EstimateFirst(system_, DesignFilter(system_, grid), e_).log_likelihood;
    if (found > likelihood_) {
      likelihood_ = found;
      best_ = grid;
    }
  }

  const AugmentedSystem& system_;
  const MatrixXd& e_;
  VectorXd best_;
  double likelihood_ = -std::numeric_limits<double>::infinity();
};

}  // namespace

SmoothedInputs SmoothInputs(const AugmentedSystem& system, const MatrixXd& e) {
  const VectorXd grid = BandwidthSearch(system, e).Run();
  const Filter filter = DesignFilter(system, grid);
  const VectorXd first = EstimateFirst(system, filter, e).state;
  SmoothedInputs smoothed;
  smoothed.value.resize(system.inputs(), e.cols());
  const MatrixXd nu = Innovations(system, filter, e, first, &smoothed.value);
  PullBackwards(filter, nu, nu.cols(), &smoothed.value);
  smoothed.sd = filter.sd;
  smoothed.bandwidth =
      grid.unaryExpr([&](double i) { return system.slowest * std::exp2(i); });
  smoothed.edge = filter.edge;
  return smoothed;
}

}  // namespace mjdiag
