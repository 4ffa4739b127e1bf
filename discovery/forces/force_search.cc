#include "mjdiag/discovery/forces/force_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "mjdiag/discovery/forces/force_columns.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// A law has to make the record that much likelier, in -2 ln L beyond its cost; and unseen
// motion: odds of 20.
constexpr double kLeastGain = 6.0;

class Search {
 public:
  Search(const DiscoveryProblem& problem, const std::vector<Candidate>& candidates,
         const FilteredRun& filtered, const ForceBalance& balance,
         const ForceSearchOptions& options)
      : problem_(problem),
        candidates_(candidates),
        options_(options),
        columns_(problem, filtered, balance) {
    Report("numbers of the plant", 0.0);
    forces_ = columns_.NumbersAlone();
    silenced_ = VectorXd::Zero(forces_.numbers.cols());
    Refit();
    Silence();
    Report("laws along the motion", 0.1);
    tried_ = columns_.TrialsOf(candidates);
  }

  ForceSearchResult Run();

 private:
  void Report(const std::string& what, double fraction) const {
    if (options_.progress) options_.progress(what, fraction, CausesOf(set_, fit_));
  }
  std::vector<const ForceGroup*> GroupsOf(const std::vector<std::size_t>& set) const;
  ForceFit Fit(const std::vector<std::size_t>& set) const;
  double ScoreOf(const std::vector<std::size_t>& set, const ForceFit& fit) const;
  std::vector<FittedCause> CausesOf(const std::vector<std::size_t>& set,
                                    const ForceFit& fit) const;
  struct Best {
    std::size_t group = 0;
    ForceFit fit;
    double score = std::numeric_limits<double>::infinity();
  };
  std::vector<Best> BestBeside(const std::vector<std::size_t>& set, const ForceFit& fit,
                               const std::vector<std::size_t>& tried, std::size_t count,
                               std::size_t place) const;
  void Refit() {
    fit_ = Fit(set_);
    score_ = ScoreOf(set_, fit_);
  }
  bool Silence();
  bool Add();
  bool LeaveOut();
  bool Exchange();
  bool KeepWhatIsNeededUnseen();
  bool Take(std::vector<std::size_t> set, ForceFit fit, double score) {
    set_ = std::move(set);
    fit_ = std::move(fit);
    score_ = score;
    return true;
  }

  const DiscoveryProblem& problem_;
  const std::vector<Candidate>& candidates_;
  const ForceSearchOptions& options_;
  ForceColumns columns_;
  VectorXd silenced_;  // z of a plant that sticks only where rows are silent
  ForceProblem forces_;
  std::vector<ForceTrial> tried_;
  std::vector<std::size_t> set_;
  ForceFit fit_;
  double score_ = 0.0;
  std::vector<std::vector<ForceRival>> rivals_;
  std::set<std::size_t> forbidden_;  // candidates that unseen motion speaks against
};

std::vector<const ForceGroup*> Search::GroupsOf(
    const std::vector<std::size_t>& set) const {
  std::vector<const ForceGroup*> groups;
  for (const std::size_t g : set) groups.push_back(&tried_[g].group);
  return groups;
}

ForceFit Search::Fit(const std::vector<std::size_t>& set) const {
  return FitForces(forces_, GroupsOf(set),
                   fit_.noise.phi.size() > 0 ? fit_.noise : NoiseOfNothing(forces_));
}

std::vector<FittedCause> Search::CausesOf(const std::vector<std::size_t>& set,
                                          const ForceFit& fit) const {
  std::vector<FittedCause> causes;
  Index next = 0;
  for (const std::size_t g : set) {
    const Index size = tried_[g].group.columns.cols();
    const TrialValues values = tried_[g].values(fit.amplitudes.segment(next, size));
    next += size;
    if (!values) return {};
    causes.push_back(Bounded(candidates_, {tried_[g].candidate, *values}));
  }
  return causes;
}

/// With what is known of the sizes.
double Search::ScoreOf(const std::vector<std::size_t>& set, const ForceFit& fit) const {
  if (!std::isfinite(fit.score)) return fit.score;
  const std::vector<FittedCause> causes = CausesOf(set, fit);
  if (causes.size() != set.size()) return std::numeric_limits<double>::infinity();
  double score = fit.score;
  for (const FittedCause& cause : causes) {
    // It asks for another law.
    if (IsAtItsEnd(candidates_, cause)) return std::numeric_limits<double>::infinity();
    score += SizePriorOf(candidates_, cause);
  }
  return score;
}

