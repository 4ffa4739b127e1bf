#include "mjdiag/plugin/replay/noise_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "mjdiag/plugin/machine/tick_differences.h"
#include "mjdiag/plugin/machine/tick_map.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/tangent_coordinates.h"
#include "mjdiag/plugin/replay/noise_search.h"
#include "mjdiag/plugin/replay/recorded_inputs.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MeasuredRun PiecesOfRun(const Machine& machine, const MeasuredRun& run,
                        const std::vector<Index>& dofs, double least) {
  const Index states = TangentSize(machine.plant()) + std::ssize(dofs) + 1;
  const auto share = static_cast<Index>(least * static_cast<double>(run.samples()));
  const Index enough = std::max(share, EnoughOf(run.outputs.rows(), states));
  std::vector<MeasuredRun> pieces;
  for (std::size_t r = 0; r < run.records.size(); ++r) {
    const Index first = run.records[r].sample;
    for (const Stretch& piece :
         PiecesOf(first, run.SamplesOf(r), run.samples(), enough)) {
      pieces.push_back(Excerpt(run, piece.first, piece.count));
    }
  }
  return Joined(pieces);
}

FilterNoise FollowingNoise(const Machine& machine, const MeasuredRun& run,
                           const std::vector<Index>& dofs,
                           const std::vector<FilterStart>& starts,
                           const VectorXd& reading_sd) {
  TickMap map(machine);
  RecordedInputs inputs(machine, run);
  const VectorXd none = VectorXd::Zero(machine.plant().nv);
  inputs.StayAt(run.records.front().sample);
  const PlantState start = map.Begun(starts.front().state);
  map.Run(start, none, 0, inputs);
  const TickTangent tangent =
      TickDifferences(map, run.sample_time, dofs).Of(start, none, 0, inputs);
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

/// A latent force that lasts longer than a twentieth of a run, a fold of the regression, is a
/// number that costs nothing: what is constant all the time is for a law to say.
double LongestMemory(const MeasuredRun& run) {
  constexpr double kParts = 20.0;
  return run.sample_time * static_cast<double>(run.samples()) / kParts;
}

/// The most likely noise along a path, from its own on.
FilterNoise Refined(const FilterPath& path, const VectorXd& reading_sd, double longest,
                    bool is_far) {
  const NoiseSearch search(path, reading_sd, longest);
  return search.Descend(path.noise, is_far).noise;
}

/// The same from two starts, its own and a slow one.
FilterNoise RefinedFromBoth(const FilterPath& path, const VectorXd& reading_sd,
                            double longest) {
  const NoiseSearch search(path, reading_sd, longest);
  const std::array<FilterNoise, 2> starts{path.noise, search.Slow(path.noise)};
  std::array<LikelyNoise, 2> likely;
  ParallelForAll(2, [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    likely[i] = search.Descend(starts[i], true);
  });
  return likely[1].deviance < likely[0].deviance ? likely[1].noise : likely[0].noise;
}

/// Logarithms a part of the way from one to another.
FilterNoise Between(const FilterNoise& from, const FilterNoise& to, double part) {
  const auto mean = [part](const VectorXd& a, const VectorXd& b) -> VectorXd {
    return a.array().pow(1.0 - part) * b.array().pow(part);
  };
  return {mean(from.reading, to.reading),
          std::pow(from.clock, 1.0 - part) * std::pow(to.clock, part),
          std::pow(from.clock_memory, 1.0 - part) * std::pow(to.clock_memory, part),
          mean(from.size, to.size),
          mean(from.memory, to.memory),
          mean(from.white, to.white)};
}

/// Follows a machine along a run behind one noise after the other, and keeps the likeliest.
class LikeliestOf {
 public:
  LikeliestOf(const Machine& machine, const MeasuredRun& run,
              const VectorXd& reading_sd, const std::vector<Index>& dofs,
              double longest, const IsTimeOver& is_over, Index readings = kMostReadings)
      : machine_(machine),
        run_(run),
        reading_sd_(reading_sd),
        dofs_(dofs),
        longest_(longest),
        is_over_(is_over),
        readings_(readings),
        starts_(FilterStarts(machine, run, reading_sd)) {}

  const std::vector<FilterStart>& starts() const { return starts_; }
  const FilterPath& best() const {
    if (!best_) throw NumericalError("replay: diverged");
    return *best_;
  }

  void Keep(FilterPath path) {
    if (!best_ || path.deviance < best_->deviance) best_ = std::move(path);
  }

  /// Where one does not stay with the run another one may.
  std::optional<FilterPath> Follow(const FilterNoise& noise) {
    try {
      FilterPath path = RunForceFilter(machine_, run_, dofs_, starts_, noise);
      Keep(path);
      return path;
    } catch (const NumericalError&) {
      return std::nullopt;
    }
  }

  /// Along its path a linear filter does not stick; the machine may, behind a noise that is
  /// so likely, and its path is another one then: on the way there it goes as far as it
  /// gains, and asks the path that it has then, until nothing is gained.
  /// @param is_far  whether to begin by coarse steps
  void Improve(bool is_far) {
    constexpr int kRounds = 4;
    constexpr double kGain = 2.0;  // less is noise of the search
    for (int round = 0; round < kRounds && !IsOver(); ++round) {
      const FilterNoise from = best().noise;
      const double before = best().deviance;
      const NoiseSearch search(best(), reading_sd_, longest_, readings_);
      const bool is_of_all = search.LooksAtAll();
      const LikelyNoise to = search.Descend(from, is_far);
      // On the way to what is hardly likelier nothing is, either.
      const double shortest = to.gain < kGain ? 1.0 : 0.25;
      for (double part = 1.0; part >= shortest; part *= 0.5) {
        Follow(Between(from, to.noise, part));
        if (best().deviance < before) break;
      }
      // The path is the one along which the noise is likeliest.
      if (is_of_all && std::abs(before - to.gain - best().deviance) < kGain) break;
      if (best().deviance < before - kGain) continue;
      if (!is_far) break;
      is_far = false;
    }
  }

 private:
  bool IsOver() const { return is_over_ && is_over_(); }

  const Machine& machine_;
  const MeasuredRun& run_;
  const VectorXd& reading_sd_;
  const std::vector<Index>& dofs_;
  double longest_;
  const IsTimeOver& is_over_;
  Index readings_;
  std::vector<FilterStart> starts_;
  std::optional<FilterPath> best_;
};

/// Of all of a run, from the noise that is likeliest by pieces of it on.
FilterPath OfAll(const Machine& machine, const MeasuredRun& run,
                 const VectorXd& reading_sd, const std::vector<Index>& dofs,
                 const LikeliestOf& of_pieces, const FilterNoise& otherwise,
                 const IsTimeOver& is_over, NoiseBy by) {
  if (of_pieces.best().samples() == run.samples()) return of_pieces.best();
  LikeliestOf all(machine, run, reading_sd, dofs, LongestMemory(run), is_over);
  if (!all.Follow(of_pieces.best().noise)) all.Follow(otherwise);
  if (by == NoiseBy::kAllOfRun) all.Improve(false);
  return all.best();
}

}  // namespace

