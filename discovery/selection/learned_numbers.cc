#include "mjdiag/discovery/selection/learned_numbers.h"

#include <algorithm>
#include <limits>

#include "mjdiag/plugin/design/number_learner.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Readings and commands of every record that fits see.
std::vector<RunSamples> RunsOf(const DiscoveryProblem& problem) {
  const DiscoveryProblem seen = problem.TrainPart();
  const MeasuredRun& run = seen.run();
  std::vector<RunSamples> runs;
  for (std::size_t i = 0; i < run.records.size(); ++i) {
    const Index first = run.records[i].sample;
    const Index count = run.SamplesOf(i);
    RunSamples& samples = runs.emplace_back();
    samples = {run.outputs.middleCols(first, count),
               run.inputs.middleCols(first, count)};
    if (run.Counted().size() == 0) continue;
    samples.outputs =
        run.Counted()
            .middleCols(first, count)
            .select(samples.outputs.array(), std::numeric_limits<double>::quiet_NaN());
  }
  return runs;
}

VectorXd InTheirDoubts(const LearnedNumbers& learned,
                       const std::vector<DoubtedNumber>& numbers) {
  VectorXd z = VectorXd::Zero(static_cast<Index>(numbers.size()));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i].is_lateness) continue;
    const auto at = std::ranges::find(learned.numbers, numbers[i].number);
    if (at == learned.numbers.end()) continue;
    z[static_cast<Index>(i)] =
        std::clamp(learned.theta[at - learned.numbers.begin()] / numbers[i].spread,
                   numbers[i].Least(), numbers[i].Most());
  }
  return z;
}

}  // namespace

std::optional<CauseFit> LearnedNumbersOf(const DiscoveryProblem& problem,
                                         const std::vector<Candidate>& candidates) {
  // Runs that a pass of the twin with its sensitivities takes as long as, on one of two
  // cores; the least that are worth to begin, and the most that are of use.
  constexpr double kPass = 4.0;
  constexpr double kLeast = 6.0;
  constexpr double kMost = 100.0;
  constexpr double kOfWork = 0.3;
  // A twin knows no open circuits.
  if (problem.numbers().empty() || problem.run().on.size() > 0) return std::nullopt;
  Work& work = *problem.work();
  const double pass = kPass * problem.RunWork();
  const double most = std::min(kMost, kOfWork * work.Share(1) / pass);
  if (most < kLeast) return std::nullopt;
  const auto learned = LearnNumbers(
      problem.machine(), problem.observer().noise_sd, RunsOf(problem),
      {.faults = false, .doubt = true, .unmeasured = true}, static_cast<int>(most));
  if (!learned) return std::nullopt;
  work.Add(pass * learned->passes);
  const FitOptions as_is{.iterations = 0, .jacobian = false};
  const auto given = TryFit(problem, candidates, {}, as_is);
  auto fit = TryFit(problem, candidates,
                    {{}, InTheirDoubts(*learned, problem.numbers())}, as_is);
  const auto cost = [&](const CauseFit& one) {
    return FittedValues(problem) * one.train + one.prior;
  };
  if (!fit || (given && cost(*given) <= cost(*fit))) return std::nullopt;
  return fit;
}

}  // namespace mjdiag