/// The best of some groups beside a set, each candidate once, in order. To what lasts as
/// long as the noise of the present fit a law that lasts is worth little: the first ones by
/// noise without a memory are fitted, too.
std::vector<Search::Best> Search::BestBeside(const std::vector<std::size_t>& set,
                                             const ForceFit& fit,
                                             const std::vector<std::size_t>& tried,
                                             std::size_t count,
                                             std::size_t place) const {
  // Two products with what the set does, for every column.
  problem_.work()->Add(
      FilterWork(4.0 * static_cast<double>(forces_.rows.rows()) *
                 static_cast<double>(tried.size()) *
                 static_cast<double>(fit.z.size() + fit.amplitudes.size() + 4)));
  std::vector<Best> best;
  std::set<std::size_t> known;
  const auto take = [&](const ForceFit& at, std::size_t most) {
    const VectorXd gains = GainsBeside(forces_, GroupsOf(set), at, GroupsOf(tried));
    std::vector<std::size_t> order(tried.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::stable_sort(order, std::greater<>(), [&](std::size_t i) {
      return gains[static_cast<Index>(i)];
    });
    for (const std::size_t i : order) {
      if (best.size() == most || !std::isfinite(gains[static_cast<Index>(i)])) break;
      if (!known.insert(tried_[tried[i]].candidate).second) continue;
      best.push_back({tried[i], {}, 0.0});
    }
  };
  take(fit, count);
  ForceFit forgetful = fit;
  forgetful.noise = WithoutMemory(fit.noise);
  take(forgetful, best.size() + count / 2);
  ParallelFor(static_cast<int>(best.size()), [&](int number) {
    Best& one = best[static_cast<std::size_t>(number)];
    std::vector<std::size_t> more = set;
    more.insert(more.begin() + static_cast<std::ptrdiff_t>(place), one.group);
    one.fit = Fit(more);
    one.score = ScoreOf(more, one.fit);
  });
  std::ranges::stable_sort(best, std::less<>(), &Best::score);
  return best;
}

/// True if the friction of the plant was found to be another one, with which other rows say
/// nothing: the fit is another one then.
bool Search::Silence() {
  constexpr double kNear = 0.05;  // of a number
  const auto& numbers = problem_.numbers();
  bool moved = false;
  for (Index i = 0; i < fit_.z.size(); ++i) {
    const DoubtedNumber& doubted = numbers[static_cast<std::size_t>(i)];
    if (doubted.is_lateness || !IsFriction(doubted.number.kind)) continue;
    moved = moved || doubted.spread * std::abs(fit_.z[i] - silenced_[i]) > kNear;
  }
  if (!moved) return false;
  silenced_ = fit_.z;
  try {
    columns_.SilenceAt(fit_.z, forces_);
  } catch (const NumericalError&) {
    return false;
  }
  Refit();
  return true;
}

bool Search::Add() {
  constexpr std::size_t kBest = 6;
  std::vector<std::size_t> tried;
  std::set<std::size_t> has = forbidden_;
  std::map<Index, int> of_joint;
  for (const std::size_t g : set_) {
    has.insert(tried_[g].candidate);
    for (const Index j : tried_[g].joints) ++of_joint[j];
  }
  for (std::size_t g = 0; g < tried_.size(); ++g) {
    if (has.contains(tried_[g].candidate)) continue;
    const std::set<Index>& joints = tried_[g].joints;
    if (std::ranges::any_of(joints, [&](Index j) {
          return of_joint[j] >= options_.most_causes_a_joint;
        })) {
      continue;
    }
    tried.push_back(g);
  }
  const std::vector<Best> best = BestBeside(set_, fit_, tried, kBest, set_.size());
  if (best.empty() || best.front().score > score_ - kLeastGain) return false;
  std::vector<std::size_t> more = set_;
  more.push_back(best.front().group);
  return Take(std::move(more), best.front().fit, best.front().score);
}

/// The law that is needed least, if it is not.
bool Search::LeaveOut() {
  std::vector<ForceFit> fits(set_.size());
  std::vector<double> scores(set_.size());
  const auto without = [&](std::size_t i) {
    std::vector<std::size_t> fewer = set_;
    fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(i));
    return fewer;
  };
  ParallelFor(static_cast<int>(set_.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    const std::vector<std::size_t> fewer = without(i);
    fits[i] = Fit(fewer);
    scores[i] = ScoreOf(fewer, fits[i]);
  });
  const auto best = std::ranges::min_element(scores);
  if (best == scores.end() || *best > score_ + kLeastGain / 2.0) return false;
  const auto i = static_cast<std::size_t>(best - scores.begin());
  return Take(without(i), fits[i], scores[i]);
}

