#include "mjdiag/discovery/selection/search.h"

#include <algorithm>
#include <limits>
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
constexpr const char* kWithout = "searches without single causes";
constexpr const char* kLastFit = "last fit";

/// The values that a search without cause i starts from.
CauseFit WithoutCause(const CauseFit& fit, std::size_t i) {
  CauseFit rest;
  static_cast<FittedModel&>(rest) = ModelWithout(fit, {i});
  return rest;
}

/// A search under way.
class Search {
 public:
  Search(const DiscoveryProblem& problem, const std::vector<Candidate>& candidates,
         const SearchOptions& options, const SearchResult* before)
      : data_{problem, BeginningOf(problem), candidates,
              DataOf(problem, candidates, options.unseen, options.free_run),
              options.forbidden},
        options_(options) {
    if (before == nullptr) return;
    found_before_ = before->fit();
    result_.rivals = before->rivals;
    result_.ladder = before->ladder;
    result_.numbers_alone = before->numbers_alone;
    result_.refuted = before->refuted;
    result_.exchanged = before->exchanged;
    result_.searched_without = before->searched_without;
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
  void Take(Evidence proposed, std::vector<Hypothesis> rivals, std::size_t i);
  bool Confirm();
  void GiveUpWhatIsAhead();
  void MeetUnsteadiness();
  /// What was tried in the place of causes was tried beside others.
  void NoteChange() {
    result_.exchanged = false;
    result_.searched_without = false;
    NoteAnswer();
  }
  void NoteAnswer();
  std::vector<Start> ScreenWhatIsLeft(Chance& chance);
  bool AddCause();
  void AddCauses();
  void DropSuperfluous() {
    while (!result_.fit().causes.empty() && work().MayBegin(kNeeded) &&
           Drop(data_, result_)) {
    }
  }
  void Settle();
  bool TryExchange();
  void ExchangeCauses();
  bool SearchWithout();
  void FitClosely();

  const SearchData data_;
  const SearchOptions& options_;
  FittedModel found_before_;
  SearchResult result_;
  /// Where causes of the present set were added against unseen data: how many, and what
  /// there was before them.
  int ahead_ = 0;
  SearchResult confirmed_;
  double unsteadiness_ = 0.0;
  int rounds_ = 0;
  double noted_ = std::numeric_limits<double>::infinity();
};

/// The answer is another where it leaves less than before: one law in the place of another
/// that leaves as much, or takes away a little more, is no reason to search on.
void Search::NoteAnswer() {
  constexpr double kLess = 0.9;  // of the mean square beyond noise
  const double left = result_.fit().train - 1.0;
  // A search without one of the causes is none of the answer yet.
  if (!options_.forbidden.empty() || (noted_ > 0.0 && left > kLess * noted_)) return;
  noted_ = left;
  work().NoteChange();
}

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
    return AsItIs(data_.problem, data_.candidates, found_before_);
  }
}

void Search::FitCausesFoundBefore() {
  Report("fit of the causes found before", 0.0);
  CauseFit fit = FitFoundBefore();
  result_.significant_rest = true;
  result_.screened = false;
  if (fit.causes.empty()) result_.numbers_alone = fit.numbers;
  // Before anything is found all of the mismatch may be one cause, which has any
  // colour.
  VectorXd independent = fit.causes.empty()
                             ? VectorXd::Ones(data_.problem.run().outputs.rows()).eval()
                             : IndependentShare(data_.problem, fit.residual);
  result_.evidence = {data_.evidence, std::move(fit), std::move(independent)};
  NoteAnswer();
}

