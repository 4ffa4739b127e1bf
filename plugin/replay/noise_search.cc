#include "mjdiag/plugin/replay/noise_search.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "mjdiag/plugin/replay/bounded_descent.h"
#include "mjdiag/plugin/replay/linear_pass.h"
#include "mjdiag/plugin/replay/noise_slope.h"
#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Less is noise of the search.
constexpr double kGain = 0.2;

constexpr Index kPieces = 4;
constexpr Index kShortest = 100;

/// A quarter of each, which coarse steps are judged by.
std::vector<Stretch> QuarterOf(std::vector<Stretch> pieces) {
  constexpr Index kParts = 4;
  for (Stretch& piece : pieces) {
    piece.count = std::min(piece.count, std::max(kShortest, piece.count / kParts));
  }
  return pieces;
}

/// Parts that can be looked at side by side: where one begins the path is known, and how well
/// matters for some ticks.
std::vector<Stretch> Halved(const Stretch& piece) {
  constexpr Index kShort = 1000;
  if (piece.count < 2 * kShort) return {piece};
  const Index half = piece.count / 2;
  std::vector<Stretch> parts = Halved({piece.first, half});
  std::ranges::copy(Halved({piece.first + half, piece.count - half}),
                    std::back_inserter(parts));
  return parts;
}

/// -2 ln L of some pieces, of every sensor.
VectorXd DeviancesOf(const FilterPath& path, const std::vector<Stretch>& pieces,
                     const FilterNoise& noise) {
  VectorXd sum = VectorXd::Zero(path.sensors());
  for (const Stretch& piece : pieces) {
    sum += Score(path, noise, piece.first, piece.count).deviance;
  }
  if (!sum.allFinite()) sum.setConstant(std::numeric_limits<double>::infinity());
  return sum;
}

/// To where the parabola through -2 ln L at -1, 0 and 1 is least, two steps at most.
double LeastOf(double before, double here, double after) {
  constexpr double kMost = 2.0;
  const double bend = before - 2.0 * here + after;
  const double slope = 0.5 * (after - before);
  if (!(bend > 0.0)) {
    if (std::min(before, after) >= here) return 0.0;
    return after < before ? 1.0 : -1.0;
  }
  return std::clamp(-slope / bend, -kMost, kMost);
}

/// How -2 ln L bends: half the sum of g g', g its slopes by stretches, is the information of
/// all of them (E. R. Berndt, B. H. Hall, R. E. Hall, J. A. Hausman, "Estimation and Inference
/// in Nonlinear Structural Models", Ann. Econ. Soc. Meas. 3, 1974). What no reading tells
/// bends by 1.
MatrixXd CurvatureOf(const std::vector<NoiseSlope>& slopes) {
  const Index n = slopes.front().slope.size();
  MatrixXd curvature = MatrixXd::Identity(n, n);
  for (const NoiseSlope& one : slopes) {
    curvature += 0.5 * one.parts * one.parts.transpose();
  }
  return curvature;
}

VectorXd LogarithmsOf(const FilterNoise& noise) {
  const Index nf = noise.size.size();
  const Index ny = noise.reading.size();
  VectorXd x(3 * nf + ny + 2);
  x << noise.size, noise.memory, noise.white, noise.reading, noise.clock,
      noise.clock_memory;
  return x.array().log();
}

}  // namespace

// Of so many readings the noise is known to 2 %: its logarithm to sqrt(2 / 3600) = 0.024.
// Small machines, of which more takes no longer, have more.
Index EnoughOf(Index sensors, Index states) {
  constexpr double kReadings = 3600.0;
  constexpr double kLarge = 24.0;
  const double times = std::pow(kLarge / static_cast<double>(states), 2);
  return static_cast<Index>(kReadings * std::clamp(times, 1.0, 4.0)) / sensors;
}

std::vector<Stretch> PiecesOf(Index first, Index count, Index of_all, Index enough) {
  const Index piece = std::max(kShortest, enough * count / of_all / kPieces);
  if (of_all <= 2 * enough || piece * kPieces >= count) return {{first, count}};
  std::vector<Stretch> pieces;
  for (Index i = 0; i < kPieces; ++i) {
    pieces.push_back({first + (count - piece) * i / (kPieces - 1), piece});
  }
  return pieces;
}