/// Another candidate, or another trial of the same, in the place of each; what could be
/// there is kept.
bool Search::Exchange() {
  constexpr std::size_t kBest = 5;
  bool changed = false;
  rivals_.assign(set_.size(), {});
  for (std::size_t i = 0; i < set_.size(); ++i) {
    std::vector<std::size_t> rest = set_;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
    std::set<std::size_t> has = forbidden_;
    for (const std::size_t g : rest) has.insert(tried_[g].candidate);
    const std::set<Index>& place = tried_[set_[i]].joints;
    std::vector<std::size_t> tried;
    for (std::size_t g = 0; g < tried_.size(); ++g) {
      if (!has.contains(tried_[g].candidate) && tried_[g].joints == place)
        tried.push_back(g);
    }
    const std::vector<Best> best = BestBeside(rest, Fit(rest), tried, kBest, i);
    rivals_[i].clear();
    for (const Best& one : best) {
      if (!std::isfinite(one.score)) continue;
      std::vector<std::size_t> other = set_;
      other[i] = one.group;
      rivals_[i].push_back({CausesOf(other, one.fit)[i], one.score});
    }
    if (best.empty() || best.front().group == set_[i] ||
        best.front().score > score_ - 1.0) {
      continue;
    }
    std::vector<std::size_t> other = set_;
    other[i] = best.front().group;
    changed = Take(std::move(other), best.front().fit, best.front().score);
  }
  return changed;
}

/// Whatever it explains of what was fitted, a law that does not help to predict is none, and
/// is not looked at again. It was chosen among others on what is predicted, too: by no less
/// than that costs. True if there was one.
bool Search::KeepWhatIsNeededUnseen() {
  bool changed = false;
  while (!set_.empty()) {
    VectorXd worth = LossUnseen(forces_, GroupsOf(set_), fit_).each;
    for (std::size_t i = 0; i < set_.size(); ++i) {
      worth[static_cast<Index>(i)] -= tried_[set_[i]].group.cost;
    }
    Index least = 0;
    if (worth.minCoeff(&least) > 0.0) break;
    changed = true;
    forbidden_.insert(tried_[set_[static_cast<std::size_t>(least)]].candidate);
    set_.erase(set_.begin() + least);
    Refit();
  }
  return changed;
}

ForceSearchResult Search::Run() {
  constexpr int kRounds = 6;
  ForceSearchResult result;
  result.numbers_alone = fit_.z;
  for (int round = 0; round < kRounds; ++round) {
    while (Add()) Report("laws along the motion", 0.2);
    Report("other laws in their places", 0.6);
    bool changed = Exchange();
    while (LeaveOut()) changed = true;
    if (Silence()) changed = true;
    if (!changed && !KeepWhatIsNeededUnseen()) break;
  }
  KeepWhatIsNeededUnseen();
  Exchange();
  result.model.causes = CausesOf(set_, fit_);
  result.model.numbers = columns_.NumbersOf(fit_.z);
  result.rivals = rivals_;
  UnseenLoss loss = LossUnseen(forces_, GroupsOf(set_), fit_);
  result.loss = std::move(loss.each);
  result.loss_of_all = loss.all;
  result.rows = forces_.rows;
  result.noise = fit_.noise;
  result.numbers = NumbersBeside(forces_, GroupsOf(set_), fit_);
  return result;
}

}  // namespace

double ForceSearchResult::ExplainedUnseen() const {
  const auto left = static_cast<double>(rows.train * std::ssize(rows.dofs));
  return loss_of_all / (loss_of_all + left);
}

ForceSearchResult SearchForces(const DiscoveryProblem& problem,
                               const std::vector<Candidate>& candidates,
                               const FilteredRun& filtered, const ForceBalance& balance,
                               const ForceSearchOptions& options) {
  return Search(problem, candidates, filtered, balance, options).Run();
}

}  // namespace mjdiag
