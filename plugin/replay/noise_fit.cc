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
#include "mjdiag/plugin/replay/noise_search.h"
#include "mjdiag/plugin/replay/recorded_inputs.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

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

/// A latent force that lasts longer than a fifth of a run is a number that costs
/// nothing: what is constant all the time is for a law to say.
double LongestMemory(const MeasuredRun& run) {
  constexpr double kParts = 5.0;
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
  const LikelyNoise fast = search.Descend(path.noise, true);
  const LikelyNoise slow = search.Descend(search.Slow(path.noise), true);
  return slow.deviance < fast.deviance ? slow.noise : fast.noise;
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

/// Of a filter: those of the machine, its latent forces and the clock.
Index StatesOf(const Machine& machine, const std::vector<Index>& dofs) {
  return TangentSize(machine.plant()) + std::ssize(dofs) + 1;
}

/// Pieces of every record, each a record of its own.
MeasuredRun ExcerptOf(const MeasuredRun& run, Index states) {
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
  const MeasuredRun pieces = ExcerptOf(run, StatesOf(machine, dofs));
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
      follow(Refined(follow(begin()), reading_sd, longest, false));
    } catch (const NumericalError&) {
    }
  };
  refine([&] { return RefinedFromBoth(first, reading_sd, longest); });
  refine([&] {
    const FilterPath slow = follow(NoiseSearch(first, reading_sd, longest).Slow(fast));
    return Refined(slow, reading_sd, longest, true);
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
                                        Refined(path, reading_sd, longest, false));
    if (refined.deviance < path.deviance) return refined;
  } catch (const NumericalError&) {
  }
  return path;
}

FilterPath FilterLikeliestFrom(const Machine& machine, const MeasuredRun& run,
                               const VectorXd& reading_sd,
                               const std::vector<Index>& dofs,
                               const std::vector<FilterNoise>& near) {
  const MeasuredRun pieces = ExcerptOf(run, StatesOf(machine, dofs));
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
  // Along its path a linear filter does not stick; the machine may, behind a noise that is so
  // likely: on the way there it goes as far as it gains.
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    const FilterNoise from = best->noise;
    const double before = best->deviance;
    const FilterNoise to = Refined(*best, reading_sd, longest, true);
    double part = 1.0;
    for (; part > 0.2; part *= 0.5) {
      follow(Between(from, to, part));
      if (best->deviance < before) break;
    }
    if (part == 1.0 || part < 0.2) break;
  }
  const std::vector<FilterStart> starts = FilterStarts(machine, run, reading_sd);
  FilterPath path = RunForceFilter(machine, run, dofs, starts, best->noise);
  FilterPath refined = RunForceFilter(machine, run, dofs, starts,
                                      Refined(path, reading_sd, longest, false));
  return refined.deviance < path.deviance ? refined : path;
}

FilterPath FilterLikeliestNear(const Machine& machine, const MeasuredRun& run,
                               const VectorXd& reading_sd,
                               const std::vector<Index>& dofs,
                               const FilterNoise& near) {
  const MeasuredRun pieces = ExcerptOf(run, StatesOf(machine, dofs));
  const FilterPath path = RunForceFilter(
      machine, pieces, dofs, FilterStarts(machine, pieces, reading_sd), near);
  return RunForceFilter(machine, run, dofs, FilterStarts(machine, run, reading_sd),
                        Refined(path, reading_sd, LongestMemory(run), false));
}

}  // namespace mjdiag
