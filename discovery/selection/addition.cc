#include "mjdiag/discovery/selection/addition.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "mjdiag/discovery/fitting/first_values.h"
#include "mjdiag/discovery/selection/model_choice.h"
#include "mjdiag/discovery/selection/settled_fit.h"
#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {
namespace {

using Eigen::MatrixXd;

// Effects are small where so much is left, times the power of the noise.
constexpr double kSmall = 1.5;

/// Squared innovations that a start leaves to first order, not less than noise does.
double RestOf(const Evidence& present, const Start& start) {
  return std::max(present.Noise() * present.fit().train - start.gain, present.Noise());
}

/// The most that a start may leave to first order to be worth a fit. The first order is
/// rough for large effects and for shapes that the grid of trials misses; what it is
/// off by grows with what there is to explain and with what the best leaves of it. What
/// promises to take away noise as well does not keep it.
double MostRest(const Evidence& present, const Screening& screening) {
  constexpr double kOfExcess = 0.1;
  constexpr double kOfRest = 1.0;
  constexpr double kChance = 200.0;
  constexpr double kDeviations = 3.0;
  const double noise = present.Noise();
  const double excess = noise * std::max(present.fit().train - 1.0, 0.0);
  double least = noise + excess;
  for (const Start& start : screening.starts) {
    if (start.gain > excess + kDeviations * std::sqrt(2.0 * noise)) continue;
    least = std::min(least, RestOf(present, start));
  }
  return least + kOfRest * (least - noise) + kOfExcess * excess + kChance;
}

/// The present causes and a new one, with how promising that is.
struct Entry : FittedModel {
  double criterion = std::numeric_limits<double>::infinity();
};

/// Places of the fits that there are, best first.
std::vector<std::size_t> OrderOf(const DiscoveryProblem& problem,
                                 const std::vector<std::optional<CauseFit>>& fits) {
  const std::vector<double> criteria = Criteria(problem, fits);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (fits[i]) order.push_back(i);
  }
  std::ranges::stable_sort(order, std::less<>(),
                           [&](std::size_t i) { return criteria[i]; });
  return order;
}

/// Whether what a fit adds is credible; it comes last.
bool AddsCredibly(const std::vector<Candidate>& candidates, const CauseFit& fit) {
  return IsCredible(candidates, fit, fit.causes.back());
}

/// Sets that compete for being the present one with one more hypothesis.
class Contest {
 public:
  Contest(const SearchData& data, const Evidence& present)
      : data_(data), present_(present) {}

  std::vector<Entry> Preview(const std::vector<Start>& shortlist) const;
  std::vector<std::optional<CauseFit>> Fit(const std::vector<Entry>& entries) const;
  void Simplify(std::vector<std::optional<CauseFit>>& fits) const;

 private:
  void FitToBeginning(std::vector<Entry>& entries, std::size_t count,
                      int iterations) const;
  std::optional<CauseFit> FirstFit(const FittedModel& model, double share) const;
  /// Jacobian of what has been found, if it has one and is still that beside one more
  /// cause: what explains much changes what numbers of the plant do.
  const MatrixXd* FoundJacobian() const {
    const CauseFit& fit = present_.fit();
    if (fit.numbers.size() > 0 && fit.train > kFarAboveNoise) return nullptr;
    return fit.jacobian.cols() > 0 ? &fit.jacobian : nullptr;
  }

  const SearchData& data_;
  const Evidence& present_;
};

/// Fits the first `count` of the entries to the beginning of the record; those that
/// diverge go, the rest is put in order, best first.
void Contest::FitToBeginning(std::vector<Entry>& entries, std::size_t count,
                             int iterations) const {
  if (entries.size() > count) entries.resize(count);
  std::vector<std::optional<CauseFit>> fits(entries.size());
  const double share = data_.work().Share(static_cast<int>(entries.size()));
  ParallelFor(static_cast<int>(entries.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    fits[i] = TryFit(data_.beginning, data_.candidates, entries[i],
                     CompareFrom(FoundJacobian(), iterations, 1e-3, share));
  });
  // On more data a difference grows in proportion.
  const double growth =
      static_cast<double>(data_.problem.train() - data_.problem.skip()) /
      static_cast<double>(data_.beginning.train() - data_.beginning.skip());
  const std::vector<double> criteria = Criteria(data_.beginning, fits);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    entries[i].criterion = growth * criteria[i];
    if (fits[i]) {
      entries[i].causes = fits[i]->causes;
      entries[i].numbers = fits[i]->numbers;
    }
  }
  std::erase_if(entries, [](const Entry& e) { return !std::isfinite(e.criterion); });
  std::ranges::stable_sort(entries, std::less<>(), &Entry::criterion);
}

