#include "mjdiag/discovery/sets/set_search.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "mjdiag/discovery/fitting/nested_law.h"
#include "mjdiag/discovery/fitting/scale_gauge.h"
#include "mjdiag/discovery/sets/set_regression.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// A better score than that is no chance: odds of 400.
constexpr double kBetter = 12.0;
// Of what a model lacks, in -2 ln L beyond that of noise, that is worth a name. White noise
// is no true model of what lasts; what is small beside it may be its colour. A model that
// deserves the fastest observer still is one of a machine that no list explains, where
// there are always laws that take a little more: there it is of what the plant as given
// lacked.
constexpr double kWorth = 0.02;

/// Those that there are, the likeliest first.
std::vector<WeighedModel> InOrder(std::vector<std::optional<WeighedModel>> models) {
  std::vector<WeighedModel> all;
  for (auto& one : models) {
    if (one) all.push_back(std::move(*one));
  }
  std::ranges::stable_sort(all, std::less<>(), &WeighedModel::score);
  return all;
}

class Search {
 public:
  Search(const ObserverLadder& ladder, const std::vector<Candidate>& candidates,
         const SetSearchOptions& options)
      : ladder_(ladder),
        candidates_(candidates),
        options_(options),
        given_substeps_(ladder[0].machine().rates().substeps) {}

  SetSearchResult Run(const FittedModel& start);

 private:
  Work& work() const { return *ladder_[0].work(); }
  void Report(const std::string& what, double fraction, const CauseFit& best) const {
    if (options_.progress) options_.progress(what, fraction, best);
  }
  double Score(std::size_t rung, const FittedModel& model, double deviance) const;
  std::optional<double> DevianceOf(std::size_t rung, const FittedModel& model) const;
  WeighedModel Weighed(std::size_t rung, CauseFit fit) const;
  std::optional<WeighedModel> Fitted(std::size_t rung, const FittedModel& model,
                                     int iterations, double share) const;
  std::optional<WeighedModel> Settled(FittedModel model, std::size_t rung,
                                      double share) const;
  std::vector<WeighedModel> BestSettled(const std::vector<FittedModel>& models,
                                        std::size_t rung) const;
  std::vector<WeighedModel> AllSettled(const std::vector<FittedModel>& models,
                                       std::size_t rung) const;
  WeighedModel Begin(const FittedModel& start) const;
  bool IsNeeded(const WeighedModel& of, std::size_t cause) const;
  WeighedModel WithoutSuperfluous(WeighedModel model) const;
  WeighedModel WithSimplerLaws(WeighedModel model) const;
  bool IsWorth(const WeighedModel& after, const WeighedModel& before,
               double given) const;
  bool TakeFinerSteps(WeighedModel& best);

  ObserverLadder ladder_;
  const std::vector<Candidate>& candidates_;
  const SetSearchOptions& options_;
  int given_substeps_;
};

double Search::Score(std::size_t rung, const FittedModel& model,
                     double deviance) const {
  const double ticks = FittedValues(ladder_[rung]) /
                       static_cast<double>(ladder_[rung].run().outputs.rows());
  return deviance + PriorOf(candidates_, model) +
         ParameterCount(model.causes) * std::log(ticks);
}

