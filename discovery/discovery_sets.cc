// Sets of causes at first (sets/set_search.h): where they take away most of what the plant
// lacks, they are what the rest of a discovery goes on from.

#include <algorithm>
#include <cmath>
#include <utility>

#include "mjdiag/discovery/discoverer.h"
#include "mjdiag/discovery/selection/model_choice.h"
#include "mjdiag/discovery/sets/set_search.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

/// Of every cause of the best model, itself and what stands in its place in others that
/// have all of the rest.
std::vector<std::vector<Hypothesis>> RivalsIn(const SetSearchResult& found) {
  const std::vector<FittedCause>& causes = found.best.fit.causes;
  std::vector<std::vector<Hypothesis>> rivals;
  for (std::size_t i = 0; i < causes.size(); ++i) {
    std::vector<Hypothesis>& own = rivals.emplace_back();
    own.push_back({causes[i], found.best.score, 0.0});
    const std::vector<FittedCause> rest = Without(causes, {i});
    for (const WeighedModel& other : found.others) {
      if (other.fit.causes.size() != causes.size()) continue;
      const auto is_in_rest = [&](const FittedCause& cause) {
        return Has(rest, cause.candidate);
      };
      if (std::ranges::count_if(other.fit.causes, is_in_rest) != std::ssize(rest)) {
        continue;
      }
      const auto in_place = std::ranges::find_if_not(other.fit.causes, is_in_rest);
      if (in_place->candidate == causes[i].candidate) continue;
      own.push_back({*in_place, other.score, 0.0});
    }
    Rank(own);
  }
  return rivals;
}

/// Whether the causes are what the plant lacks, and not the nearest of the laws that are
/// known: what is left of it beyond noise, on samples that the fit saw and on others, is
/// little, and no law is one of which the fit makes another.
bool Explains(const ObserverLadder& ladder, const std::vector<Candidate>& candidates,
              const SetSearchResult& found) {
  constexpr double kLeft = 0.1;
  const WeighedModel& best = found.best;
  if (best.fit.causes.empty()) return false;
  if (best.deviance - ladder.Noise() >
      kLeft * (found.given.deviance - ladder.Noise())) {
    return false;
  }
  const DiscoveryProblem& problem = ladder[best.rung];
  if (problem.train() < problem.run().samples() &&
      ladder.HeldOut(best.rung, best.fit.residual) >=
          ladder.HeldOut(found.given.rung, found.given.fit.residual)) {
    return false;
  }
  const bool to_the_end = best.rung + 1 == ladder.size();
  return std::ranges::none_of(best.fit.causes, [&](const FittedCause& cause) {
    return IsAtItsEnd(candidates, cause) ||
           (!to_the_end && !IsPlausible(candidates, cause));
  });
}

/// Whether records that no fit saw, if there are any, are less of a surprise with a model
/// than with another.
bool IsBetterUnseen(const EvidenceData& data, const FittedModel& model,
                    const FittedModel& before) {
  if (!data.replay) return true;
  const VectorXd after = data.replay(model);
  const VectorXd without = data.replay(before);
  return after.size() > 0 && without.size() > 0 &&
         after.squaredNorm() < without.squaredNorm();
}

}  // namespace

