#include "mjdiag/discovery/screening/screener.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "mjdiag/discovery/screening/bounded_regression.h"
#include "mjdiag/signals/decompositions.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Columns that are filtered together: enough to keep the processor busy, few enough to
// stay in memory.
constexpr Index kBatch = 48;
// Multiplications for every sample of a signal: to make it, and to take means.
constexpr Index kPerSample = 8;

/// What is measured over what is known of the numbers beforehand.
MatrixXd WithNumbers(const MatrixXd& measured, const MatrixXd& numbers) {
  MatrixXd all(measured.rows() + numbers.rows(), measured.cols());
  all << measured, numbers;
  return all;
}

}  // namespace

Screener::Screener(const DiscoveryProblem& problem, const ErrorDynamics& dynamics,
                   const VectorXd& residual, const MatrixXd& jacobian,
                   const FittedModel& present)
    : problem_(problem),
      dynamics_(dynamics),
      channels_(problem.run().outputs.rows()),
      block_(dynamics.block()),
      skip_((problem.skip() + block_ - 1) / block_),
      blocks_(problem.train() / block_ - skip_),
      full_(
          residual.segment(channels_ * block_ * skip_, channels_ * block_ * blocks_)) {
  const double root = std::sqrt(present.prior_weight);
  const VectorXd numbers = root * present.numbers;
  VectorXd left = WithNumbers(full_, numbers);
  if (jacobian.cols() > 0) {
    const MatrixXd J =
        jacobian.middleRows(channels_ * block_ * skip_, channels_ * block_ * blocks_);
    const MatrixXd known = root * MatrixXd::Identity(numbers.size(), J.cols());
    const MatrixXd all = OrthonormalColumns(WithNumbers(J, known));
    left -= all * (all.transpose() * left);
    found_ = OrthonormalColumns(WithNumbers(Averaged(J, channels_, block_), known));
  }
  rest_ = left.squaredNorm();
  full_ = left.head(full_.size());
  residual_ =
      WithNumbers(Averaged(full_, channels_, block_), left.tail(numbers.size()));
  if (found_.cols() > 0) residual_ -= found_ * (found_.transpose() * residual_);
  const Index measured = channels_ * blocks_;
  VectorXd padded = VectorXd::Zero(channels_ * skip_ + measured);
  padded.tail(measured) = residual_.head(measured);
  adjoint_ = dynamics_.AdjointOf(padded);
}

/// Work that so many numbers each of `count` signals are.
void Screener::Charge(Index numbers, Index count) const {
  problem_.work()->Add(
      FilterWork(static_cast<double>(numbers) * static_cast<double>(count)));
}

/// Columns of trials first .. last - 1 side by side.
MatrixXd Screener::Responses(const std::vector<Trial>& trials, std::size_t first,
                             std::size_t last, const Candidate& candidate) const {
  Index columns = 0;
  for (std::size_t t = first; t < last; ++t) columns += trials[t].signals.cols();
  Charge(kPerSample * problem_.train() + blocks_ * found_.cols() +
             blocks_ * 4 * problem_.machine().linear().M.size(),
         columns);
  MatrixXd signals(problem_.train(), columns);
  MatrixXd entry(problem_.machine().linear().M.rows(), columns);
  const bool forces = trials[first].entry.size() > 0;
  Index next = 0;
  for (std::size_t t = first; t < last; ++t) {
    const Index width = trials[t].signals.cols();
    signals.middleCols(next, width) = trials[t].signals.topRows(problem_.train());
    if (forces) entry.middleCols(next, width) = trials[t].entry;
    next += width;
  }
  return (forces ? dynamics_.OfForces(entry, signals)
                 : dynamics_.OfReadings(candidate.channel, signals))
      .bottomRows(channels_ * blocks_);
}

bool Screener::IsFast(const Trial& trial) const {
  constexpr double kKept = 0.9;  // of its squares, in the means of blocks
  if (trial.entry.size() > 0 || block_ == 1) return false;
  const MatrixXd signals = trial.signals.topRows(block_ * (skip_ + blocks_));
  return Averaged(signals, 1, block_).squaredNorm() < kKept * signals.squaredNorm();
}

