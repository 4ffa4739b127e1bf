#include "mjdiag/plugin/replay/noise_fit.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "mjdiag/plugin/machine/tick_differences.h"
#include "mjdiag/plugin/machine/tick_map.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/tangent_coordinates.h"
#include "mjdiag/plugin/replay/linear_pass.h"
#include "mjdiag/plugin/replay/recorded_inputs.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Samples first .. first + count - 1 of a record.
struct Stretch {
  Index first = 0;
  Index count = 0;
};

// Of so many readings, in some pieces of every record, the noise is known to 2 %: its
// logarithm to sqrt(2 / 3600) = 0.024. What that leaves in -2 ln L of all readings grows with
// how many more these are, so that small machines, of which more takes no longer, have more.
constexpr Index kEnough = 3600;
constexpr Index kPieces = 4;
constexpr Index kShortest = 100;

/// As many as take no longer than those of a machine with that many states.
Index EnoughOf(Index states) {
  constexpr double kLarge = 24.0;
  const double times = std::pow(kLarge / static_cast<double>(states), 2);
  return static_cast<Index>(kEnough * std::clamp(times, 1.0, 4.0));
}

/// Four pieces of a record, of `of_all` samples of `sensors` of a run; of a short one all of
/// it.
std::vector<Stretch> PiecesOf(Index first, Index count, Index of_all, Index sensors,
                              Index states) {
  const Index enough = EnoughOf(states) / sensors;
  const Index piece = std::max(kShortest, enough * count / of_all / kPieces);
  if (of_all <= enough || piece * kPieces >= count) return {{first, count}};
  std::vector<Stretch> pieces;
  for (Index i = 0; i < kPieces; ++i) {
    pieces.push_back({first + (count - piece) * i / (kPieces - 1), piece});
  }
  return pieces;
}

