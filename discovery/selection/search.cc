#include "mjdiag/discovery/selection/search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>

#include "mjdiag/discovery/fitting/unsteady_fit.h"
#include "mjdiag/discovery/selection/model_choice.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A search under way.
class Search {
 public:
  Search(const DiscoveryProblem& problem, const std::vector<Candidate>& candidates,
         const SearchOptions& options, const SearchResult* before)
      : problem_(problem),
        candidates_(candidates),
        options_(options),
        beginning_(Beginning(problem, BeginningLength(problem))) {
    if (options.unseen != nullptr) {
      unseen_ = problem;
      unseen_->run = *options.unseen;
    }
    if (before == nullptr) return;
    result_.fit.causes = before->fit.causes;
    result_.contenders = before->contenders;
    result_.ladder = before->ladder;
    result_.refuted = before->refuted;
    result_.exchanged = before->exchanged;
  }

  SearchResult Run();

 private:
  static Index BeginningLength(const DiscoveryProblem& problem) {
    constexpr Index kShortest = 4000;
    return std::min(problem.train,
                    problem.skip + std::max(kShortest, problem.train / 4));
  }

  void Report(const std::string& what, double fraction) const {
    if (options_.progress) options_.progress(what, fraction);
  }
  Screening ScreenRest() const;
  double Inflation() const;
  bool IsSignificant(double gain, int freedom, int trials) const;
  bool IsSignificant(const CauseFit& after, int trials) const;
  /// Squared innovations of the train part if noise is all there is.
  double Noise() const { return FittedValues(problem_); }
  double RestOf(const Start& start) const;
  double MostRest(const Screening& screening) const;
  std::vector<Start> Shortlist(const Screening& screening) const;
  double CriterionOf(const CauseFit& fit) const {
    return Criterion(problem_, fit, independent_);
  }
  struct Entry {
    std::vector<FittedCause> causes;
    double criterion = std::numeric_limits<double>::infinity();
  };
  void FitToBeginning(std::vector<Entry>& entries, std::size_t count,
                      int iterations) const;
  std::string NamesOf(const std::vector<Entry>& entries) const;
  std::vector<Entry> Preview(const std::vector<Start>& shortlist) const;
  struct Round {
    std::vector<Contender> contenders;  // those that were fitted first, best first
    std::vector<CauseFit> fits;         // of as many
  };
  Round Compete(const std::vector<Start>& shortlist) const;
  bool Keep(Round round, int trials);
  /// Sensitivities of what has been found, if anything has.
  const MatrixXd* Known() const {
    return result_.fit.sensitivities.cols() > 0 ? &result_.fit.sensitivities : nullptr;
  }
  VectorXd UnseenResidual(const CauseFit& fit) const;
  double UnseenDeviance(const CauseFit& fit, const VectorXd& unseen) const;
  Refinement Refine() const {
    return {problem_, beginning_, candidates_, independent_,
            [this](const CauseFit& fit) {
              return UnseenDeviance(fit, UnseenResidual(fit));
            }};
  }
  void MeetUnsteadiness();
  bool AddCause();
  void AddCauses();
  void Settle();
  bool Exchange();

  const DiscoveryProblem& problem_;
  const std::vector<Candidate>& candidates_;
  const SearchOptions& options_;
  DiscoveryProblem beginning_;
  std::optional<DiscoveryProblem> unseen_;  // the other record
  SearchResult result_;
  VectorXd independent_;
  double unsteadiness_ = 0.0;
  int rounds_ = 0;
};

Screening Search::ScreenRest() const {
  constexpr int kStarts = 6;
  return ScreenBeside(problem_, candidates_, result_.fit.causes,
                      result_.fit.sensitivities, kStarts);
}

/// By how much chance gains are larger than with white noise alone: what is left may be
/// more than sensor noise, and coloured.
double Search::Inflation() const {
  return std::max(1.0, result_.fit.train) / std::min(1.0, independent_.minCoeff());
}

