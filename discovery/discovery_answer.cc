// The answer of a discovery: causes and numbers with what is known of them, and the
// verdict.

#include <algorithm>
#include <cmath>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/discovery/discoverer.h"
#include "mjdiag/discovery/fitting/parameter_covariance.h"
#include "mjdiag/discovery/fitting/profile_interval.h"
#include "mjdiag/discovery/hypotheses/mass_moments.h"
#include "mjdiag/discovery/selection/completeness.h"
#include "mjdiag/discovery/selection/verdict.h"
#include "mjdiag/discovery/unexplained/active_curve.h"
#include "mjdiag/discovery/unexplained/sensor_noise.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/plant/scale_number.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kLeastProbability = 0.01;
constexpr double kMostOfIt = 0.5;

}  // namespace

std::vector<CauseParameter> Discoverer::DescribeParameters(
    const FittedCause& fitted, const MatrixXd& covariance,
    const std::vector<Interval>& intervals, Index first) const {
  const Candidate& candidate = candidates_[fitted.candidate];
  std::vector<CauseParameter> parameters;
  for (std::size_t i = 0; i < candidate.parameters.size(); ++i) {
    const auto index = static_cast<Index>(i);
    const Interval& interval = intervals[static_cast<std::size_t>(first) + i];
    const double sd = std::sqrt(covariance(first + index, first + index));
    const EffectParameter& parameter =
        candidate.effect
            ->parameters()[static_cast<std::size_t>(candidate.chosen.size()) + i];
    parameters.push_back(
        {parameter.name,
         SiteUnit(machine_.plant(), *candidate.effect, candidate.site, parameter),
         fitted.value[index], sd, interval.min, interval.max});
  }
  return parameters;
}

std::vector<Alternative> Discoverer::AlternativesOf(
    const FittedCause& fitted, const std::vector<Hypothesis>& rivals) const {
  std::vector<Alternative> alternatives;
  for (const Hypothesis& other : rivals) {
    if (other.cause.candidate == fitted.candidate) continue;
    if (other.probability < kLeastProbability) continue;
    alternatives.push_back(
        {CauseOf(candidates_, other.cause), other.probability, false});
  }
  return alternatives;
}

bool Discoverer::IsActive(const FittedCause& curve, const FoundCause& found) const {
  const auto knots = static_cast<Index>(found.parameters.size());
  VectorXd low(knots);
  VectorXd high(knots);
  Index i = 0;
  for (const CauseParameter& knot : found.parameters) {
    low[i] = knot.low;
    high[i++] = knot.high;
  }
  return DrivesItsJoint(machine_.plant(), candidates_[curve.candidate].joint,
                        found.cause.values, low, high);
}

void Discoverer::NameCauses() {
  if (LastFit().jacobian.cols() == 0) return;
  MatrixXd covariance;
  std::vector<Interval> intervals;
  while (!LastFit().causes.empty()) {
    const Index parameters = Flatten(LastFit().causes).size();
    covariance = ParameterCovariance(LastProblem(), candidates_, LastFit())
                     .bottomRightCorner(parameters, parameters);
    Report("intervals", 0.7);
    intervals = ParameterIntervals(LastProblem(), candidates_, LastFit(), covariance);
    // Followed along its profile a law may turn out to be nothing, too.
    const auto empty = EmptyCause(intervals);
    if (!empty) break;
    TryToLeaveOut(*empty);
  }
  const CauseFit& fit = LastFit();
  if (fit.jacobian.cols() == 0) return;
  const Index numbers = fit.numbers.size();
  NameNumbers(ParameterCovariance(LastProblem(), candidates_, fit)
                  .topLeftCorner(numbers, numbers));
  Index next = 0;
  for (std::size_t i = 0; i < fit.causes.size(); ++i) {
    const Index first = next;
    next += fit.causes[i].value.size();
    if (IsOfSteps(fit.causes[i])) {
      NoteLateness(fit.causes[i].value[0]);
      continue;
    }
    FoundCause found;
    found.cause = CauseOf(candidates_, fit.causes[i]);
    found.parameters = DescribeParameters(fit.causes[i], covariance, intervals, first);
    found.probability = 1.0;
    if (const auto words = curves_.find(fit.causes[i].candidate);
        words != curves_.end()) {
      found.unnamed = words->second.words;
      if (IsActive(fit.causes[i], found)) found.unnamed += ", an active force";
    }
    for (const Hypothesis& rival : search_.rivals[i]) {
      if (rival.cause.candidate == fit.causes[i].candidate) {
        found.probability = rival.probability;
      }
    }
    found.alternatives = AlternativesOf(fit.causes[i], search_.rivals[i]);
    for (const Cause& twin : Twins(machine_.plant(), found.cause)) {
      found.alternatives.insert(found.alternatives.begin(),
                                {twin, found.probability, true});
    }
    if (found.HasName()) {
      found.probability = AmongAllLaws(found.probability, discovery_.complete);
      for (Alternative& other : found.alternatives) {
        other.probability = AmongAllLaws(other.probability, discovery_.complete);
      }
    }
    discovery_.causes.push_back(std::move(found));
    named_.push_back(i);
  }
}