/// A quarter of each, which coarse steps are judged by.
std::vector<Stretch> QuarterOf(std::vector<Stretch> pieces) {
  constexpr Index kParts = 4;
  for (Stretch& piece : pieces) {
    piece.count = std::min(piece.count, std::max(kShortest, piece.count / kParts));
  }
  return pieces;
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

/// The sensor that shows each latent force best, and the force that moves its reading by
/// its noise in a tick.
struct Shown {
  std::vector<Index> by;
  VectorXd unit;  // nf
};

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

/// A point of the search, and -2 ln L there of every sensor.
struct Point {
  VectorXd x;
  VectorXd deviances;
  double deviance() const { return deviances.sum(); }
};

/// Logarithms of a noise within bounds: size, memory, white (nf each), readings, clock and
/// its memory.
class NoiseSearch {
 public:
  NoiseSearch(const FilterPath& path, const VectorXd& reading_sd, double longest)
      : path_(path), nf_(path.dof_count()), ny_(path.sensors()) {
    for (std::size_t r = 0; r < path.first.size(); ++r) {
      std::ranges::copy(PiecesOf(path.first[r], path.EndOf(r) - path.first[r],
                                 path.samples(), ny_, path.pulled.rows()),
                        std::back_inserter(pieces_));
    }
    quarter_ = QuarterOf(pieces_);
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
    for (const auto& [size, memory] :
         {std::pair(1.0, 0.0), std::pair(0.5, 1.0), std::pair(0.0, 1.0)}) {
      VectorXd clock = VectorXd::Zero(lower_.size());
      clock.tail(2) << size, memory;
      of_clock_.push_back({{clock, Index{-1}}});
    }
  }

  /// Forces that, as long as they last, move readings by their noise.
  FilterNoise Slow(FilterNoise noise) const {
    const double tick = path_.sample_time;
    const double duration = tick * static_cast<double>(path_.samples());
    noise.memory.setConstant(std::max(0.1 * duration, 4.0 * tick));
    const double ticks = noise.memory[0] / tick;
    noise.size = unit_ / (ticks * ticks);
    noise.white = unit_ / (ticks * std::sqrt(ticks));
    return noise;
  }

  FilterNoise NoiseOf(const VectorXd& x) const {
    FilterNoise noise;
    noise.size = x.head(nf_).array().exp();
    noise.memory = x.segment(nf_, nf_).array().exp();
    noise.white = x.segment(2 * nf_, nf_).array().exp();
    noise.reading = x.segment(3 * nf_, ny_).array().exp();
    noise.clock = std::exp(x[3 * nf_ + ny_]);
    noise.clock_memory = std::exp(x[3 * nf_ + ny_ + 1]);
    return noise;
  }
  /// From a noise on, by steps that shrink by a third from `step` to `last`, natural
  /// logarithms. A clock that shows is different at every reading, so that no gain is kept:
  /// it is asked for where the rest is settled to a factor.
  Point Descend(const FilterNoise& noise, double step, double last) const {
    VectorXd x(lower_.size());
    x << noise.size.array().log().matrix(), noise.memory.array().log().matrix(),
        noise.white.array().log().matrix(), noise.reading.array().log().matrix(),
        std::log(noise.clock), std::log(noise.clock_memory);
    constexpr double kRough = 1.5;  // a factor of 4
    const std::vector<Stretch>* by = step > kRough ? &quarter_ : &pieces_;
    bool has_clock = false;
    Point best = Evaluate(WithClock(x, lower_[clock()]), *by);
    const auto ask_for_clock = [&] {
      if (has_clock) return;
      for (const double size :
           {std::log(noise.clock), upper_[clock()] + std::log(0.1)}) {
        Point with = Evaluate(WithClock(best.x, size), *by);
        if (!(with.deviance() < best.deviance() - kGain)) continue;
        best = std::move(with);
        has_clock = true;
      }
    };
    for (; step >= last; step /= 3.0) {
      if (step <= kRough && by == &quarter_) {
        by = &pieces_;
        best = Evaluate(best.x, *by);
      }
      if (step <= kRough) ask_for_clock();
      constexpr int kRounds = 2;
      for (int round = 0; round < kRounds; ++round) {
        bool moved = false;
        for (const auto& kind : kinds_) moved |= Move(kind, step, *by, best);
        if (has_clock) {
          for (const auto& kind : of_clock_) moved |= Move(kind, step, *by, best);
        }
        if (!moved) break;
      }
    }
    return best;
  }

 private:
  // Less is noise of the search.
  static constexpr double kGain = 0.2;

  Index clock() const { return 3 * nf_ + ny_; }
  VectorXd WithClock(VectorXd x, double size) const {
    x[clock()] = size;
    return x;
  }
  Point Evaluate(const VectorXd& x, const std::vector<Stretch>& by) const {
    Point point{x.cwiseMax(lower_).cwiseMin(upper_), {}};
    point.deviances = DeviancesOf(path_, by, NoiseOf(point.x));
    return point;
  }

  /// Directions with the sensor that judges each; -1: all.
  using Kind = std::vector<std::pair<VectorXd, Index>>;

  /// To where the parabola through -2 ln L at -1, 0 and 1 is least, two steps at most.
  static double LeastOf(double before, double here, double after) {
    constexpr double kMost = 2.0;
    const double bend = before - 2.0 * here + after;
    const double slope = 0.5 * (after - before);
    if (!(bend > 0.0)) {
      if (std::min(before, after) >= here) return 0.0;
      return after < before ? 1.0 : -1.0;
    }
    return std::clamp(-slope / bend, -kMost, kMost);
  }

  bool Move(const Kind& kind, double step, const std::vector<Stretch>& by,
            Point& best) const {
    VectorXd all = VectorXd::Zero(best.x.size());
    for (const auto& [direction, sensor] : kind) all += step * direction;
    Point tried[2];
    ParallelFor(2, [&](int i) {
      tried[i] = Evaluate(best.x + (i == 0 ? 1.0 : -1.0) * all, by);
    });
    VectorXd each = VectorXd::Zero(best.x.size());
    for (const auto& [direction, sensor] : kind) {
      const auto of = [sensor](const Point& point) {
        return sensor < 0 ? point.deviance() : point.deviances[sensor];
      };
      each += LeastOf(of(tried[1]), of(best), of(tried[0])) * step * direction;
    }
    const double before = best.deviance();
    const auto take = [&](Point& point) {
      if (point.deviance() < best.deviance()) best = std::move(point);
    };
    if (!each.isZero(0.0)) {
      Point mixed = Evaluate(best.x + each, by);
      take(mixed);
    }
    take(tried[0]);
    take(tried[1]);
    return best.deviance() < before - kGain;
  }

  const FilterPath& path_;
  std::vector<Stretch> pieces_;
  std::vector<Stretch> quarter_;
  Index nf_;
  Index ny_;
  VectorXd unit_;
  VectorXd lower_, upper_;
  std::vector<Kind> kinds_;
  std::vector<Kind> of_clock_;
};

}  // namespace