bool Discoverer::TakeSets(const SearchOptions& search) {
  // An observer of a sensor that is read now and then has no ladder. Of machines that leave
  // their rest the fastest one is the likeliest whatever is found, which tells nothing.
  if (options_.bandwidth != 0.0 || problem_.observer().following ||
      LongestPeriod(problem_.run()) > 1 ||
      !work_->MayBegin("sets of causes", RoundWork(problem_))) {
    return false;
  }
  const bool exact = problem_.numbers().empty();
  const DiscoveryProblem problem =
      exact ? problem_.Doubting({LatenessOf(machine_)}) : problem_;
  FittedModel start;
  start.numbers = search_.fit().numbers;
  if (start.numbers.size() == 0) {
    start.numbers = VectorXd::Zero(static_cast<Eigen::Index>(problem.numbers().size()));
  }
  const ObserverLadder ladder(problem);
  SetSearchOptions options;
  options.most_causes = options_.most_causes;
  // The mismatch that people are told of is the one behind the observer of the problem.
  const DiscoveryProblem to_tell = problem_.Charging(std::make_shared<Work>());
  options.progress = [this, &to_tell](const std::string& what, double fraction,
                                      const CauseFit& best) {
    if (!options_.progress) return;
    CauseFit told;
    told.causes = best.causes;
    const auto size = static_cast<Eigen::Index>(to_tell.numbers().size());
    if (best.numbers.size() == size) told.numbers = best.numbers;
    try {
      told.train =
          MeanSquare(to_tell, to_tell.Residual(ChangesOf(to_tell, candidates_, told)),
                     to_tell.skip(), to_tell.train());
    } catch (const NumericalError&) {
      told.train = nominal_;
    }
    Report(what, fraction, told);
  };
  SetSearchResult found = SearchSets(ladder, candidates_, start, options);
  const WeighedModel& best = found.best;
  TakeSubsteps(found.ladder[0].machine().rates().substeps);
  if (!Explains(found.ladder, candidates_, found)) return false;
  FittedModel model = best.fit;
  FittedModel given = found.given.fit;
  std::vector<DoubtedNumber> numbers = found.ladder[0].numbers();
  constexpr double kSteps = 0.1;  // of what physics steps may be off by
  if (exact && std::abs(model.numbers[0]) < kSteps) {
    numbers.clear();
    model.numbers.resize(0);
    given.numbers.resize(0);
  }
  const bool to_the_end = best.rung + 1 == found.ladder.size();
  DiscoveryProblem deserved =
      (to_the_end ? problem_ : Pose(found.ladder.bandwidth(best.rung)))
          .Doubting(std::move(numbers));
  if (!IsBetterUnseen(DataOf(deserved, candidates_, search.unseen), model, given)) {
    return false;
  }
  problem_ = std::move(deserved);
  MeasureNominal();
  search_.numbers_alone = given.numbers;
  search_.rivals = RivalsIn(found);
  search_.ladder = LadderOf(model);
  CauseFit fit;
  static_cast<FittedModel&>(fit) = std::move(model);
  search_.evidence = search_.evidence.Changed(std::move(fit));
  return found.ended;
}

void Discoverer::TakeSubsteps(int substeps) {
  if (substeps == machine_.rates().substeps) return;
  const double step = problem_.step();
  machine_ = machine_.WithSubsteps(substeps);
  for (auto* records : {&measurements_.fit, &measurements_.unseen}) {
    for (MeasuredRecord& one : *records) {
      one.machine = one.machine.WithSubsteps(substeps);
    }
  }
  std::vector<DoubtedNumber> numbers = InStepsOf(machine_, problem_.numbers());
  problem_ = Pose(options_.bandwidth).Doubting(std::move(numbers));
  MeasureNominal();
  discovery_.notes.push_back("physics steps of " + FormatQuantity(step, "s") +
                             " are too long for what the record tells: all of this is "
                             "said of steps of " +
                             FormatQuantity(problem_.step(), "s") + ", " +
                             std::to_string(substeps) + " a control tick");
}

void Discoverer::FitSets(const SearchOptions& options) {
  Report("last fit", 0.9);
  const EvidenceData data =
      DataOf(problem_, candidates_, options.unseen, options.free_run);
  CauseFit fit;
  try {
    fit = FitCauses(problem_, candidates_, search_.fit(),
                    {.iterations = 8,
                     .tolerance = 1e-8,
                     .first_order = search_.fit().numbers.size() > 1,
                     .share = work_->Share(1)});
  } catch (const CutShort&) {
    work_->CutShort();
    fit = AsItIs(problem_, candidates_, search_.fit());
  }
  VectorXd independent = IndependentShare(problem_, fit.residual);
  search_.evidence = {data, std::move(fit), std::move(independent)};
  search_.significant_rest = true;
}

}  // namespace mjdiag
