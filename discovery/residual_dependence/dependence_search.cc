#include "mjdiag/discovery/residual_dependence/dependence_search.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>
#include <vector>

#include "mjdiag/diagnosis/statistics/distributions.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLevel = 0.01;  ///< of a false alarm, all variables together
constexpr Index kBlocks = 40;
constexpr Index kFolds = 5;
constexpr std::size_t kMostBins = 40;
constexpr Index kMostCells = 16384;  ///< of the periodogram over x
constexpr double kFewestCycles = 2.0;

Index FoldOf(Index k, Index samples) { return k * kBlocks / samples % kFolds; }

/// 1 + 2 sum rho up to the first zero of the autocorrelation: samples per independent
/// one.
double SamplesPerIndependent(const VectorXd& rest) {
  const Index n = rest.size();
  Index padded = 1;
  while (padded < 2 * n) padded *= 2;
  VectorXd signal = VectorXd::Zero(padded);
  signal.head(n) = rest.array() - rest.mean();
  Eigen::FFT<double> fft;
  Eigen::VectorXcd spectrum;
  fft.fwd(spectrum, signal);
  spectrum = spectrum.cwiseAbs2().cast<std::complex<double>>().eval();
  fft.inv(signal, spectrum);
  double sum = 1.0;
  for (Index lag = 1; lag < n && signal[lag] > 0.0; ++lag) {
    sum += 2.0 * signal[lag] / signal[0];
  }
  return sum;
}

/// Lower edges of bins of equally many samples, or of every value if there are few.
std::vector<double> BinEdges(const VectorXd& x, std::size_t bins) {
  std::vector<double> sorted(x.begin(), x.end());
  std::sort(sorted.begin(), sorted.end());
  std::vector<double> values = sorted;
  values.erase(std::unique(values.begin(), values.end()), values.end());
  if (values.size() <= bins) return values;
  std::vector<double> edges;
  for (std::size_t i = 0; i < bins; ++i)
    edges.push_back(sorted[i * sorted.size() / bins]);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

struct BinSums {
  MatrixXd ff, fm, mm;  ///< bins x folds
  VectorXd x, count;
};

/// g of every bin; empty bins take the nearest before them, or after.
VectorXd Levels(const VectorXd& fm, const VectorXd& mm) {
  VectorXd level(fm.size());
  const double least = 1e-9 * mm.sum();
  Index last = -1;
  for (Index b = 0; b < fm.size(); ++b) {
    if (mm[b] > least) {
      level[b] = fm[b] / mm[b];
      if (last < 0) level.head(b).setConstant(level[b]);
      last = b;
    } else {
      level[b] = last < 0 ? 0.0 : level[last];
    }
  }
  return level;
}

/// Least-squares sine in n equal cells over x.
double SineGain(const VectorXd& sum, const VectorXd& count, double cycles) {
  const auto cells = static_cast<double>(sum.size());
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (Index i = 0; i < sum.size(); ++i) {
    if (count[i] == 0.0) continue;
    const double phase =
        2.0 * std::numbers::pi * cycles * static_cast<double>(i) / cells;
    const Eigen::Vector3d row(1.0, std::sin(phase), std::cos(phase));
    normal += count[i] * row * row.transpose();
    right += sum[i] * row;
  }
  return right.dot(normal.ldlt().solve(right));
}

}  // namespace

ResidualDependenceSearch::ResidualDependenceSearch(const VectorXd& signal,
                                                   double signal_sd, double tests)
    : f_(signal),
      sd_(signal_sd),
      level_(kLevel / tests),
      total_((f_.array() - f_.mean()).square().sum()),
      per_independent_(SamplesPerIndependent(f_)) {}

double ResidualDependenceSearch::Independent(const VectorXd& rest) const {
  const auto n = static_cast<double>(f_.size());
  double per_independent = SamplesPerIndependent(rest);
  if (total_ < 4.0 * n * sd_ * sd_) {
    per_independent = std::max(per_independent, per_independent_);
  }
  return n / per_independent;
}

Explanation ResidualDependenceSearch::Binned(const Variable& variable,
                                             const Variable* factor) const {
  Explanation found;
  for (std::size_t bins = kMostBins; bins >= 5; bins /= 2) {
    double independent = 0.0;
    found = BinnedInto(bins, variable, factor, independent);
    if (independent >= 4.0 * static_cast<double>(found.x.size())) break;
  }
  return found;
}