/// Whether to take away so much of the squared innovations, with the best of so many
/// trials, is more than chance.
bool Search::IsSignificant(double gain, int freedom, int trials) const {
  return (gain - unsteadiness_) / Inflation() >
         GainByChance(options_.false_alarm, trials, freedom);
}

/// The same of a fit with one more cause: what the first order promises may not be
/// there.
bool Search::IsSignificant(const CauseFit& after, int trials) const {
  return IsSignificant(Noise() * (result_.fit.train - after.train),
                       ParameterCount({after.causes.back()}), trials);
}

/// Squared innovations that a start leaves to first order, not less than noise does.
double Search::RestOf(const Start& start) const {
  return std::max(Noise() * result_.fit.train - start.gain, Noise());
}

/// The most that a start may leave to first order to be worth a fit. The first order is
/// rough for large effects and for shapes that the grid of trials misses; what it is
/// off by grows with what there is to explain and with what the best leaves of it.
double Search::MostRest(const Screening& screening) const {
  constexpr double kOfExcess = 0.1;
  constexpr double kOfRest = 1.0;
  constexpr double kChance = 200.0;
  const double excess = Noise() * std::max(result_.fit.train - 1.0, 0.0);
  double least = Noise() + excess;
  for (const Start& start : screening.starts) least = std::min(least, RestOf(start));
  return least + kOfRest * (least - Noise()) + kOfExcess * excess + kChance;
}

/// The best start of every candidate first, then second ones, so that a flexible law
/// with many starts does not crowd out a simple one.
std::vector<Start> Search::Shortlist(const Screening& screening) const {
  const double most = MostRest(screening);
  std::vector<Start> list;
  std::vector<Start> more;
  for (const Start& start : screening.starts) {
    const auto same = [&](const auto& other) {
      return other.candidate == start.candidate;
    };
    if (std::ranges::any_of(result_.fit.causes, same)) continue;
    if (!IsSignificant(start.gain, start.freedom, screening.trials)) continue;
    if (RestOf(start) > most) continue;
    const bool first = std::ranges::none_of(list, same);
    if (first && static_cast<int>(list.size()) < options_.shortlist) {
      list.push_back(start);
    } else if (!first && static_cast<int>(more.size()) < options_.shortlist / 2) {
      more.push_back(start);
    }
  }
  list.insert(list.end(), more.begin(), more.end());
  return list;
}

/// Fits the first `count` of the entries to the beginning of the record; those that
/// diverge go, the rest is put in order, best first.
void Search::FitToBeginning(std::vector<Entry>& entries, std::size_t count,
                            int iterations) const {
  if (entries.size() > count) entries.resize(count);
  std::vector<std::optional<CauseFit>> fits(entries.size());
  ParallelFor(static_cast<int>(entries.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    fits[i] = TryFit(beginning_, candidates_, entries[i].causes,
                     CompareFrom(Known(), iterations, 1e-3));
  });
  // On more data a difference grows in proportion.
  const double growth = static_cast<double>(problem_.train - problem_.skip) /
                        static_cast<double>(beginning_.train - beginning_.skip);
  const std::vector<double> criteria = Criteria(beginning_, fits);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    entries[i].criterion = growth * criteria[i];
    if (fits[i]) entries[i].causes = fits[i]->causes;
  }
  std::erase_if(entries, [](const Entry& e) { return !std::isfinite(e.criterion); });
  std::ranges::stable_sort(entries, std::less<>(), &Entry::criterion);
}

/// How promising every start of the shortlist is: small effects by their gain, which is
/// exact enough for them and holds for the whole train part; large ones, for which the
/// first order is not, by a fit on the beginning of the record.
std::vector<Search::Entry> Search::Preview(const std::vector<Start>& shortlist) const {
  constexpr double kSmall = 1.5;  // times the power of the noise
  std::vector<Entry> entries;
  for (const Start& start : shortlist) {
    Entry entry{result_.fit.causes};
    entry.causes.push_back(FittedFrom(candidates_, start));
    const double n = static_cast<double>(problem_.train) * independent_.sum();
    entry.criterion = -start.gain + ParameterCount({entry.causes.back()}) * std::log(n);
    entries.push_back(std::move(entry));
  }
  std::ranges::stable_sort(entries, std::less<>(), &Entry::criterion);
  if (result_.fit.train < kSmall) return entries;
  // Those that a few steps show to be worse than most get no more of them.
  constexpr std::size_t kBetter = 6;
  FitToBeginning(entries, entries.size(), 2);
  FitToBeginning(entries, kBetter, 4);
  return entries;
}