/// None where it cannot be run.
std::optional<double> Search::DevianceOf(std::size_t rung,
                                         const FittedModel& model) const {
  const DiscoveryProblem seen = ladder_[rung].TrainPart();
  try {
    return ladder_.Deviance(rung, seen.Residual(ChangesOf(seen, candidates_, model)));
  } catch (const NumericalError&) {
    return std::nullopt;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

WeighedModel Search::Weighed(std::size_t rung, CauseFit fit) const {
  const double deviance = ladder_.Deviance(rung, fit.residual);
  const double score = Score(rung, fit, deviance);
  return {std::move(fit), rung, deviance, score};
}

std::optional<WeighedModel> Search::Fitted(std::size_t rung, const FittedModel& model,
                                           int iterations, double share) const {
  auto fit = TryFit(ladder_[rung], candidates_, model,
                    {.iterations = iterations,
                     .tolerance = 1e-5,
                     .jacobian = false,
                     .secant = model.numbers.size() <= 1,
                     .first_order = model.numbers.size() > 1,
                     .share = share,
                     .only_betters = true});
  if (!fit) return std::nullopt;
  return Weighed(rung, std::move(*fit));
}

/// Fitted behind that observer and then behind slower ones, as long as they make the record
/// likelier, with so much work [s].
std::optional<WeighedModel> Search::Settled(FittedModel model, std::size_t rung,
                                            double share) const {
  constexpr int kFirst = 2;
  constexpr int kMore = 4;
  std::optional<WeighedModel> best;
  const auto fit = [&](const FittedModel& start, int iterations) {
    auto one = Fitted(rung, start, iterations, share);
    if (one) share -= one->fit.spent;
    return one;
  };
  while (rung < ladder_.size()) {
    auto fitted = fit(model, kFirst);
    if (!fitted || (best && fitted->score >= best->score)) break;
    const auto goes_on = [&](const WeighedModel& at) {
      if (rung + 1 == ladder_.size()) return false;
      const auto next = DevianceOf(rung + 1, at.fit);
      return next && *next < at.deviance;
    };
    bool slower = goes_on(*fitted);
    if (!slower) {
      auto more = fit(fitted->fit, kMore);
      if (more && more->score < fitted->score) fitted = std::move(more);
      slower = goes_on(*fitted);
    }
    best = std::move(fitted);
    if (!slower) break;
    model = best->fit;
    ++rung;
  }
  return best;
}

/// The likeliest of the models behind that observer, each as it settles.
std::vector<WeighedModel> Search::BestSettled(const std::vector<FittedModel>& models,
                                              std::size_t rung) const {
  constexpr int kFirst = 3;
  constexpr std::size_t kFinalists = 3;
  std::vector<std::optional<WeighedModel>> fitted(models.size());
  const double share = work().Share(static_cast<int>(models.size()));
  ParallelFor(static_cast<int>(models.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    fitted[i] = Fitted(rung, models[i], kFirst, share);
  });
  std::vector<FittedModel> finalists;
  for (const WeighedModel& one : InOrder(std::move(fitted))) {
    if (finalists.size() < kFinalists) finalists.push_back(one.fit);
  }
  return AllSettled(finalists, rung);
}

std::vector<WeighedModel> Search::AllSettled(const std::vector<FittedModel>& models,
                                             std::size_t rung) const {
  std::vector<std::optional<WeighedModel>> settled(models.size());
  const double share = work().Share(static_cast<int>(models.size()));
  ParallelFor(static_cast<int>(models.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    settled[i] = Settled(models[i], rung, share);
  });
  return InOrder(std::move(settled));
}

/// The plant as it is given, or with its numbers fitted.
WeighedModel Search::Begin(const FittedModel& start) const {
  std::vector<std::optional<double>> deviances(ladder_.size());
  ParallelFor(static_cast<int>(ladder_.size()), [&](int number) {
    const auto rung = static_cast<std::size_t>(number);
    deviances[rung] = DevianceOf(rung, start);
  });
  std::size_t best = 0;
  for (std::size_t rung = 0; rung < ladder_.size(); ++rung) {
    if (deviances[rung] && (!deviances[best] || *deviances[rung] < *deviances[best])) {
      best = rung;
    }
  }
  if (auto settled = Settled(start, best, work().Share(1))) return std::move(*settled);
  return Weighed(best, AsItIs(ladder_[best], candidates_, start));
}

/// Whether the record is much less likely without it, by a run without it and what the
/// others can make good to first order.
bool Search::IsNeeded(const WeighedModel& of, std::size_t cause) const {
  constexpr double kMuch = 100.0;
  constexpr double kOff = 0.01;  // of what is made good, the first order may be off by
  const MatrixXd J = JacobianWithout(of.fit, {cause});
  const DiscoveryProblem seen = ladder_[of.rung].TrainPart();
  // The number that it stands for has no derivative beside it.
  if (seen.StoodFor(ChangesOf(candidates_, of.fit.causes)) !=
      seen.StoodFor(ChangesOf(candidates_, ModelWithout(of.fit, {cause}).causes))) {
    return false;
  }
  VectorXd left;
  try {
    left = seen.Residual(ChangesOf(seen, candidates_, ModelWithout(of.fit, {cause})));
  } catch (const NumericalError&) {
    return true;
  }
  const Index first = seen.run().outputs.rows() * seen.skip();
  left = left.tail(left.size() - first).eval();
  const double as_it_is = left.squaredNorm();
  if (J.cols() > 0) {
    const MatrixXd Q = OrthonormalColumns(J.bottomRows(left.size()));
    left -= Q * (Q.transpose() * left);
  }
  const VectorXd now = of.fit.residual.segment(first, left.size());
  return left.squaredNorm() - kOff * (as_it_is - left.squaredNorm()) >
         now.squaredNorm() + kMuch;
}

WeighedModel Search::WithoutSuperfluous(WeighedModel model) const {
  while (!model.fit.causes.empty() &&
         work().MayBegin("whether every cause is needed")) {
    std::vector<FittedModel> without;
    for (std::size_t i = 0; i < model.fit.causes.size(); ++i) {
      if (IsNeeded(model, i)) continue;
      without.push_back(HandedOver(ladder_[model.rung], candidates_, model.fit, i));
    }
    std::vector<WeighedModel> fewer = AllSettled(without, model.rung);
    if (fewer.empty() || fewer.front().score >= model.score + kBetter / 2) break;
    model = std::move(fewer.front());
  }
  return model;
}

WeighedModel Search::WithSimplerLaws(WeighedModel model) const {
  for (std::size_t i = 0; i < model.fit.causes.size(); ++i) {
    if (!IsAtItsEnd(candidates_, model.fit.causes[i])) continue;
    const auto simpler = SimplerLaw(ladder_[model.rung].machine().plant(), candidates_,
                                    model.fit.causes[i]);
    if (!simpler || Has(model.fit.causes, simpler->candidate)) continue;
    FittedModel other = model.fit;
    other.causes[i] = *simpler;
    auto settled = Settled(std::move(other), model.rung, work().Share(1));
    if (settled && settled->score < model.score + kBetter / 2)
      model = std::move(*settled);
  }
  return model;
}

bool Search::IsWorth(const WeighedModel& after, const WeighedModel& before,
                     double given) const {
  const double gain = before.score - after.score;
  if (gain < kBetter) return false;
  if (after.fit.causes.size() <= before.fit.causes.size()) return true;
  const double of = after.rung == 0 ? given : before.deviance;
  return gain > kWorth * std::max(0.0, of - ladder_.Noise());
}

/// Goes on in twice as many physics steps a tick, if the record is likelier with these.
bool Search::TakeFinerSteps(WeighedModel& best) {
  constexpr double kLate = 0.25;  // of a physics step's half: nearer to the finer steps
  constexpr int kMost = 4;        // times the steps of the setup
  constexpr int kIterations = 3;
  const std::vector<DoubtedNumber>& numbers = ladder_[0].numbers();
  const int substeps = ladder_[0].machine().rates().substeps;
  // Beside numbers in doubt a model that still lacks something seems to be late as well.
  // While it deserves the fastest observer it lacks more than steps.
  const bool tells =
      numbers.size() == 1 && numbers.front().is_lateness && best.rung > 0;
  if (!tells || substeps >= kMost * given_substeps_ || best.fit.numbers[0] < kLate ||
      !work().MayBegin("finer physics steps", RoundWork(ladder_[0]) / 4)) {
    return false;
  }
  const ObserverLadder coarse = ladder_;
  ladder_ = coarse.WithSubsteps(2 * substeps);
  FittedModel model = best.fit;
  // A step of half the length is late by half as much already.
  model.numbers[0] = std::max(0.0, 2.0 * model.numbers[0] - 1.0);
  auto finer = Fitted(best.rung, model, kIterations, work().Share(1));
  if (!finer || finer->score > best.score - kBetter) {
    ladder_ = coarse;
    return false;
  }
  if (auto settled = Settled(finer->fit, finer->rung, work().Share(1))) {
    finer = std::move(settled);
  }
  best = WithoutSuperfluous(*std::move(finer));
  return true;
}

SetSearchResult Search::Run(const FittedModel& start) {
  constexpr int kRounds = 10;
  constexpr int kSets = 2;
  constexpr int kAtFastest = 2;
  int at_fastest = 0;
  Report("numbers of the plant", 0.0, {});
  SetSearchResult result{{}, {}, {}, false, ladder_};
  result.given = Begin(start);
  result.best = result.given;
  work().NoteChange();
  for (int round = 0;
       round < kRounds && work().MayBegin("sets of causes", RoundWork(ladder_[0]));
       ++round) {
    while (TakeFinerSteps(result.best)) work().NoteChange();
    Report("sets of causes", 0.0, result.best.fit);
    const WeighedModel& present = result.best;
    std::vector<FittedModel> models;
    for (ProposedSet& set : ProposeSets(ladder_[present.rung], candidates_, present.fit,
                                        present.fit.jacobian, kSets)) {
      if (static_cast<int>(set.model.causes.size()) > options_.most_causes) continue;
      models.push_back(std::move(set.model));
    }
    Report("fits of sets of causes", 0.4, present.fit);
    std::vector<WeighedModel> settled = BestSettled(models, present.rung);
    if (settled.empty() || !IsWorth(settled.front(), present, result.given.deviance)) {
      result.ended = true;
      break;
    }
    Report("whether every cause is needed", 0.8, settled.front().fit);
    const bool was_added =
        settled.front().fit.causes.size() > result.best.fit.causes.size();
    result.best = WithoutSuperfluous(
        WithSimplerLaws(WithoutSuperfluous(std::move(settled.front()))));
    if (was_added) result.others.assign(settled.begin() + 1, settled.end());
    work().NoteChange();
    // What two sets have not made right enough for a slower observer no list explains.
    at_fastest = result.best.rung == 0 ? at_fastest + 1 : 0;
    if (at_fastest == kAtFastest) break;
  }
  result.ladder = ladder_;
  return result;
}

}  // namespace

double RoundWork(const DiscoveryProblem& problem) {
  constexpr double kRuns = 60.0;
  return kRuns * problem.RunWork();
}

SetSearchResult SearchSets(const ObserverLadder& ladder,
                           const std::vector<Candidate>& candidates,
                           const FittedModel& start, const SetSearchOptions& options) {
  return Search(ladder, candidates, options).Run(start);
}

}  // namespace mjdiag