bool Discoverer::IsOfSteps(const FittedCause& fitted) const {
  constexpr double kHalf = 0.5 * (1.0 + 1e-3);  // of a step, and of rounding
  const Candidate& candidate = candidates_[fitted.candidate];
  return candidate.effect->name() == InputDelay().name() &&
         fitted.value[0] <= kHalf * problem_.step();
}

void Discoverer::NameNumbers(const MatrixXd& covariance) {
  const double normal = TwoSidedNormalQuantile(0.05);
  const VectorXd& z = search_.fit().numbers;
  const std::vector<bool> stood_for =
      problem_.StoodFor(ChangesOf(candidates_, search_.fit().causes));
  for (Index i = 0; i < z.size(); ++i) {
    if (stood_for[static_cast<std::size_t>(i)]) continue;
    const DoubtedNumber& doubted = problem_.numbers()[static_cast<std::size_t>(i)];
    const double half = normal * std::sqrt(covariance(i, i));
    if (doubted.is_lateness) {
      if (z[i] > half) NoteLateness(doubted.spread * z[i]);
      continue;
    }
    discovery_.calibration.push_back(
        {PlantNumberName(machine_.plant(), doubted.number), doubted.number,
         std::exp(doubted.spread * z[i]), std::exp(doubted.spread * (z[i] - half)),
         std::exp(doubted.spread * (z[i] + half)), doubted.spread,
         IsAdditive(doubted.number.kind) ? UnitOf(machine_.plant(), doubted.number)
                                         : 0.0,
         UnitName(machine_.plant(), doubted.number)});
  }
  NameMoments(covariance);
}

/// What is known of masses and centres together, which single numbers share. Only where
/// centres are in doubt: else the masses say it.
void Discoverer::NameMoments(const MatrixXd& covariance) {
  const auto& numbers = problem_.numbers();
  if (std::ranges::none_of(numbers, [](const DoubtedNumber& doubted) {
        return !doubted.is_lateness && IsCentre(doubted.number.kind);
      })) {
    return;
  }
  const VectorXd& z = search_.fit().numbers;
  const auto moments_at = [&](const VectorXd& at) {
    const Machine machine = machine_.With(problem_.WithNumbers({}, at));
    return MassMoments(machine.plant());
  };
  const std::vector<MassMoment> model = MassMoments(machine_.plant());
  const std::vector<MassMoment> found = moments_at(z);
  constexpr double kStep = 1e-4;
  MatrixXd slopes = MatrixXd::Zero(std::ssize(found), z.size());
  for (Index i = 0; i < z.size(); ++i) {
    if (numbers[static_cast<std::size_t>(i)].is_lateness) continue;
    VectorXd moved = z;
    moved[i] += kStep;
    const std::vector<MassMoment> more = moments_at(moved);
    for (std::size_t m = 0; m < found.size(); ++m) {
      slopes(static_cast<Index>(m), i) = (more[m].value - found[m].value) / kStep;
    }
  }
  const double normal = TwoSidedNormalQuantile(0.05);
  for (std::size_t m = 0; m < found.size(); ++m) {
    const VectorXd slope = slopes.row(static_cast<Index>(m));
    const double half =
        normal * std::sqrt(std::max(0.0, slope.dot(covariance * slope)));
    discovery_.moments.push_back({found[m].joint, found[m].axis, model[m].value,
                                  found[m].value, found[m].value - half,
                                  found[m].value + half, slope.norm()});
  }
}