FilterPath FilterLikeliest(const Machine& machine, const MeasuredRun& run,
                           const VectorXd& reading_sd, const IsTimeOver& is_over) {
  const std::vector<Index> dofs = LatentDofs(machine, run);
  // Pieces tell the noise as well as all of a run.
  const MeasuredRun pieces = PiecesOfRun(machine, run, dofs);
  const double longest = LongestMemory(run);
  LikeliestOf of_pieces(machine, pieces, reading_sd, dofs, longest, is_over);
  const FilterNoise fast =
      FollowingNoise(machine, pieces, dofs, of_pieces.starts(), reading_sd);
  of_pieces.Follow(fast);
  const FilterPath first = of_pieces.best();
  // A path that was followed fast sticks and slips with its noise: behind a slow filter it
  // says little, so that both are followed by the machine itself.
  of_pieces.Follow(RefinedFromBoth(first, reading_sd, longest));
  const FilterNoise slow = NoiseSearch(first, reading_sd, longest).Slow(fast);
  // What is missing may also be white and slow: blows, and what lasts.
  FilterNoise rough = slow;
  rough.white = fast.white;
  std::vector<FilterPath> paths;
  for (const FilterNoise& start : {slow, rough}) {
    if (is_over && is_over()) break;
    if (auto path = of_pieces.Follow(start)) paths.push_back(std::move(*path));
  }
  std::vector<FilterNoise> refined(paths.size());
  ParallelForAll(static_cast<int>(paths.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    refined[i] = Refined(paths[i], reading_sd, longest, true);
  });
  for (const FilterNoise& noise : refined) of_pieces.Follow(noise);
  of_pieces.Improve(true);
  return OfAll(machine, run, reading_sd, dofs, of_pieces, fast, is_over,
               NoiseBy::kAllOfRun);
}

FilterPath FilterLikeliestFrom(const Machine& machine, const MeasuredRun& run,
                               const VectorXd& reading_sd,
                               const std::vector<Index>& dofs,
                               const std::vector<FilterNoise>& near,
                               const IsTimeOver& is_over, NoiseBy by) {
  const MeasuredRun pieces = PiecesOfRun(machine, run, dofs);
  LikeliestOf of_pieces(machine, pieces, reading_sd, dofs, LongestMemory(run), is_over);
  for (const FilterNoise& noise : near) of_pieces.Follow(noise);
  // What was near to a machine may be far from another: one that rubs sticks behind the small
  // forces of one that does not.
  of_pieces.Follow(
      FollowingNoise(machine, pieces, dofs, of_pieces.starts(), reading_sd));
  of_pieces.Improve(true);
  return OfAll(machine, run, reading_sd, dofs, of_pieces, near.back(), is_over, by);
}

FilterPath FilterLikelier(const Machine& machine, const MeasuredRun& run,
                          const VectorXd& reading_sd, FilterPath path,
                          const IsTimeOver& is_over, Index readings) {
  const std::vector<Index> dofs = path.dofs;
  LikeliestOf all(machine, run, reading_sd, dofs, LongestMemory(run), is_over,
                  readings);
  all.Keep(std::move(path));
  all.Improve(false);
  return all.best();
}

FilterPath FilterLikeliestNear(const Machine& machine, const MeasuredRun& run,
                               const VectorXd& reading_sd,
                               const std::vector<Index>& dofs, const FilterNoise& near,
                               const IsTimeOver& is_over) {
  const std::vector<FilterStart> starts = FilterStarts(machine, run, reading_sd);
  return FilterLikelier(machine, run, reading_sd,
                        RunForceFilter(machine, run, dofs, starts, near), is_over);
}

}  // namespace mjdiag