/// How promising every start of the shortlist is: small effects by their gain, which is
/// exact enough for them and holds for the whole train part; large ones, for which the
/// first order is not, by a fit on the beginning of the record.
std::vector<Entry> Contest::Preview(const std::vector<Start>& shortlist) const {
  std::vector<Entry> entries;
  for (const Start& start : shortlist) {
    Entry entry{
        {present_.fit().causes, present_.fit().numbers, present_.fit().prior_weight}};
    entry.causes.push_back(Bounded(data_.candidates, start.cause));
    const double n =
        static_cast<double>(data_.problem.train()) * present_.independent().sum();
    entry.criterion = -start.gain + PriorOf(data_.candidates, entry) +
                      ParameterCount({entry.causes.back()}) * std::log(n);
    entries.push_back(std::move(entry));
  }
  std::ranges::stable_sort(entries, std::less<>(), &Entry::criterion);
  if (present_.fit().train < kSmall) return entries;
  const MatrixXd& jacobian = present_.fit().jacobian;
  const double enough = MeanSquare(data_.problem, present_.fit().residual,
                                   data_.problem.skip(), data_.beginning.train());
  ParallelFor(static_cast<int>(entries.size()), [&](int number) {
    Entry& entry = entries[static_cast<std::size_t>(number)];
    static_cast<FittedModel&>(entry) =
        WithFirstValues(data_.beginning, data_.candidates, entry, &jacobian, enough);
  });
  // Those that a few steps show to be worse than most get no more of them.
  constexpr std::size_t kBetter = 6;
  FitToBeginning(entries, entries.size(), 2);
  FitToBeginning(entries, kBetter, 4);
  return entries;
}

/// On the whole train part, far enough to compare it.
std::optional<CauseFit> Contest::FirstFit(const FittedModel& model,
                                          double share) const {
  FitOptions options = CompareFrom(FoundJacobian(), 5, 1e-4, share);
  options.only_betters = true;
  const bool was_begun = present_.fit().train >= kSmall;
  const FittedModel start =
      was_begun ? model
                : WithFirstValues(data_.problem, data_.candidates, model,
                                  FoundJacobian(), present_.fit().train);
  return TryFit(data_.problem, data_.candidates, start, options);
}

/// On the whole train part; the best of them to their ends.
std::vector<std::optional<CauseFit>> Contest::Fit(
    const std::vector<Entry>& entries) const {
  constexpr std::size_t kToTheEnd = 3;
  std::vector<std::optional<CauseFit>> fits(entries.size());
  const double share = data_.work().Share(static_cast<int>(entries.size()));
  ParallelFor(static_cast<int>(entries.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    fits[i] = FirstFit(entries[i], share);
  });
  // Of several starts of one candidate the best.
  std::vector<std::size_t> order;
  for (const std::size_t i : OrderOf(data_.problem, fits)) {
    const auto same = [&](std::size_t k) {
      return entries[k].causes.back().candidate == entries[i].causes.back().candidate;
    };
    if (std::ranges::none_of(order, same)) order.push_back(i);
    if (order.size() == kToTheEnd) break;
  }
  ParallelFor(static_cast<int>(order.size()), [&](int number) {
    auto& fit = fits[order[static_cast<std::size_t>(number)]];
    fit = Settled(data_.problem, data_.candidates, std::move(*fit), share);
  });
  // The others may be cut short without harm.
  order = OrderOf(data_.problem, fits);
  if (!order.empty() && fits[order.front()]->cut) data_.work().CutShort();
  return fits;
}