// White noise beyond what the setup says of a sensor. Sensors of which it says nothing
// cannot be judged.
void Discoverer::AddNoiseCauses(const MatrixXd& innovations) {
  for (const RaisedNoise& raised :
       FindRaisedNoise(machine_.setup(), problem_.observer(), innovations,
                       discovery_.train_share, problem_.run().Counted())) {
    const Effect& noise = NoiseEffect();
    const Candidate candidate{
        .effect = Lasting(noise), .site = raised.element, .parameters = {}};
    if (!IsChosen(candidate, options_.choice)) continue;
    FoundCause found;
    found.cause = {Lasting(noise), raised.element, ValuesOf({raised.sd})};
    const double half = TwoSidedNormalQuantile(0.05) * raised.sd_error;
    found.parameters = {{noise.parameters().front().name, raised.unit, raised.sd,
                         raised.sd_error, raised.sd - half, raised.sd + half}};
    found.probability = AmongAllLaws(1.0, discovery_.complete);
    discovery_.causes.push_back(std::move(found));
  }
}

void Discoverer::Judge() {
  for (const FittedCause& refuted : search_.refuted) {
    discovery_.notes.push_back("not named, for data outside the fit contradict it: " +
                               Describe(CauseOf(candidates_, refuted)));
  }
  const bool named = !discovery_.causes.empty();
  const auto& causes = LastFit().causes;
  const bool only_steps =
      !causes.empty() && std::ranges::all_of(causes, [this](const FittedCause& cause) {
        return IsOfSteps(cause);
      });
  discovery_.verdict =
      only_steps && !IsMoreLeft(search_)
          ? DiscoveryVerdict::kNoDiscrepancy
          : VerdictOf(search_, named, nominal_, IsComplete(discovery_.complete));
  // Along the motion the causes were judged by the balance of forces, and by parts of it
  // that were predicted.
  if (force_ && named && discovery_.verdict == DiscoveryVerdict::kUnexplained &&
      force_->ExplainedUnseen() >= kMostOfIt) {
    discovery_.verdict = DiscoveryVerdict::kPartlyExplained;
  }
  const bool all_named = std::ranges::all_of(discovery_.causes, &FoundCause::HasName);
  if (!all_named && discovery_.verdict == DiscoveryVerdict::kExplained) {
    discovery_.verdict = DiscoveryVerdict::kPartlyExplained;
  }
  if (named && discovery_.verdict == DiscoveryVerdict::kUnexplained) {
    std::string tried;
    for (const FoundCause& cause : discovery_.causes) {
      tried += (tried.empty() ? "" : ", ") + Describe(cause.cause);
    }
    discovery_.notes.push_back("not named, for too much of the mismatch is left: " +
                               tried);
    discovery_.causes.clear();
    discovery_.calibration.clear();
    named_.clear();
  }
  changes_ = ChangesOf(discovery_);
  // What the steps are off by is no cause, but the figures are those of the causes.
  for (const FittedCause& cause : causes) {
    if (!IsOfSteps(cause)) continue;
    const Changes late = mjdiag::ChangesOf({CauseOf(candidates_, cause)});
    changes_.effects.insert(changes_.effects.end(), late.effects.begin(),
                            late.effects.end());
  }
}

}  // namespace mjdiag