/// Adds the first of the hypotheses that is accepted; else, ahead of what confirms it,
/// the first that only unseen data turn down. False if there is neither.
bool Search::Keep(Additions additions, const Chance& chance) {
  constexpr int kMostAhead = 2;
  std::optional<std::size_t> ahead;
  std::vector<Evidence> proposed;
  for (std::size_t i = 0; i < additions.fits.size(); ++i) {
    CauseFit& fit = additions.fits[i];
    VectorXd independent = IndependentShare(data_.problem, fit.residual);
    proposed.push_back(
        result_.evidence.Added(std::move(fit), std::move(independent), chance));
    const Judgement judgement = Judge(result_.evidence, proposed[i]);
    if (judgement == Judgement::kAccepted) {
      Take(std::move(proposed[i]), std::move(additions.hypotheses), i);
      return true;
    }
    if (judgement != Judgement::kUnseen) continue;
    const FittedCause& refuted = proposed[i].fit().causes.back();
    std::erase_if(result_.refuted, [&](const FittedCause& before) {
      return before.candidate == refuted.candidate;
    });
    result_.refuted.push_back(refuted);
    if (!ahead) ahead = i;
  }
  if (!ahead || ahead_ >= kMostAhead) return false;
  if (ahead_++ == 0) confirmed_ = result_;
  Take(std::move(proposed[*ahead]), std::move(additions.hypotheses), *ahead);
  return true;
}

/// @param rivals  in the order of the sets that were proposed, of which it is number i
void Search::Take(Evidence proposed, std::vector<Hypothesis> rivals, std::size_t i) {
  rivals.erase(rivals.begin(), rivals.begin() + static_cast<std::ptrdiff_t>(i));
  Rank(rivals);
  result_.rivals.push_back(std::move(rivals));
  result_.ladder.push_back(proposed.fit());
  result_.evidence = std::move(proposed);
}

/// Whether unseen data agree with the present set, if it was ahead of them.
bool Search::Confirm() {
  if (ahead_ == 0) return true;
  if (Judge(confirmed_.evidence, result_.evidence) != Judgement::kAccepted) {
    return false;
  }
  ahead_ = 0;
  return true;
}