std::size_t Screener::Slow(const Sweep& sweep) const {
  const auto slow = [&](double value) { return !IsFast(sweep.make(value)); };
  return static_cast<std::size_t>(std::ranges::partition_point(sweep.values, slow) -
                                  sweep.values.begin());
}

/// The part of a fast trial in its own sensor, every sample.
MatrixXd Screener::Fast(const Trial& trial, const Candidate& candidate) const {
  MatrixXd seen = dynamics_.weight()[candidate.channel] *
                  trial.signals.middleRows(block_ * skip_, block_ * blocks_);
  if (problem_.run().Counted().size() > 0) {
    const SampleMask counted =
        problem_.run().CountedOf(candidate.channel, block_ * skip_, block_ * blocks_);
    seen.array().colwise() *= counted.cast<double>();
  }
  return seen;
}

std::optional<Start> Screener::Regress(const Trial& trial, const MatrixXd& response,
                                       const VectorXd& residual, bool fast) const {
  MatrixXd phi = trial.summed ? MatrixXd(response.rowwise().sum()) : response;
  if (residual.size() > phi.rows()) {
    phi = WithNumbers(phi, MatrixXd::Zero(residual.size() - phi.rows(), phi.cols()));
  }
  const VectorXd size = phi.colwise().squaredNorm();
  if (found_.cols() > 0 && !fast) phi -= found_ * (found_.transpose() * phi);
  const MatrixXd G = phi.transpose() * phi;
  // A column that what has been found explains already says nothing: of a law that
  // contains a found one it is what that does.
  constexpr double kIndependent = 1e-8;
  const Eigen::ArrayX<bool> explained =
      !(G.diagonal().array() > kIndependent * size.array());
  const auto best =
      RegressBounded(G, phi.transpose() * residual, trial.least, explained);
  if (!best) return std::nullopt;
  const TrialValues values = trial.values(best->amplitude);
  if (!values) return std::nullopt;
  Start start;
  start.cause.value = *values;
  start.gain = best->gain;
  start.freedom = static_cast<int>(G.cols());
  return start;
}

/// take(t, response of trial t, whether that is fast) for all trials in order, filtered
/// many at a time.
template <typename Take>
void Screener::ForEachResponse(const std::vector<Trial>& trials,
                               const Candidate& candidate, const Take& take) const {
  std::vector<bool> fast;
  for (const Trial& trial : trials) fast.push_back(IsFast(trial));
  std::size_t first = 0;
  while (first < trials.size()) {
    if (fast[first]) {
      take(first, Fast(trials[first], candidate), true);
      ++first;
      continue;
    }
    std::size_t last = first;
    Index columns = 0;
    while (last < trials.size() && columns < kBatch && !fast[last]) {
      columns += trials[last++].signals.cols();
    }
    const MatrixXd responses = Responses(trials, first, last, candidate);
    Index next = 0;
    for (std::size_t t = first; t < last; ++t) {
      const Index width = trials[t].signals.cols();
      take(t, responses.middleCols(next, width), false);
      next += width;
    }
    first = last;
  }
}

std::vector<std::optional<Start>> Screener::Judge(const std::vector<Trial>& trials,
                                                  const Candidate& candidate) const {
  std::vector<std::optional<Start>> starts(trials.size());
  const Eigen::Map<const MatrixXd> channels(full_.data(), channels_, block_ * blocks_);
  ForEachResponse(
      trials, candidate, [&](std::size_t t, const auto& response, bool fast) {
        starts[t] =
            fast ? Regress(trials[t], response, channels.row(candidate.channel), true)
                 : Regress(trials[t], response, residual_, false);
      });
  return starts;
}