std::string Search::NamesOf(const std::vector<Entry>& entries) const {
  std::string names;
  for (const Entry& entry : entries) {
    names += (names.empty() ? "" : ", ") +
             Describe(candidates_[entry.causes.back().candidate]);
  }
  return names;
}

/// Fits the most promising of the shortlist on the whole train part.
Search::Round Search::Compete(const std::vector<Start>& shortlist) const {
  constexpr double kHopeless = 200.0;  // behind the best, in units of the criterion
  constexpr std::size_t kFinalists = 6;
  // Several starts of one candidate must not crowd out a simpler one.
  constexpr int kStarts = 2;
  std::vector<Entry> finalists;
  std::vector<Entry> others;
  std::map<std::size_t, int> starts;
  for (Entry& entry : Preview(shortlist)) {
    const std::size_t candidate = entry.causes.back().candidate;
    if (starts[candidate]++ >= kStarts) continue;
    const bool hopeless =
        !finalists.empty() && entry.criterion - finalists.front().criterion > kHopeless;
    (finalists.size() < kFinalists && !hopeless ? finalists : others)
        .push_back(std::move(entry));
  }
  std::vector<std::optional<CauseFit>> fits(finalists.size());
  if (!finalists.empty()) {
    Report("fit of " + NamesOf(finalists), 0.5);
  }
  ParallelFor(static_cast<int>(finalists.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    fits[i] = TryFit(problem_, candidates_, finalists[i].causes,
                     CompareFrom(Known(), 8, 1e-4));
  });
  Round round;
  const std::vector<double> criteria = Criteria(problem_, fits);
  std::vector<std::size_t> order(fits.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::less<>(),
                           [&](std::size_t i) { return criteria[i]; });
  for (const std::size_t i : order) {
    if (!fits[i]) continue;
    round.contenders.push_back({fits[i]->causes.back(), criteria[i], 0.0});
    round.fits.push_back(std::move(*fits[i]));
  }
  if (round.fits.empty()) return round;
  for (const Entry& entry : others) {
    const double behind = entry.criterion - finalists.front().criterion;
    round.contenders.push_back(
        {entry.causes.back(), round.contenders.front().criterion + behind, 0.0});
  }
  return round;
}

/// What the other record leaves with those causes; nothing without one or where it
/// diverges.
VectorXd Search::UnseenResidual(const CauseFit& fit) const {
  if (!unseen_) return {};
  try {
    return unseen_->Residual(ChangesOf(candidates_, fit.causes));
  } catch (const NumericalError&) {
    return {};
  }
}

/// Of the part held out and of another record.
double Search::UnseenDeviance(const CauseFit& fit, const VectorXd& unseen) const {
  const Index samples = problem_.run.samples();
  const double deviance =
      problem_.train < samples
          ? Deviance(fit.residual, independent_, problem_.train, samples)
          : 0.0;
  if (!unseen_) return deviance;
  if (unseen.size() == 0) return std::numeric_limits<double>::infinity();
  return deviance +
         Deviance(unseen, independent_, problem_.skip, unseen_->run.samples());
}

