// The notes of a discovery: what cannot be judged or told apart, and what it did not
// come to.

#include <algorithm>
#include <string>

#include "mjdiag/discovery/answer/answer_notes.h"
#include "mjdiag/discovery/discoverer.h"
#include "mjdiag/discovery/screening/screening.h"
#include "mjdiag/discovery/selection/completeness.h"
#include "mjdiag/signals/listed.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr const char* kExperiments = "experiments that would tell causes apart";

}  // namespace

void Discoverer::NoteQuietAxes(const ObservedMotion& motion) {
  const std::vector<Index> seen = SeenJoints(problem_.machine().linear());
  for (std::size_t y = 0; y < seen.size(); ++y) {
    constexpr double kMoves = 50.0;  // times the sensor noise
    const VectorXd q = motion.outputs.row(static_cast<Index>(y));
    const double range = q.maxCoeff() - q.minCoeff();
    const std::string& joint =
        problem_.machine().linear().coordinates[static_cast<std::size_t>(seen[y])];
    if (range < kMoves * problem_.observer().noise_sd[static_cast<Index>(y)]) {
      discovery_.notes.push_back(
          NoteOfQuietAxis(machine_.channels().sensors[y].channel, joint));
    }
  }
}

void Discoverer::NoteLateness(double delay) {
  discovery_.notes.push_back(NoteOfLateness(delay, problem_.step()));
}

/// Numbers that are further from what the plant says than anyone expects, with what could
/// stand in the place of each: to first order, the innovations without what it does,
/// regressed on all candidates while it is as the plant says.
void Discoverer::NoteFarNumbers() {
  constexpr double kFar = 3.0;       // standard deviations of what is known beforehand
  constexpr double kExplains = 0.5;  // of what the number does
  const CauseFit& fit = search_.fit();
  if (discovery_.calibration.empty()) return;
  std::shared_ptr<const LinearisedRun> run;  // of all of them
  for (Index i = 0; i < fit.numbers.size(); ++i) {
    const DoubtedNumber& doubted = problem_.numbers()[static_cast<std::size_t>(i)];
    if (doubted.is_lateness || std::abs(fit.numbers[i]) < kFar) continue;
    const std::string name = PlantNumberName(machine_.plant(), doubted.number);
    std::string note =
        name + " is " + FormatNumber(std::exp(doubted.spread * fit.numbers[i]), 3) +
        " times what the plant says, " + FormatNumber(std::abs(fit.numbers[i]), 2) +
        " standard deviations of what was known of it";
    // A last fit of free simulation leaves no derivatives behind the observer.
    if (fit.jacobian.cols() > 0 &&
        work_->MayBegin("what may stand in the place of numbers")) {
      const DiscoveryProblem seen = problem_.TrainPart();
      const Index rows = seen.run().outputs.size();
      const VectorXd done = fit.jacobian.col(i).head(rows) * fit.numbers[i];
      CauseFit without = fit;
      without.numbers[i] = 0.0;
      without.jacobian.col(i).setZero();
      if (!run) run = seen.Linearised(ChangesOf(seen, candidates_, fit));
      const Screening screening =
          Screen(seen, candidates_, seen.MotionOf(run->track), run->dynamics,
                 fit.residual.head(rows) - done, without.jacobian, without, 1);
      const bool explains = !screening.starts.empty() &&
                            screening.starts.front().gain >
                                kExplains * (screening.rest - FittedValues(problem_));
      if (explains) {
        note += "; " + Describe(CauseOf(candidates_, screening.starts.front().cause)) +
                " would explain most of that as well";
      }
    }
    discovery_.notes.push_back(
        note + "; measure it, or say how well it is known (known." + name + ")");
  }
}

void Discoverer::NoteTwins(std::size_t cause) {
  const std::vector<Hypothesis>& rivals = search_.rivals[named_[cause]];
  const FoundCause& found = discovery_.causes[cause];
  for (const Alternative& other : found.alternatives) {
    if (other.indistinguishable) {
      discovery_.notes.push_back(Describe(found.cause) + " and " +
                                 Describe(other.cause) +
                                 " are the same change of the model: no measurement "
                                 "tells them apart");
    }
  }
  constexpr double kCompetes = 0.05;
  const FittedCause& fitted = search_.fit().causes[named_[cause]];
  for (const Hypothesis& other : rivals) {
    if (other.cause.candidate == fitted.candidate || other.probability < kCompetes) {
      continue;
    }
    std::string note = "the record does not tell " + Describe(found.cause) + " from " +
                       Describe(CauseOf(candidates_, other.cause));
    if (!work_->MayBegin(kExperiments)) {
      discovery_.notes.push_back(note);
      continue;
    }
    note += NoteOfExperiment(machine_.WithSensorNoise(problem_.observer().noise_sd),
                             found.cause, CauseOf(candidates_, other.cause));
    discovery_.notes.push_back(note);
  }
}

void Discoverer::NoteIncompleteness() {
  if (IsComplete(discovery_.complete)) return;
  if (std::ranges::none_of(discovery_.causes, &FoundCause::HasName)) return;
  discovery_.notes.push_back(
      "what the causes leave is not the noise of the sensors: they are the nearest of "
      "the laws that are known, and one that is in no list, or was not found, is in "
      "the "
      "machine; their values serve to simulate it, their names are not certain");
}

/// What the search did not come to, and how it does.
void Discoverer::NoteBudget() {
  Budget& budget = discovery_.budget;
  budget = {work_->used(), work_->limit(), work_->IsStopped(), work_->left_out()};
  if (budget.left_out.empty()) return;
  discovery_.notes.push_back(NoteOfBudget(budget, Listed(budget.left_out)));
}

}  // namespace mjdiag