/// What the whole sweep has in common with the residual, squared. A response e has
/// <e, r> = <signal, g> with g the adjoint, or r itself for what is fast.
std::vector<double> Screener::Common(const Sweep& sweep,
                                     const Candidate& candidate) const {
  const std::size_t slow = Slow(sweep);
  VectorXd of_fast = VectorXd::Zero(problem_.train());
  if (slow < sweep.values.size()) {  // a sensor; joints have no channel
    const Eigen::Map<const MatrixXd> channels(full_.data(), channels_,
                                              block_ * blocks_);
    of_fast.segment(block_ * skip_, block_ * blocks_) =
        dynamics_.weight()[candidate.channel] *
        channels.row(candidate.channel).transpose();
  }
  const Trial first = sweep.make(sweep.values.front());
  const VectorXd adjoint = first.entry.size() > 0
                               ? VectorXd(adjoint_.forces * first.entry.col(0))
                               : VectorXd(adjoint_.readings.col(candidate.channel));
  VectorXd of_slow = VectorXd::Zero(problem_.train());
  for (Index k = 0; k < block_ * (skip_ + blocks_); ++k) {
    of_slow[k] = adjoint[k / block_] / static_cast<double>(block_);
  }
  const auto waves = [](const VectorXd& angle) {
    Eigen::ArrayXcd wave(angle.size());
    wave.real() = angle.array().cos();
    wave.imag() = angle.array().sin();
    return wave;
  };
  Eigen::ArrayXcd wave = waves(sweep.angle.head(problem_.train()));
  const Eigen::ArrayXcd turn = waves(sweep.increment.head(problem_.train()));
  Charge(kPerSample * problem_.train(), static_cast<Index>(sweep.values.size()));
  std::vector<double> common;
  for (std::size_t i = 0; i < sweep.values.size(); ++i) {
    const VectorXd& weight = i < slow ? of_slow : of_fast;
    common.push_back(std::norm((wave * weight.array()).sum()));
    wave *= turn;
  }
  return common;
}

std::vector<double> Screener::RoughGains(const Sweep& sweep,
                                         const Candidate& candidate) const {
  constexpr std::size_t kEvery = 16;
  const std::size_t count = sweep.values.size();
  std::vector<Trial> sample;
  for (std::size_t i = 0; i < count; i += kEvery) {
    sample.push_back(sweep.make(sweep.values[i]));
  }
  std::vector<double> judged;  // log
  ForEachResponse(sample, candidate, [&](std::size_t, const auto& response, bool) {
    judged.push_back(std::log(std::max(response.squaredNorm(), 1e-300)));
  });
  std::vector<double> gains = Common(sweep, candidate);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t before = i / kEvery;
    const std::size_t after = std::min(before + 1, judged.size() - 1);
    const double part = static_cast<double>(i % kEvery) / kEvery;
    const double size = (1.0 - part) * judged[before] + part * judged[after];
    gains[i] /= std::exp(size);
  }
  return gains;
}

std::vector<double> Screener::Gains(const Sweep& sweep, const Candidate& candidate,
                                    const std::vector<double>& places) const {
  std::vector<Trial> trials;
  trials.reserve(places.size());
  for (const double place : places) trials.push_back(sweep.make(ValueAt(sweep, place)));
  std::vector<double> gains;
  for (const auto& start : Judge(trials, candidate)) {
    gains.push_back(start ? start->gain : 0.0);
  }
  return gains;
}