/// Keeps the best contender that explains unseen data as well; false if none does.
bool Search::Keep(Round round, int trials) {
  const VectorXd unseen_before = UnseenResidual(result_.fit);
  for (std::size_t i = 0; i < round.fits.size(); ++i) {
    const CauseFit& after = round.fits[i];
    independent_ = IndependentShare(problem_, after.residual);
    if (CriterionOf(after) >= CriterionOf(result_.fit)) continue;
    if (!IsSignificant(after, trials)) continue;
    if (UnseenDeviance(after, UnseenResidual(after)) >
        UnseenDeviance(result_.fit, unseen_before)) {
      result_.refuted.push_back(after.causes.back());
      continue;
    }
    round.contenders.erase(round.contenders.begin(),
                           round.contenders.begin() + static_cast<std::ptrdiff_t>(i));
    Rank(round.contenders);
    result_.ladder.push_back({round.contenders, round.fits[i]});
    result_.contenders.push_back(round.contenders);
    result_.fit = std::move(round.fits[i]);
    return true;
  }
  return false;
}

/// If the course of the machine depends on the last digit, the fit is looked for around
/// where slopes led it, and further causes have to be worth more.
void Search::MeetUnsteadiness() {
  constexpr double kUnsteady = 30.0;  // of a gain, as chance has it
  constexpr int kRounds = 6;
  unsteadiness_ = Unsteadiness(problem_, candidates_, result_.fit);
  for (int i = 0; i < kRounds && unsteadiness_ > kUnsteady * Inflation(); ++i) {
    auto better = LookAround(problem_, candidates_, result_.fit, unsteadiness_);
    if (!better) break;
    result_.fit = std::move(*better);
  }
}

/// One round; false if it found no further cause.
bool Search::AddCause() {
  Report("screening", 0.0);
  const Screening screening = ScreenRest();
  const std::vector<Start> shortlist = Shortlist(screening);
  result_.significant_rest = !shortlist.empty();
  if (shortlist.empty() || rounds_++ >= options_.most_causes) return false;
  Round contest = Compete(shortlist);
  result_.significant_rest =
      contest.fits.empty() ||
      std::ranges::any_of(contest.fits, [&](const CauseFit& after) {
        return IsSignificant(after, screening.trials);
      });
  if (!Keep(std::move(contest), screening.trials)) return false;
  result_.exchanged = false;
  return true;
}

/// After a change of the causes.
void Search::Settle() {
  const Refinement refinement = Refine();
  Report("other periods", 0.7);
  refinement.ChangePeriods(result_);
  Report("whether every cause is needed", 0.8);
  while (refinement.Prune(result_)) {
  }
  Report("whether the course is steady", 0.9);
  MeetUnsteadiness();
}

void Search::AddCauses() {
  const auto serves = [this] {
    result_.served = !options_.serves || options_.serves(result_.fit);
    return result_.served;
  };
  while (serves() && AddCause()) Settle();
}

/// True if another candidate came into the place of a cause.
bool Search::Exchange() {
  if (result_.fit.causes.empty()) return false;
  Report("other causes in the place of those found", 0.9);
  return Refine().Exchange(result_);
}

SearchResult Search::Run() {
  Report("fit of what is known", 0.0);
  result_.fit = FitCauses(problem_, candidates_, result_.fit.causes,
                          {.iterations = 10, .tolerance = 1e-5, .secant = true});
  // Before anything is found all of the mismatch may be one cause, which has any
  // colour.
  independent_ = VectorXd::Ones(problem_.run.outputs.rows());
  if (!result_.fit.causes.empty()) {
    independent_ = IndependentShare(problem_, result_.fit.residual);
  }
  AddCauses();
  if (!result_.served) return std::move(result_);
  if (options_.preliminary && options_.preliminary(result_.fit)) {
    return std::move(result_);
  }
  constexpr int kExchanges = 4;
  for (int i = 0; i < kExchanges && !result_.exchanged; ++i) {
    if (Exchange()) {
      Settle();
      AddCauses();
    } else {
      result_.exchanged = true;
    }
  }
  if (options_.last_fit && !result_.fit.causes.empty()) {
    Report("last fit", 0.9);
    const CauseFit& fit = result_.fit;
    result_.fit = FitCauses(problem_, candidates_, fit.causes,
                            {.iterations = 8,
                             .tolerance = 1e-8,
                             .known = fit.exact ? &fit.sensitivities : nullptr});
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
