#include "mjdiag/discovery/selection/search.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "mjdiag/discovery/fitting/unsteady_fit.h"
#include "mjdiag/discovery/screening/screening.h"
#include "mjdiag/discovery/selection/addition.h"
#include "mjdiag/discovery/selection/comparator.h"
#include "mjdiag/discovery/selection/model_choice.h"
#include "mjdiag/discovery/selection/moves.h"
#include "mjdiag/discovery/selection/number_fit.h"
#include "mjdiag/discovery/selection/search_data.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Steps of a search that may be left out.
constexpr const char* kFurther = "further causes";
constexpr const char* kNeeded = "whether every cause is needed";
constexpr const char* kRepeatable = "whether runs are repeatable";
constexpr const char* kLastFit = "last fit";

Index BeginningLength(const DiscoveryProblem& problem) {
  // Each of several records shows something that the others do not.
  if (problem.run().records.size() > 1) return problem.train();
  constexpr Index kShortest = 4000;
  return std::min(problem.train(),
                  problem.skip() + std::max(kShortest, problem.train() / 4));
}

/// A search under way.
class Search {
 public:
  Search(const DiscoveryProblem& problem, const std::vector<Candidate>& candidates,
         const SearchOptions& options, const SearchResult* before)
      : data_{problem, Beginning(problem, BeginningLength(problem)), candidates,
              DataOf(problem, candidates, options.unseen, options.free_run)},
        options_(options) {
    if (before == nullptr) return;
    found_before_ = before->fit();
    result_.rivals = before->rivals;
    result_.ladder = before->ladder;
    result_.numbers_alone = before->numbers_alone;
    result_.refuted = before->refuted;
    result_.exchanged = before->exchanged;
  }

  SearchResult Run();

 private:
  void Report(const std::string& what, double fraction) const {
    if (options_.progress) options_.progress(what, fraction, result_.fit());
  }
  Work& work() const { return *data_.problem.work(); }
  Chance ChanceOf(int trials) const {
    return {options_.false_alarm, trials, unsteadiness_};
  }
  CauseFit FitFoundBefore() const;
  void FitCausesFoundBefore();
  bool Keep(Additions additions, const Chance& chance);
  void MeetUnsteadiness();
  bool AddCause();
  void AddCauses();
  void DropSuperfluous() {
    while (!result_.fit().causes.empty() && work().MayBegin(kNeeded) &&
           Drop(data_, result_)) {
    }
  }
  void Settle();
  bool TryExchange();
  void FitClosely();

  const SearchData data_;
  const SearchOptions& options_;
  FittedModel found_before_;
  SearchResult result_;
  double unsteadiness_ = 0.0;
  int rounds_ = 0;
};

CauseFit Search::FitFoundBefore() const {
  try {
    if (found_before_.causes.empty()) {
      return FitNumbers(data_.problem, data_.candidates, found_before_.numbers,
                        work().Share(1));
    }
    return FitCauses(data_.problem, data_.candidates, found_before_,
                     {.iterations = 10,
                      .tolerance = 1e-5,
                      .secant = true,
                      .share = work().Share(1)});
  } catch (const CutShort&) {
    work().CutShort();
    return FitCauses(data_.problem, data_.candidates, found_before_,
                     {.iterations = 0, .jacobian = false, .closing = true});
  }
}

void Search::FitCausesFoundBefore() {
  Report("fit of the causes found before", 0.0);
  CauseFit fit = FitFoundBefore();
  // Until a screening says otherwise.
  result_.significant_rest = true;
  if (fit.causes.empty()) result_.numbers_alone = fit.numbers;
  // Before anything is found all of the mismatch may be one cause, which has any
  // colour.
  VectorXd independent = fit.causes.empty()
                             ? VectorXd::Ones(data_.problem.run().outputs.rows()).eval()
                             : IndependentShare(data_.problem, fit.residual);
  result_.evidence = {data_.evidence, std::move(fit), std::move(independent)};
}

/// Adds the first of the hypotheses that is accepted; false if none is.
bool Search::Keep(Additions additions, const Chance& chance) {
  for (std::size_t i = 0; i < additions.fits.size(); ++i) {
    CauseFit& fit = additions.fits[i];
    VectorXd independent = IndependentShare(data_.problem, fit.residual);
    Evidence proposed =
        result_.evidence.Added(std::move(fit), std::move(independent), chance);
    const Judgement judgement = Judge(result_.evidence, proposed);
    if (judgement == Judgement::kUnseen) {
      result_.refuted.push_back(proposed.fit().causes.back());
    }
    if (judgement != Judgement::kAccepted) continue;
    std::vector<Hypothesis> rivals = std::move(additions.hypotheses);
    rivals.erase(rivals.begin(), rivals.begin() + static_cast<std::ptrdiff_t>(i));
    Rank(rivals);
    result_.rivals.push_back(std::move(rivals));
    result_.ladder.push_back(proposed.fit());
    result_.evidence = std::move(proposed);
    return true;
  }
  return false;
}