std::vector<double> Screener::Peaks(const Sweep& sweep, const Candidate& candidate,
                                    std::size_t count) const {
  std::vector<double> all;
  for (std::size_t i = 0; i + 1 < 2 * sweep.values.size(); ++i) {
    all.push_back(0.5 * static_cast<double>(i));
  }
  const std::vector<double> gains = Gains(sweep, candidate, all);
  std::vector<std::pair<double, double>> maxima;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool above_left = i == 0 || gains[i] >= gains[i - 1];
    const bool above_right = i + 1 == all.size() || gains[i] >= gains[i + 1];
    if (above_left && above_right) maxima.emplace_back(gains[i], all[i]);
  }
  std::ranges::sort(maxima, std::greater<>());
  if (maxima.size() > count) maxima.resize(count);
  std::vector<double> tops;
  tops.reserve(maxima.size());
  for (const auto& [gain, place] : maxima) tops.push_back(place);
  // A strong wave loses much within a small part of a step: halve it.
  constexpr int kHalvings = 5;
  double step = 0.25;
  for (int i = 0; i < kHalvings; ++i, step *= 0.5) {
    std::vector<double> around;
    for (const double top : tops) {
      around.insert(around.end(), {top - step, top, top + step});
    }
    const std::vector<double> worth = Gains(sweep, candidate, around);
    for (std::size_t k = 0; k < tops.size(); ++k) {
      const auto first = worth.begin() + static_cast<std::ptrdiff_t>(3 * k);
      const auto best = std::max_element(first, first + 3) - worth.begin();
      tops[k] = around[static_cast<std::size_t>(best)];
    }
  }
  return tops;
}

std::vector<Trial> Screener::BestOf(const Sweep& sweep, const Candidate& candidate,
                                    const std::vector<double>& worth) const {
  constexpr std::size_t kCoarse = 12;
  constexpr std::size_t kFine = 6;
  constexpr std::size_t kKept = 6;
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < worth.size(); ++i) order.emplace_back(worth[i], i);
  std::ranges::sort(order, std::greater<>());
  // A motion between few places makes many narrow peaks of nearly the same height: the
  // best values, and then the best of what lies closely around them.
  std::vector<double> kept;
  std::vector<std::size_t> centres;
  for (const auto& [gain, i] : order) {
    const bool near = std::ranges::any_of(centres, [i = i](std::size_t k) {
      return std::max(i, k) - std::min(i, k) < 2;
    });
    if (near) continue;
    centres.push_back(i);
    for (const double part : {-0.35, 0.0, 0.35}) {
      kept.push_back(static_cast<double>(i) + part);
    }
    if (centres.size() == kCoarse) break;
  }
  kept = BestPlaces(sweep, kept, candidate, kFine);
  std::vector<double> fine;
  for (const double place : kept) {
    for (const double part : {-0.2, -0.1, 0.0, 0.1, 0.2}) {
      fine.push_back(place + part);
    }
  }
  std::vector<Trial> trials;
  for (const double place : BestPlaces(sweep, fine, candidate, kKept)) {
    trials.push_back(sweep.make(ValueAt(sweep, place)));
  }
  return trials;
}

/// The `count` places with the largest gain, at least a third of a step apart.
std::vector<double> Screener::BestPlaces(const Sweep& sweep,
                                         const std::vector<double>& places,
                                         const Candidate& candidate,
                                         std::size_t count) const {
  std::vector<Trial> trials;
  trials.reserve(places.size());
  for (const double place : places) trials.push_back(sweep.make(ValueAt(sweep, place)));
  const std::vector<std::optional<Start>> starts = Judge(trials, candidate);
  std::vector<std::pair<double, double>> gains;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (starts[i]) gains.emplace_back(starts[i]->gain, places[i]);
  }
  std::ranges::sort(gains, std::greater<>());
  std::vector<double> best;
  for (const auto& [gain, place] : gains) {
    const bool near = std::ranges::any_of(best, [place = place](double other) {
      return std::abs(place - other) < 1.0 / 3.0;
    });
    if (!near) best.push_back(place);
    if (best.size() == count) break;
  }
  return best;
}

/// Between two values of a sweep, whose angles are evenly spaced: periods by their
/// inverse, frequencies as they are; between neighbours both are near enough to even.
double Screener::ValueAt(const Sweep& sweep, double place) {
  const auto last = static_cast<double>(sweep.values.size() - 1);
  const double inside = std::clamp(place, 0.0, last);
  const auto below = static_cast<std::size_t>(inside);
  const std::size_t above = std::min(below + 1, sweep.values.size() - 1);
  const double part = inside - static_cast<double>(below);
  return (1.0 - part) * sweep.values[below] + part * sweep.values[above];
}

}  // namespace mjdiag