/// Goes back to where unseen data last agreed.
void Search::GiveUpWhatIsAhead() {
  if (Confirm()) return;
  confirmed_.refuted = std::move(result_.refuted);
  confirmed_.significant_rest = true;
  confirmed_.exchanged = result_.exchanged;
  confirmed_.served = result_.served;
  result_ = std::move(confirmed_);
  ahead_ = 0;
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

/// What could be added.
std::vector<Start> Search::ScreenWhatIsLeft(Chance& chance) {
  Report("screening", 0.0);
  constexpr int kStarts = 6;
  const Evidence& present = result_.evidence;
  const Screening screening = ScreenBeside(
      data_.problem, data_.candidates, present.fit(), present.fit().jacobian, kStarts);
  chance = ChanceOf(screening.trials);
  std::vector<Start> shortlist =
      Shortlist(data_, present, screening, chance, options_.shortlist);
  result_.significant_rest = !shortlist.empty();
  result_.screened = true;
  return shortlist;
}

/// One round; false if it found no further cause.
bool Search::AddCause() {
  Chance chance;
  const std::vector<Start> shortlist = ScreenWhatIsLeft(chance);
  const Evidence& present = result_.evidence;
  if (shortlist.empty()) return false;
  Report(kBetter, 0.2);
  if (Better(data_, result_, chance)) {
    NoteChange();
    return true;
  }
  if (rounds_++ >= options_.most_causes || !work().MayBegin(kFurther)) return false;
  Additions additions =
      ProposeAdditions(data_, present, shortlist,
                       [this](const std::string& what) { Report(what, 0.5); });
  // What the first order promises may not be there.
  const auto is_significant = [&](const CauseFit& after) {
    return present.SignificanceOf(after, chance, present.independent())
        .IsMoreThanChance();
  };
  result_.significant_rest = (additions.fits.empty() && additions.incredible.empty()) ||
                             std::ranges::any_of(additions.fits, is_significant) ||
                             std::ranges::any_of(additions.incredible, is_significant);
  if (!Keep(std::move(additions), chance)) {
    work().MayBegin(kFurther);  // kept if their fits were cut short
    return false;
  }
  NoteChange();
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
  while (GiveUpIncredible(data_, result_)) {
  }
  DropSuperfluous();
  Report(kRepeatable, 0.9);
  if (work().MayBegin(kRepeatable)) MeetUnsteadiness();
}

void Search::AddCauses() {
  const auto serves = [this] {
    result_.served = !options_.serves || options_.serves(result_.fit());
    return result_.served;
  };
  while (work().MayBegin(kFurther) && serves() && AddCause()) {
    Settle();
    Confirm();
  }
  GiveUpWhatIsAhead();
}

/// True if another candidate came into the place of a cause.
bool Search::TryExchange() {
  if (result_.fit().causes.empty()) return false;
  Report(kOthers, 0.9);
  return Exchange(data_, result_) || Merge(data_, result_);
}

void Search::ExchangeCauses() {
  constexpr int kExchanges = 4;
  for (int i = 0; i < kExchanges && !result_.exchanged; ++i) {
    if (!result_.fit().causes.empty() && !work().MayBegin(kOthers)) break;
    if (TryExchange()) {
      NoteAnswer();
      Settle();
      AddCauses();
    } else {
      result_.exchanged = true;
    }
  }
}

/// Searches that may not take one of the causes, from the others; true if the set of one
/// is better.
bool Search::SearchWithout() {
  constexpr double kWhite = 0.9;
  constexpr double kFarOff = 30.0;       // times what is left: seen by its shape
  constexpr double kOfBudget = 0.5;      // that may be used when one begins,
  constexpr double kMostOfBudget = 0.7;  // and goes on
  const auto is_plain = [&] {
    return result_.fit().causes.size() < 2 &&
           IndependentShare(data_.problem, result_.fit().residual).minCoeff() > kWhite;
  };
  bool found = false;
  std::size_t i = result_.fit().causes.size();
  while (!result_.searched_without && i > 0 && !is_plain() &&
         work().used() < kOfBudget * work().limit() && work().MayBegin(kWithout)) {
    --i;
    SearchResult start = result_;
    start.evidence = result_.evidence.Changed(WithoutCause(result_.fit(), i));
    start.rivals.erase(start.rivals.begin() + static_cast<std::ptrdiff_t>(i));
    SearchOptions options = options_;
    options.forbidden.push_back(result_.fit().causes[i].candidate);
    options.exchange = false;
    options.last_fit = false;
    options.preliminary = nullptr;
    const bool has_others = result_.fit().causes.size() > 1;
    options.serves = [&, has_others](const CauseFit& fit) {
      const bool near = fit.train < kFarOff * std::max(1.0, result_.fit().train);
      return (near || !has_others) && work().used() < kMostOfBudget * work().limit();
    };
    SearchResult other = SearchCauses(data_.problem, data_.candidates, options, &start);
    if (Judge(result_.evidence, other.evidence) != Judgement::kAccepted) continue;
    result_ = std::move(other);
    NoteAnswer();
    result_.served = true;
    result_.exchanged = false;
    found = true;
    i = result_.fit().causes.size();
  }
  if (i == 0) result_.searched_without = true;
  return found;
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
                   .first_order = fit.numbers.size() > 1,
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
  if (options_.exchange) {
    ExchangeCauses();
    if (SearchWithout()) ExchangeCauses();
  }
  if (options_.last_fit && result_.fit().jacobian.cols() > 0 &&
      work().MayBegin(kLastFit)) {
    FitClosely();
  }
  // Where the work was used up, what was screened last may not be what has been found.
  if (!work().left_out().empty() && !result_.fit().causes.empty()) {
    Chance chance;
    ScreenWhatIsLeft(chance);
  }
  std::erase_if(result_.refuted, [&](const FittedCause& cause) {
    return Has(result_.fit().causes, cause.candidate);
  });
  return std::move(result_);
}

}  // namespace

SearchResult SearchCauses(const DiscoveryProblem& problem,
                          const std::vector<Candidate>& candidates,
                          const SearchOptions& options, const SearchResult* before) {
  return Search(problem, candidates, options, before).Run();
}

}  // namespace mjdiag