Shown ShownBy(const TickTangent& tangent, const std::vector<Index>& dofs,
              const VectorXd& reading_sd) {
  const MatrixXd seen =
      reading_sd.cwiseInverse().asDiagonal() * (tangent.C * tangent.B + tangent.D);
  Shown shown{{}, VectorXd(static_cast<Index>(dofs.size()))};
  for (std::size_t j = 0; j < dofs.size(); ++j) {
    Index best = 0;
    const double most = seen.col(dofs[j]).cwiseAbs().maxCoeff(&best);
    shown.by.push_back(best);
    shown.unit[static_cast<Index>(j)] = 1.0 / std::max(most, 1e-300);
  }
  return shown;
}

NoiseSearch::NoiseSearch(const FilterPath& path, const VectorXd& reading_sd,
                         double longest, Index readings)
    : path_(path), nf_(path.dof_count()), ny_(path.sensors()) {
  const Index enough = EnoughOf(ny_, path.pulled.rows());
  for (std::size_t r = 0; r < path.first.size(); ++r) {
    const auto pieces = [&](Index samples) {
      return PiecesOf(path.first[r], path.EndOf(r) - path.first[r], path.samples(),
                      samples);
    };
    for (const Stretch& piece : pieces(readings / ny_)) {
      std::ranges::copy(Halved(piece), std::back_inserter(pieces_));
    }
    std::ranges::copy(QuarterOf(pieces(enough)), std::back_inserter(quarter_));
  }
  const double tick = path.sample_time;
  const Shown shown = ShownBy(path.tangents.front(), path.dofs, reading_sd);
  unit_ = shown.unit;
  // A size of nothing is as good as one that no record of that length would show.
  const VectorXd tiny = (1e-12 * unit_).array().log();
  const VectorXd huge = (1e9 * unit_).array().log();
  lower_.resize(3 * nf_ + ny_ + 2);
  upper_.resize(lower_.size());
  lower_ << tiny, VectorXd::Constant(nf_, std::log(2.0 * tick)), tiny,
      (0.5 * reading_sd).array().log().matrix(), std::log(1e-6 * tick),
      std::log(0.1 * tick);
  // A clock that is off for longer than ten ticks is a delay.
  upper_ << huge, VectorXd::Constant(nf_, std::log(std::max(longest, 4.0 * tick))),
      huge, (100.0 * reading_sd).array().log().matrix(), std::log(tick),
      std::log(10.0 * tick);
  const auto joints = [&](double size, double memory, double white) {
    std::vector<std::pair<VectorXd, Index>> parts;
    for (Index j = 0; j < nf_; ++j) {
      VectorXd direction = VectorXd::Zero(lower_.size());
      direction[j] = size;
      direction[nf_ + j] = memory;
      direction[2 * nf_ + j] = white;
      parts.emplace_back(direction, shown.by[static_cast<std::size_t>(j)]);
    }
    kinds_.push_back(std::move(parts));
  };
  if (nf_ > 0) {
    joints(1.0, 0.0, 0.0);
    joints(0.5, 1.0, 0.0);  // the walk is the same
    joints(0.0, 1.0, 0.0);
    joints(0.0, 0.0, 1.0);
  }
  kinds_.emplace_back();
  for (Index i = 0; i < ny_; ++i) {
    kinds_.back().emplace_back(VectorXd::Unit(lower_.size(), 3 * nf_ + i), i);
  }
}

FilterNoise NoiseSearch::Slow(FilterNoise noise) const {
  const double tick = path_.sample_time;
  const double duration = tick * static_cast<double>(path_.samples());
  noise.memory.setConstant(std::max(0.1 * duration, 4.0 * tick));
  const double ticks = noise.memory[0] / tick;
  noise.size = unit_ / (ticks * ticks);
  noise.white = unit_ / (ticks * std::sqrt(ticks));
  return noise;
}

FilterNoise NoiseSearch::NoiseOf(const VectorXd& x) const {
  FilterNoise noise;
  noise.size = x.head(nf_).array().exp();
  noise.memory = x.segment(nf_, nf_).array().exp();
  noise.white = x.segment(2 * nf_, nf_).array().exp();
  noise.reading = x.segment(3 * nf_, ny_).array().exp();
  noise.clock = std::exp(x[3 * nf_ + ny_]);
  noise.clock_memory = std::exp(x[3 * nf_ + ny_ + 1]);
  return noise;
}
VectorXd NoiseSearch::WithClock(VectorXd x, double size) const {
  x[clock()] = size;
  return x;
}