FilterNoise FollowingNoise(const Machine& machine, const MeasuredRun& run,
                           const std::vector<Index>& dofs,
                           const std::vector<FilterStart>& starts,
                           const VectorXd& reading_sd) {
  TickMap map(machine);
  RecordedInputs inputs(machine, run);
  const VectorXd none = VectorXd::Zero(machine.plant().nv);
  inputs.StayAt(run.records.front().sample);
  map.Run(starts.front().state, none, 0, inputs);
  const TickTangent tangent = TickDifferences(map, run.sample_time, dofs)
                                  .Of(starts.front().state, none, 0, inputs);
  const VectorXd unit = ShownBy(tangent, dofs, reading_sd).unit;
  FilterNoise noise;
  noise.reading = reading_sd;
  noise.clock = 1e-3 * run.sample_time;
  noise.clock_memory = run.sample_time;
  const auto nf = static_cast<Index>(dofs.size());
  noise.size.resize(nf);
  noise.memory = VectorXd::Constant(nf, std::max(0.02, 4.0 * run.sample_time));
  noise.white.resize(nf);
  for (Index j = 0; j < nf; ++j) {
    // As large as what makes the usual speed within 20 ms.
    const Index dof = dofs[static_cast<std::size_t>(j)];
    const double gain = tangent.B(machine.plant().nv + dof, dof) / run.sample_time;
    const double most =
        std::max(unit[j], starts.front().usual[dof] / std::max(gain, 1e-300) / 0.02);
    noise.size[j] = most;
    noise.white[j] = 0.1 * most;
  }
  return noise;
}

namespace {

constexpr double kCoarse = 4.2;  // natural logarithm: a factor of 64
constexpr double kMedium = 1.2;
constexpr double kFine = 0.4;

/// A latent force that lasts longer than a fifth of a run is a number that costs
/// nothing: what is constant all the time is for a law to say.
double LongestMemory(const MeasuredRun& run) {
  constexpr double kParts = 5.0;
  return run.sample_time * static_cast<double>(run.samples()) / kParts;
}

/// The most likely noise along a path, from its own on.
FilterNoise Refined(const FilterPath& path, const VectorXd& reading_sd, double longest,
                    double step) {
  const NoiseSearch search(path, reading_sd, longest);
  return search.NoiseOf(search.Descend(path.noise, step, kFine / 3.0).x);
}

/// The same from two starts, its own and a slow one.
FilterNoise RefinedFromBoth(const FilterPath& path, const VectorXd& reading_sd,
                            double longest) {
  const NoiseSearch search(path, reading_sd, longest);
  const Point fast = search.Descend(path.noise, kCoarse, kFine);
  const Point slow = search.Descend(search.Slow(path.noise), kCoarse, kFine);
  return search.NoiseOf(slow.deviance() < fast.deviance() ? slow.x : fast.x);
}

/// Of a filter: those of the machine, its latent forces and the clock.
Index StatesOf(const Machine& machine, const std::vector<Index>& dofs) {
  return TangentSize(machine.plant()) + std::ssize(dofs) + 1;
}

/// Pieces of every record, each a record of its own.
MeasuredRun PiecesOf(const MeasuredRun& run, Index states) {
  std::vector<MeasuredRun> pieces;
  for (std::size_t r = 0; r < run.records.size(); ++r) {
    const Index first = run.records[r].sample;
    for (const Stretch& piece :
         PiecesOf(first, run.SamplesOf(r), run.samples(), run.outputs.rows(), states)) {
      pieces.push_back(Excerpt(run, piece.first, piece.count));
    }
  }
  return Joined(pieces);
}

}  // namespace