bool ResidualDependenceSearch::HasMean() const {
  const auto n = static_cast<double>(f_.size());
  const double independent = n / per_independent_;
  if (independent < 3.0) return std::abs(f_.mean()) > 4.0 * sd_;
  const double slow = std::min(1.0, 4.0 / independent);
  return std::abs(f_.mean()) > 4.0 * sd_ * std::sqrt(slow) &&
         f_.mean() * f_.mean() * (independent - 1.0) >
             FQuantile(level_, 1.0, independent - 1.0) * total_ / n;
}

bool ResidualDependenceSearch::Exceeds(double rest, double parameters,
                                       double independent, double level) const {
  const double freedom = independent - parameters - 1.0;
  if (freedom < 3.0) return false;
  return (total_ - rest) / parameters * freedom >
         FQuantile(level, parameters, freedom) * rest;
}

Explanation ResidualDependenceSearch::BinnedInto(std::size_t bins,
                                                 const Variable& variable,
                                                 const Variable* factor,
                                                 double& independent) const {
  const std::vector<double> edges = BinEdges(variable.value, bins);
  const auto count = static_cast<Index>(edges.size());
  const Index n = f_.size();
  BinSums sums{MatrixXd::Zero(count, kFolds), MatrixXd::Zero(count, kFolds),
               MatrixXd::Zero(count, kFolds), VectorXd::Zero(count),
               VectorXd::Zero(count)};
  std::vector<Index> bin_of(static_cast<std::size_t>(n));
  for (Index k = 0; k < n; ++k) {
    const double x = variable.value[k];
    const Index bin =
        std::upper_bound(edges.begin(), edges.end(), x) - edges.begin() - 1;
    const double m = factor == nullptr ? 1.0 : factor->value[k];
    const Index fold = FoldOf(k, n);
    bin_of[static_cast<std::size_t>(k)] = bin;
    sums.ff(bin, fold) += f_[k] * f_[k];
    sums.fm(bin, fold) += f_[k] * m;
    sums.mm(bin, fold) += m * m;
    sums.x[bin] += x;
    sums.count[bin] += 1.0;
  }
  const VectorXd fm = sums.fm.rowwise().sum();
  const VectorXd mm = sums.mm.rowwise().sum();
  double unseen = 0.0;
  for (Index fold = 0; fold < kFolds; ++fold) {
    const VectorXd g = Levels(fm - sums.fm.col(fold), mm - sums.mm.col(fold));
    unseen += sums.ff.col(fold).sum() - 2.0 * g.dot(sums.fm.col(fold)) +
              g.cwiseAbs2().dot(sums.mm.col(fold));
  }
  Explanation found{&variable, factor};
  found.share = 1.0 - unseen / total_;
  found.simple = count <= 5;
  found.x = sums.x.cwiseQuotient(sums.count);
  found.y = Levels(fm, mm);
  independent = static_cast<double>(n);
  if (found.share <= 0.0) return found;
  VectorXd rest(n);
  for (Index k = 0; k < n; ++k) {
    rest[k] = f_[k] - found.y[bin_of[static_cast<std::size_t>(k)]] *
                          (factor == nullptr ? 1.0 : factor->value[k]);
  }
  independent = Independent(rest);
  const double per_independent = static_cast<double>(n) / independent;
  const double variance =
      rest.squaredNorm() / static_cast<double>(n) * per_independent +
      1e-12 * total_ / static_cast<double>(n);
  found.y_sd = (variance * mm.cwiseMax(1e-9 * mm.sum()).cwiseInverse()).cwiseSqrt();
  found.significant =
      Exceeds(rest.squaredNorm(), std::max(1.0, static_cast<double>(count) - 1.0),
              independent, level_);
  return found;
}

double ResidualDependenceSearch::FindPeriod(const VectorXd& x) const {
  Index cells = 1;
  while (2 * cells <= std::min(kMostCells, x.size())) cells *= 2;
  const double low = x.minCoeff();
  const double range = (x.maxCoeff() - low) * (1.0 + 1e-9);
  VectorXd sum = VectorXd::Zero(cells);
  VectorXd count = VectorXd::Zero(cells);
  const double mean = f_.mean();
  for (Index k = 0; k < x.size(); ++k) {
    const auto cell =
        static_cast<Index>((x[k] - low) / range * static_cast<double>(cells));
    sum[cell] += f_[k] - mean;
    count[cell] += 1.0;
  }
  Eigen::FFT<double> fft;
  Eigen::VectorXcd spectrum;
  fft.fwd(spectrum, sum);
  Index peak = 0;
  spectrum.segment(1, cells / 2 - 1).cwiseAbs2().maxCoeff(&peak);
  auto best = static_cast<double>(peak + 1);
  for (const double step : {0.1, 0.01}) {
    const double centre = best;
    double gain = 0.0;
    for (int i = -10; i <= 10; ++i) {
      const double cycles = std::max(0.5, centre + step * i);
      const double now = SineGain(sum, count, cycles);
      if (now > gain) {
        gain = now;
        best = cycles;
      }
    }
  }
  return best < kFewestCycles ? 0.0 : range / best;
}

