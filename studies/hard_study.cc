#include "mjdiag/studies/hard_study.h"

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

/// Of all sensors; infinite where the model cannot be run.
double UnseenMismatch(const Machine& model, const HardCase& hard,
                      const Changes& changes) {
  const std::vector<double> ratios =
      UnseenRatios(model, changes, hard.unseen, hard.unseen_clean);
  if (ratios.empty()) return std::numeric_limits<double>::infinity();
  return Rms(Eigen::VectorXd::Map(ratios.data(), std::ssize(ratios)));
}

/// That a cause acts on; -1 of none of the candidates, noise for example.
Eigen::Index JointOfCause(const std::vector<Candidate>& sites, const Cause& cause) {
  const auto found = std::ranges::find_if(sites, [&](const Candidate& site) {
    return SameKind({site.effect, site.site, {}}, cause);
  });
  return found == sites.end() ? -1 : found->joint;
}

}  // namespace

bool HardOutcome::IsClaim() const {
  return answer.verdict != DiscoveryVerdict::kNoDiscrepancy;
}

bool HardOutcome::IsWrongAbove(double probability) const {
  return verdict == HardVerdict::kWrong &&
         std::ranges::any_of(claims, [&](const Claim& claim) {
           return !claim.holds && claim.probability > probability;
         });
}

HardOutcome RunHard(const Machine& model, const HardPlan& plan, std::uint64_t seed) {
  using Clock = std::chrono::steady_clock;
  const HardCase hard = DrawHardCase(model, plan, seed);
  HardOutcome outcome;
  outcome.plan = plan;
  outcome.truth = hard.truth;
  outcome.fitted = hard.measurements.fit.size();
  outcome.unseen = hard.measurements.unseen.size();
  DiscoverOptions options;
  options.figures = false;
  options.doubt = true;
  options.budget = kBudget;
  const auto start = Clock::now();
  outcome.answer = Discover(model, hard.measurements, options);
  outcome.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  const std::vector<FoundCause>& found = outcome.answer.causes;
  outcome.claims = ClaimsOf(hard.truth, found);
  outcome.kind_claims = ClaimsOf(hard.truth, outcome.answer.kinds);
  outcome.kinds_are_there = HasKindsOf(hard.truth, outcome.answer.kinds);
  if (hard.outside_joint) {
    const std::vector<Candidate> sites = AllSites(model);
    std::vector<Eigen::Index> joints;
    for (const FoundCause& one : found) {
      joints.push_back(JointOfCause(sites, one.cause));
    }
    outcome.outside =
        VerdictOf(*hard.truth.front().effect, *hard.outside_joint, found, joints);
  } else {
    outcome.verdict = VerdictOf(hard.truth, found);
  }
  outcome.before = UnseenMismatch(model, hard, {});
  outcome.after = UnseenMismatch(model.WithSubsteps(outcome.answer.substeps), hard,
                                 ChangesOfAnswer(outcome.answer));
  return outcome;
}

}  // namespace mjdiag
