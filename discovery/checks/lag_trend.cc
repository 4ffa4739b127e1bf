#include "mjdiag/discovery/checks/lag_trend.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/signals/decompositions.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kWindows = std::tuple_size_v<LagWindows>;
constexpr Index kSpan = 4;  // samples of a difference
constexpr double kSmallestDrift = 0.5;

struct WindowLag {
  double time = 0.0;    ///< of the middle, -1/2 .. 1/2 of the record
  double lag = 0.0;     ///< [samples]
  double weight = 0.0;  ///< sum (ds/dk)^2
  double period = 0.0;  ///< 1 / mean frequency [samples / rad]
};

/// x and dx/dk at `at`, by the cubic of Catmull and Rom through four samples.
std::pair<double, double> Between(const VectorXd& x, double at) {
  const double inside = std::clamp(at, 1.0, static_cast<double>(x.size()) - 2.001);
  const auto k = static_cast<Index>(inside);
  const double t = inside - static_cast<double>(k);
  const double a = x[k - 1];
  const double b = x[k];
  const double c = x[k + 1];
  const double d = x[k + 2];
  const double c1 = 0.5 * (c - a);
  const double c2 = a - 2.5 * b + 2.0 * c - 0.5 * d;
  const double c3 = 0.5 * (d - a) + 1.5 * (b - c);
  return {b + t * (c1 + t * (c2 + t * c3)), c1 + t * (2.0 * c2 + t * 3.0 * c3)};
}

std::optional<WindowLag> FindLag(const VectorXd& m, const VectorXd& s, Index first,
                                 Index count) {
  constexpr int kRounds = 8;
  constexpr double kLike = 0.8;  // share of the variance that s explains
  const VectorXd measured = m.segment(first, count);
  MatrixXd design(count, 4);
  design.col(0).setOnes();
  design.col(1).setLinSpaced(-1.0, 1.0);
  const double farthest = 0.25 * static_cast<double>(count);
  WindowLag window;
  double like = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    for (Index k = 0; k < count; ++k) {
      const auto [value, derivative] =
          Between(s, static_cast<double>(first + k) - window.lag);
      design(k, 2) = value;
      design(k, 3) = derivative;
    }
    const VectorXd about =
        design.col(2).array() - design.col(2).mean();  // a rest has nothing to shift
    window.weight = design.col(3).squaredNorm();
    if (!(about.squaredNorm() > 0.0) || !(window.weight > 0.0)) return std::nullopt;
    window.period = std::sqrt(about.squaredNorm() / window.weight);
    const VectorXd solution = LeastSquares(design, measured);
    const VectorXd trend = design.leftCols(2) * solution.head(2);
    const double rest = (measured - design * solution).squaredNorm();
    const double all = (measured - trend).squaredNorm();
    if (!(all > 0.0) || !(solution[2] > 0.0)) return std::nullopt;
    like = 1.0 - rest / all;
    const double step = -solution[3] / solution[2];
    window.lag += step;
    if (!(std::abs(window.lag) < farthest)) return std::nullopt;
    if (std::abs(step) < 1e-3) break;
  }
  if (like < kLike) return std::nullopt;
  return window;
}

/// A trend without scatter has no degrees of freedom, and needs none.
double SignificantT(double freedom) {
  constexpr double kLevel = 1e-3;
  return StudentQuantile(0.5 * kLevel, std::max(freedom, 1.0));
}

}  // namespace

VectorXd LagDifferences(const VectorXd& x) {
  return x.tail(x.size() - kSpan) - x.head(x.size() - kSpan);
}

LagWindows ActiveWindows(const VectorXd& signal) {
  constexpr double kActs = 0.05;
  const VectorXd changes = LagDifferences(signal);
  const Index count = changes.size() / kWindows;
  VectorXd sizes(kWindows);
  for (Index w = 0; w < kWindows; ++w) {
    sizes[w] = changes.segment(w * count, count).norm();
  }
  LagWindows active{};
  for (Index w = 0; w < kWindows; ++w) {
    active[static_cast<std::size_t>(w)] = sizes[w] > kActs * sizes.maxCoeff();
  }
  return active;
}

std::optional<LagTrend> FindLagTrend(const VectorXd& measured,
                                     const VectorXd& simulated) {
  LagWindows all{};
  all.fill(true);
  return FindLagTrend(measured, simulated, all);
}

std::optional<LagTrend> FindLagTrend(const VectorXd& measured,
                                     const VectorXd& simulated,
                                     const LagWindows& counts) {
  const VectorXd m = LagDifferences(measured);
  const VectorXd s = LagDifferences(simulated);
  const Index count = m.size() / kWindows;
  std::vector<WindowLag> windows;
  for (Index w = 0; w < kWindows; ++w) {
    if (!counts[static_cast<std::size_t>(w)]) continue;
    std::optional<WindowLag> window = FindLag(m, s, w * count, count);
    if (!window) continue;
    window->time = (static_cast<double>(w) + 0.5) / static_cast<double>(kWindows) - 0.5;
    windows.push_back(*window);
  }
  // Windows of even motion say little, and that little is noise.
  double most = 0.0;
  for (const WindowLag& window : windows) most = std::max(most, window.weight);
  std::erase_if(windows, [&](const WindowLag& w) { return w.weight < 0.02 * most; });
  constexpr double kReach = 0.55;  // of the record, between the outer windows
  if (windows.size() < 3 || windows.back().time - windows.front().time < kReach) {
    return std::nullopt;
  }

  constexpr double kVaries = 1.25;
  const auto [shortest, longest] = std::ranges::minmax(
      windows, {}, [](const WindowLag& window) { return window.period; });
  const Index unknowns = longest.period > kVaries * shortest.period ? 3 : 2;
  const auto n = static_cast<Index>(windows.size());
  if (n <= unknowns) return std::nullopt;
  MatrixXd design(n, unknowns);
  VectorXd lag(n);
  for (Index i = 0; i < n; ++i) {
    const WindowLag& window = windows[static_cast<std::size_t>(i)];
    const double root = std::sqrt(window.weight / most);
    design(i, 0) = root;
    design(i, 1) = root * window.time;
    if (unknowns == 3) design(i, 2) = root * window.period / longest.period;
    lag[i] = root * window.lag;
  }
  const VectorXd solution = LeastSquares(design, lag);
  LagTrend trend;
  trend.drift = solution[1];
  trend.freedom = static_cast<double>(n - unknowns);
  const double variance = (lag - design * solution).squaredNorm() / trend.freedom;
  const MatrixXd covariance = (design.transpose() * design)
                                  .ldlt()
                                  .solve(MatrixXd::Identity(unknowns, unknowns));
  trend.sd = std::sqrt(variance * std::max(covariance(1, 1), 0.0));
  if (!std::isfinite(trend.drift) || !std::isfinite(trend.sd)) return std::nullopt;
  return trend;
}

double ClockDrift(const LagTrend& a, const LagTrend& b) {
  const double drift = a.drift - b.drift;
  const double sd = std::hypot(a.sd, b.sd);
  // The poorer known of the two decides, if it matters.
  const double freedom = a.sd > b.sd ? a.freedom : b.freedom;
  const bool counts =
      std::abs(drift) > kSmallestDrift && std::abs(drift) > SignificantT(freedom) * sd;
  return counts ? drift : 0.0;
}

}  // namespace mjdiag