/// If the course of the machine depends on the last digit, the fit is looked for around
/// where derivatives led it, and further causes have to be worth more.
void Search::MeetUnsteadiness() {
  constexpr double kUnsteady = 30.0;  // of a gain, as chance has it
  constexpr int kRounds = 6;
  unsteadiness_ = Unsteadiness(data_.problem, data_.candidates, result_.fit());
  for (int i = 0; i < kRounds; ++i) {
    if (unsteadiness_ <= kUnsteady * result_.evidence.Inflation()) break;
    auto better =
        LookAround(data_.problem, data_.candidates, result_.fit(), unsteadiness_);
    if (!better) break;
    result_.evidence = result_.evidence.Changed(std::move(*better));
  }
}

/// One round; false if it found no further cause.
bool Search::AddCause() {
  Report("screening", 0.0);
  constexpr int kStarts = 6;
  const Evidence& present = result_.evidence;
  const Screening screening = ScreenBeside(
      data_.problem, data_.candidates, present.fit(), present.fit().jacobian, kStarts);
  const Chance chance = ChanceOf(screening.trials);
  const std::vector<Start> shortlist =
      Shortlist(present, screening, chance, options_.shortlist);
  result_.significant_rest = !shortlist.empty();
  if (shortlist.empty() || rounds_++ >= options_.most_causes) return false;
  if (!work().MayBegin(kFurther)) return false;
  Additions additions =
      ProposeAdditions(data_, present, shortlist,
                       [this](const std::string& what) { Report(what, 0.5); });
  // What the first order promises may not be there.
  result_.significant_rest =
      additions.fits.empty() ||
      std::ranges::any_of(additions.fits, [&](const CauseFit& after) {
        return present.SignificanceOf(after, chance, present.independent())
            .IsMoreThanChance();
      });
  if (!Keep(std::move(additions), chance)) {
    work().MayBegin(kFurther);  // kept if their fits were cut short
    return false;
  }
  result_.exchanged = false;
  return true;
}

/// After a change of the causes.
void Search::Settle() {
  Report("other periods", 0.7);
  ChangePeriods(data_, result_);
  Report("simpler laws", 0.8);
  while (Simplify(data_, result_)) {
  }
  Report(kNeeded, 0.8);
  DropSuperfluous();
  Report(kRepeatable, 0.9);
  if (work().MayBegin(kRepeatable)) MeetUnsteadiness();
}

void Search::AddCauses() {
  const auto serves = [this] {
    result_.served = !options_.serves || options_.serves(result_.fit());
    return result_.served;
  };
  while (work().MayBegin(kFurther) && serves() && AddCause()) Settle();
}

/// True if another candidate came into the place of a cause.
bool Search::TryExchange() {
  if (result_.fit().causes.empty()) return false;
  Report(kOthers, 0.9);
  return Exchange(data_, result_);
}

void Search::FitClosely() {
  Report(kLastFit, 0.9);
  const CauseFit& fit = result_.fit();
  try {
    result_.evidence = result_.evidence.Changed(
        FitCauses(data_.problem, data_.candidates, fit,
                  {.iterations = 8,
                   .tolerance = 1e-8,
                   .initial_jacobian = fit.exact ? &fit.jacobian : nullptr,
                   .share = work().Share(1)}));
  } catch (const CutShort&) {
    work().CutShort();
  }
}

SearchResult Search::Run() {
  FitCausesFoundBefore();
  // Behind another observer or with other steps one of them may be nothing.
  DropSuperfluous();
  AddCauses();
  if (!result_.served) return std::move(result_);
  if (options_.preliminary && options_.preliminary(result_.fit())) {
    return std::move(result_);
  }
  constexpr int kExchanges = 4;
  for (int i = 0; i < kExchanges && !result_.exchanged; ++i) {
    if (!result_.fit().causes.empty() && !work().MayBegin(kOthers)) break;
    if (TryExchange()) {
      Settle();
      AddCauses();
    } else {
      result_.exchanged = true;
    }
  }
  if (options_.last_fit && result_.fit().jacobian.cols() > 0 &&
      work().MayBegin(kLastFit)) {
    FitClosely();
  }
  return std::move(result_);
}

}  // namespace

SearchResult SearchCauses(const DiscoveryProblem& problem,
                          const std::vector<Candidate>& candidates,
                          const SearchOptions& options, const SearchResult* before) {
  return Search(problem, candidates, options, before).Run();
}

}  // namespace mjdiag