Explanation ResidualDependenceSearch::Sine(const Variable& variable) const {
  Explanation found{&variable};
  const VectorXd& x = variable.value;
  const Index n = x.size();
  found.period = FindPeriod(x);
  if (found.period == 0.0) return found;
  MatrixXd rows(3, n);
  rows.row(0).setOnes();
  const double omega = 2.0 * std::numbers::pi / found.period;
  rows.row(1) = (omega * x).array().sin().matrix().transpose();
  rows.row(2) = (omega * x).array().cos().matrix().transpose();
  std::vector<Eigen::Matrix3d> normal(kFolds, Eigen::Matrix3d::Zero());
  std::vector<Eigen::Vector3d> right(kFolds, Eigen::Vector3d::Zero());
  VectorXd square = VectorXd::Zero(kFolds);
  Eigen::Matrix3d all = Eigen::Matrix3d::Zero();
  Eigen::Vector3d all_right = Eigen::Vector3d::Zero();
  for (Index k = 0; k < n; ++k) {
    const auto fold = static_cast<std::size_t>(FoldOf(k, n));
    normal[fold] += rows.col(k) * rows.col(k).transpose();
    right[fold] += f_[k] * rows.col(k);
    square[static_cast<Index>(fold)] += f_[k] * f_[k];
  }
  for (std::size_t i = 0; i < kFolds; ++i) {
    all += normal[i];
    all_right += right[i];
  }
  double unseen = 0.0;
  for (std::size_t i = 0; i < kFolds; ++i) {
    const Eigen::Vector3d c = (all - normal[i]).ldlt().solve(all_right - right[i]);
    unseen +=
        square[static_cast<Index>(i)] - 2.0 * c.dot(right[i]) + c.dot(normal[i] * c);
  }
  found.share = 1.0 - unseen / total_;
  if (found.share <= 0.0) return found;
  const Eigen::Vector3d c = all.ldlt().solve(all_right);
  const VectorXd rest = f_ - rows.transpose() * c;
  const double independent = Independent(rest);
  const double periods = 0.5 * static_cast<double>(std::min(kMostCells, n));
  found.significant = Exceeds(rest.squaredNorm(), 2.0, independent, level_ / periods);
  // The curve over one period.
  Variable folded = variable;
  folded.value = x.unaryExpr([&](double value) {
    return value - found.period * std::floor(value / found.period);
  });
  double unused = 0.0;
  const Explanation curve = BinnedInto(kMostBins, folded, nullptr, unused);
  // Where a few samples to a bin explain nothing of the others there is no curve to show.
  found.significant = found.significant && curve.share > 0.0;
  found.x = curve.x;
  found.y = curve.y;
  found.y_sd = curve.y_sd;
  return found;
}

Explanation ResidualDependenceSearch::OverTime(const Variable& time) const {
  Explanation found{&time};
  const Index n = f_.size();
  const auto bins = static_cast<Index>(kMostBins);
  found.x.resize(bins);
  found.y.resize(bins);
  VectorXd rest = f_;
  for (Index b = 0; b < bins; ++b) {
    const Index first = b * n / bins;
    const Index size = (b + 1) * n / bins - first;
    found.x[b] = time.value.segment(first, size).mean();
    found.y[b] = f_.segment(first, size).mean();
    rest.segment(first, size).array() -= found.y[b];
  }
  const auto samples = static_cast<double>(n);
  const double independent = samples / SamplesPerIndependent(rest);
  const double left = rest.squaredNorm();
  found.share = 1.0 - left * (1.0 + kMostBins / independent) / total_;
  found.y_sd = VectorXd::Constant(
      bins, std::sqrt((left / independent * kMostBins + 1e-12 * total_) / samples));
  // Noise that is alike all through a bin moves its mean by all of its sd.
  const double freedom =
      std::clamp(samples / per_independent_, 1.0, static_cast<double>(kMostBins));
  const double chance = ChiSquaredQuantile(level_, freedom) / freedom;
  const VectorXd about_mean = found.y.array() - f_.mean();
  found.significant = about_mean.squaredNorm() / kMostBins > chance * sd_ * sd_;
  return found;
}

}  // namespace mjdiag