NoiseSearch::Point NoiseSearch::Evaluate(const VectorXd& x,
                                         const std::vector<Stretch>& by) const {
  Point point{x.cwiseMax(lower_).cwiseMin(upper_), {}};
  point.deviances = DeviancesOf(path_, by, NoiseOf(point.x));
  return point;
}

bool NoiseSearch::Move(const Kind& kind, double step, Point& best) const {
  VectorXd all = VectorXd::Zero(best.x.size());
  for (const auto& [direction, sensor] : kind) all += step * direction;
  Point tried[2];
  ParallelFor(2, [&](int i) {
    tried[i] = Evaluate(best.x + (i == 0 ? 1.0 : -1.0) * all, quarter_);
  });
  VectorXd each = VectorXd::Zero(best.x.size());
  for (const auto& [direction, sensor] : kind) {
    const auto of = [sensor = sensor](const Point& point) {
      return point.deviances[sensor];
    };
    each += LeastOf(of(tried[1]), of(best), of(tried[0])) * step * direction;
  }
  const double before = best.deviance();
  const auto take = [&](Point& point) {
    if (point.deviance() < best.deviance()) best = std::move(point);
  };
  if (!each.isZero(0.0)) {
    Point mixed = Evaluate(best.x + each, quarter_);
    take(mixed);
  }
  take(tried[0]);
  take(tried[1]);
  return best.deviance() < before - kGain;
}

VectorXd NoiseSearch::Hop(const VectorXd& x) const {
  constexpr double kHop = 4.2;  // natural logarithm
  constexpr int kRounds = 2;
  Point best = Evaluate(x, quarter_);
  for (int round = 0; round < kRounds; ++round) {
    bool moved = false;
    for (const auto& kind : kinds_) moved |= Move(kind, kHop, best);
    if (!moved) break;
  }
  return best.x;
}

LikelyNoise NoiseSearch::Downhill(const VectorXd& x, bool with_clock) const {
  constexpr double kEnd = 0.5;  // less is noise of fits
  const Least least = DescendWithin(
      [&](const VectorXd& at) {
        std::vector<NoiseSlope> slopes(pieces_.size());
        const FilterNoise noise = NoiseOf(at);
        ParallelFor(static_cast<int>(pieces_.size()), [&](int number) {
          const auto i = static_cast<std::size_t>(number);
          slopes[i] = SlopeAlong(path_, noise, pieces_[i].first, pieces_[i].count);
        });
        Sloped all{0.0, VectorXd::Zero(at.size()), CurvatureOf(slopes)};
        for (const NoiseSlope& one : slopes) {
          all.value += one.deviance;
          all.slope += one.slope;
        }
        if (!with_clock) {
          all.slope.tail(2).setZero();
          all.curvature.rightCols(2).setZero();
          all.curvature.bottomRows(2).setZero();
          all.curvature.diagonal().tail(2).setOnes();
        }
        // Noises that are far off make slopes beyond all numbers.
        const bool is_finite = all.slope.allFinite() && all.curvature.allFinite();
        if (!is_finite) all.value = std::numeric_limits<double>::infinity();
        return all;
      },
      x, lower_, upper_, kEnd);
  return {NoiseOf(least.x), least.value, 0.0};
}

LikelyNoise NoiseSearch::Descend(const FilterNoise& noise, bool is_far) const {
  const VectorXd x = LogarithmsOf(noise);
  const double before = Evaluate(x, pieces_).deviance();
  LikelyNoise best;
  constexpr double kShows = 0.1;  // logarithm above nothing
  if (!is_far && x[clock()] > lower_[clock()] + kShows) {
    // It shows already: without it the others would go far away to make up for it.
    best = Downhill(x, true);
  } else {
    const VectorXd without = WithClock(x, lower_[clock()]);
    best = Downhill(is_far ? Hop(without) : without, false);
    for (const double size : {x[clock()], upper_[clock()] + std::log(0.1)}) {
      const Point with = Evaluate(WithClock(LogarithmsOf(best.noise), size), pieces_);
      if (with.deviance() < best.deviance - kGain) best = Downhill(with.x, true);
    }
  }
  if (!(best.deviance < before)) best = {noise, before, 0.0};
  best.gain = before - best.deviance;
  return best;
}

}  // namespace mjdiag