/// Adds to the fits those of simpler laws that others are where they ended.
void Contest::Simplify(std::vector<std::optional<CauseFit>>& fits) const {
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (!fits[i] || AddsCredibly(data_.candidates, *fits[i])) continue;
    const auto simpler = data_.AtItsEnd(*fits[i]);
    const auto is_same = [&](const std::optional<CauseFit>& fit) {
      return fit && fit->causes.back().candidate == simpler->causes.back().candidate;
    };
    if (!simpler || std::ranges::any_of(fits, is_same)) continue;
    const double share = data_.work().Share(1);
    auto fit = FirstFit(*simpler, share);
    if (!fit) continue;
    fits.push_back(Settled(data_.problem, data_.candidates, std::move(*fit), share));
  }
}

std::string NamesOf(const std::vector<Candidate>& candidates,
                    const std::vector<Entry>& entries) {
  std::string names;
  for (const Entry& entry : entries) {
    names += (names.empty() ? "" : ", ") +
             Describe(candidates[entry.causes.back().candidate]);
  }
  return names;
}

}  // namespace

std::vector<Start> Shortlist(const SearchData& data, const Evidence& present,
                             const Screening& screening, const Chance& chance,
                             int most) {
  const double most_rest = MostRest(present, screening);
  std::vector<Start> list;
  std::vector<Start> more;
  for (const Start& start : screening.starts) {
    const auto same = [&](const FittedCause& other) {
      return other.candidate == start.cause.candidate;
    };
    if (std::ranges::any_of(present.fit().causes, same)) continue;
    if (data.IsForbidden(start.cause.candidate)) continue;
    if (!present
             .SignificanceOf(start.gain, start.freedom, chance, present.independent())
             .IsMoreThanChance()) {
      continue;
    }
    if (RestOf(present, start) > most_rest) continue;
    const bool first = std::ranges::none_of(list, same, &Start::cause);
    if (first && static_cast<int>(list.size()) < most) {
      list.push_back(start);
    } else if (!first && static_cast<int>(more.size()) < most / 2) {
      more.push_back(start);
    }
  }
  list.insert(list.end(), more.begin(), more.end());
  return list;
}

Additions ProposeAdditions(const SearchData& data, const Evidence& present,
                           const std::vector<Start>& shortlist,
                           const std::function<void(const std::string&)>& report) {
  constexpr double kHopeless = 200.0;  // behind the best, in units of the criterion
  constexpr std::size_t kFinalists = 6;
  // Several starts of one candidate must not crowd out a simpler one.
  constexpr int kStarts = 2;
  const Contest contest(data, present);
  std::vector<Entry> finalists;
  std::vector<Entry> others;
  std::map<std::size_t, int> starts;
  for (Entry& entry : contest.Preview(shortlist)) {
    const std::size_t candidate = entry.causes.back().candidate;
    if (starts[candidate]++ >= kStarts) continue;
    const bool hopeless =
        !finalists.empty() && entry.criterion - finalists.front().criterion > kHopeless;
    (finalists.size() < kFinalists && !hopeless ? finalists : others)
        .push_back(std::move(entry));
  }
  if (!finalists.empty()) report("fit of " + NamesOf(data.candidates, finalists));
  std::vector<std::optional<CauseFit>> fits = contest.Fit(finalists);
  contest.Simplify(fits);
  Additions additions;
  for (auto& fit : fits) {
    if (!fit || AddsCredibly(data.candidates, *fit)) continue;
    additions.incredible.push_back(std::move(*fit));
    fit.reset();
  }
  const std::vector<double> criteria = Criteria(data.problem, fits);
  for (const std::size_t i : OrderOf(data.problem, fits)) {
    additions.hypotheses.push_back({fits[i]->causes.back(), criteria[i], 0.0});
    additions.fits.push_back(std::move(*fits[i]));
  }
  if (additions.fits.empty()) return additions;
  for (const Entry& entry : others) {
    const double behind = entry.criterion - finalists.front().criterion;
    additions.hypotheses.push_back(
        {entry.causes.back(), additions.hypotheses.front().criterion + behind, 0.0});
  }
  return additions;
}

}  // namespace mjdiag