FilterPath FilterLikeliest(const Machine& machine, const MeasuredRun& run,
                           const VectorXd& reading_sd) {
  const std::vector<Index> dofs = LatentDofs(machine, run);
  // Pieces tell the noise as well as all of a run.
  const MeasuredRun pieces = PiecesOf(run, StatesOf(machine, dofs));
  const double longest = LongestMemory(run);
  std::vector<FilterStart> starts = FilterStarts(machine, pieces, reading_sd);
  const FilterNoise fast = FollowingNoise(machine, pieces, dofs, starts, reading_sd);
  // A path that was followed fast sticks and slips with its noise: behind a slow filter it
  // says little, so that both are followed by the machine itself.
  // Where one does not stay with the run another one may.
  std::optional<FilterPath> best;
  const auto follow = [&](const FilterNoise& noise) {
    FilterPath path = RunForceFilter(machine, pieces, dofs, starts, noise);
    if (!best || path.deviance < best->deviance) best = path;
    return path;
  };
  const FilterPath first = follow(fast);
  const auto refine = [&](const std::function<FilterNoise()>& begin) {
    try {
      follow(Refined(follow(begin()), reading_sd, longest, kFine));
    } catch (const NumericalError&) {
    }
  };
  refine([&] { return RefinedFromBoth(first, reading_sd, longest); });
  refine([&] {
    const FilterPath slow = follow(NoiseSearch(first, reading_sd, longest).Slow(fast));
    return Refined(slow, reading_sd, longest, kCoarse);
  });
  starts = FilterStarts(machine, run, reading_sd);
  const FilterPath path = [&] {
    try {
      return RunForceFilter(machine, run, dofs, starts, best->noise);
    } catch (const NumericalError&) {
      return RunForceFilter(machine, run, dofs, starts, fast);
    }
  }();
  try {
    FilterPath refined = RunForceFilter(machine, run, dofs, starts,
                                        Refined(path, reading_sd, longest, kMedium));
    if (refined.deviance < path.deviance) return refined;
  } catch (const NumericalError&) {
  }
  return path;
}

FilterPath FilterLikeliestFrom(const Machine& machine, const MeasuredRun& run,
                               const VectorXd& reading_sd,
                               const std::vector<Index>& dofs,
                               const std::vector<FilterNoise>& near) {
  const MeasuredRun pieces = PiecesOf(run, StatesOf(machine, dofs));
  const double longest = LongestMemory(run);
  const std::vector<FilterStart> of_pieces = FilterStarts(machine, pieces, reading_sd);
  std::optional<FilterPath> best;
  const auto follow = [&](const FilterNoise& noise) {
    try {
      FilterPath path = RunForceFilter(machine, pieces, dofs, of_pieces, noise);
      if (!best || path.deviance < best->deviance) best = std::move(path);
    } catch (const NumericalError&) {
    }
  };
  for (const FilterNoise& noise : near) follow(noise);
  // What was near to a machine may be far from another: one that rubs sticks behind the small
  // forces of one that does not.
  follow(FollowingNoise(machine, pieces, dofs, of_pieces, reading_sd));
  if (!best) throw NumericalError("replay: diverged");
  follow(Refined(*best, reading_sd, longest, kCoarse));
  const std::vector<FilterStart> starts = FilterStarts(machine, run, reading_sd);
  FilterPath path = RunForceFilter(machine, run, dofs, starts, best->noise);
  FilterPath refined = RunForceFilter(machine, run, dofs, starts,
                                      Refined(path, reading_sd, longest, kMedium));
  return refined.deviance < path.deviance ? refined : path;
}

FilterPath FilterLikeliestNear(const Machine& machine, const MeasuredRun& run,
                               const VectorXd& reading_sd,
                               const std::vector<Index>& dofs,
                               const FilterNoise& near) {
  const MeasuredRun pieces = PiecesOf(run, StatesOf(machine, dofs));
  const FilterPath path = RunForceFilter(
      machine, pieces, dofs, FilterStarts(machine, pieces, reading_sd), near);
  return RunForceFilter(machine, run, dofs, FilterStarts(machine, run, reading_sd),
                        Refined(path, reading_sd, LongestMemory(run), kMedium));
}

}  // namespace mjdiag
