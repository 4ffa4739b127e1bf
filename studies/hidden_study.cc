#include "mjdiag/studies/hidden_study.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "mjdiag/discovery/comparison/mismatch.h"
#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/studies/hidden_effect.h"

namespace mjdiag {
namespace {

constexpr double kBudget = 60.0;  // [s], that of the command

double OfAllSensors(const std::vector<double>& ratios) {
  return Rms(Eigen::VectorXd::Map(ratios.data(), std::ssize(ratios)));
}

/// Of every sensor; one that is infinite where the model cannot be run.
std::vector<double> UnseenMismatch(const Machine& model, const HiddenCase& hidden,
                                   const Changes& changes) {
  std::vector<double> ratios =
      UnseenRatios(model, changes, hidden.unseen, hidden.unseen_clean);
  if (ratios.empty()) ratios = {std::numeric_limits<double>::infinity()};
  return ratios;
}

/// That a cause acts on; -1 of none of the candidates, noise for example.
Eigen::Index JointOfCause(const std::vector<Candidate>& sites, const Cause& cause) {
  const auto found = std::ranges::find_if(sites, [&](const Candidate& site) {
    return SameKind({site.effect, site.site, {}}, cause);
  });
  return found == sites.end() ? -1 : found->joint;
}

}  // namespace

bool HiddenOutcome::IsClaim() const {
  return answer.verdict != DiscoveryVerdict::kNoDiscrepancy;
}

bool HiddenOutcome::IsWrongAbove(double probability) const {
  return verdict == HiddenVerdict::kWrong &&
         std::ranges::any_of(claims, [&](const Claim& claim) {
           return !claim.holds && claim.probability > probability;
         });
}

HiddenOutcome RunHidden(const Machine& model, const HiddenPlan& plan,
                        std::uint64_t seed) {
  using Clock = std::chrono::steady_clock;
  const HiddenCase hidden = DrawHiddenCase(model, plan, seed);
  HiddenOutcome outcome;
  outcome.plan = plan;
  outcome.truth = hidden.truth;
  outcome.fitted = hidden.measurements.fit.size();
  outcome.unseen = hidden.measurements.unseen.size();
  DiscoverOptions options;
  options.figures = false;
  options.doubt = !plan.exact;
  if (!plan.exact) options.budget = kBudget;
  const auto start = Clock::now();
  outcome.answer = Discover(model, hidden.measurements, options);
  outcome.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  const std::vector<FoundCause>& found = outcome.answer.causes;
  outcome.claims = ClaimsOf(hidden.truth, found);
  outcome.kind_claims = ClaimsOf(hidden.truth, outcome.answer.kinds);
  outcome.kinds_are_there = HasKindsOf(hidden.truth, outcome.answer.kinds);
  if (hidden.outside_joint) {
    const std::vector<Candidate> sites = AllSites(model);
    std::vector<Eigen::Index> joints;
    for (const FoundCause& one : found) {
      joints.push_back(JointOfCause(sites, one.cause));
    }
    outcome.outside =
        VerdictOf(*hidden.truth.front().effect, *hidden.outside_joint, found, joints);
  } else {
    outcome.verdict = VerdictOf(hidden.truth, found);
  }
  if (plan.exact) {
    outcome.coverage = CoverageOf(model.plant(), hidden.truth, found);
  }
  outcome.before = OfAllSensors(UnseenMismatch(model, hidden, {}));
  const std::vector<double> after =
      UnseenMismatch(model.WithSubsteps(outcome.answer.substeps), hidden,
                     ChangesOfAnswer(outcome.answer));
  outcome.after = OfAllSensors(after);
  outcome.after_worst = std::ranges::max(after);
  return outcome;
}

}  // namespace mjdiag
