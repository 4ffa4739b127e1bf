#include "mjdiag/discovery/regression/moves.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <set>
#include <utility>

#include "mjdiag/discovery/blocks/curve_block.h"
#include "mjdiag/discovery/blocks/path_motion.h"
#include "mjdiag/discovery/regression/fold_gram.h"
#include "mjdiag/discovery/regression/promising.h"
#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kImpossible = std::numeric_limits<double>::infinity();
constexpr int kFolds = 20;
// Of what a move gains, what is of second order. What resists is at nearly every joint, dry and
// viscous at once: of it what is of second order of that is noise.
constexpr double kShare = 0.03;

/// A change of the model: terms that leave it, variations that come in.
struct Change {
  std::vector<std::size_t> removed;
  std::vector<std::size_t> added;
};

class MoveSearch {
 public:
  MoveSearch(const Machine& machine, const MeasuredRun& run, const FilterPath& path,
             const std::vector<const RowMap*>& maps, std::vector<Block>& blocks,
             const std::vector<Term>& terms, const Column& other_steps, Looked looked)
      : machine_(machine),
        maps_(maps),
        along_{MotionAlong(machine, run, path), path.noise.reading,
               run.Time().maxCoeff(), path.dofs},
        blocks_(blocks),
        terms_(terms),
        other_steps_(other_steps),
        looked_(looked) {}

  Moves Run();

 private:
  struct Scored {
    Change change;
    double score = kImpossible;
    std::size_t noise = 0;
    bool other_steps = false;
    SetFit fit;
  };
  void Whiten();
  /// Behind those of the terms.
  Index OtherStepsColumn() const {
    return terms_.empty()
               ? 0
               : first_of_term_.back() + std::ssize(terms_.back().columns) + 1;
  }
  SetOfColumns ColumnsOf(const Change& change) const;
  /// Errors of readings do no force: where forces are looked at, nothing is known of them.
  bool MayLeave(std::size_t term) const {
    return !IsBesideItsCurve(term) &&
           (!looked_.at_forces || !terms_[term].removed.states.empty());
  }
  bool IsBesideItsCurve(std::size_t term) const {
    return std::ranges::any_of(terms_, [&](const Term& other) {
      return IsCurveOf(blocks_[other.block], blocks_[terms_[term].block]);
    });
  }
  /// Terms that may leave for one that comes in.
  std::vector<std::vector<std::size_t>> LeavingTogether() const;
  std::vector<Variation> Promising(const Scored& here) const;
  /// Behind one of the noises.
  /// @param least  what they have to gain there, beside their prices
  std::vector<Variation> PromisingBehind(std::size_t noise, double least) const;
  /// What comes in with its amplitudes, the last first.
  /// @param amplitudes  of all columns, those of what comes in last
  std::vector<std::pair<const Variation&, VectorXd>> AddedOf(
      const Change& change, const VectorXd& amplitudes) const;
  bool IsWithinBounds(const Change& change, const VectorXd& amplitudes) const;
  /// Whether each of what comes in is worth its price by what folds have in common.
  bool IsRepeated(const Change& change, const Scored& scored) const;
  /// What sizes cost.
  double SizesOf(const Change& change, const SetOfColumns& set,
                 const VectorXd& amplitudes) const;
  /// Whether a variation can come in beside those of a change.
  bool IsApart(const Change& change, std::size_t variation) const;
  static Change With(Change change, std::size_t variation) {
    change.added.push_back(variation);
    return change;
  }
  /// Whether it is looked at beside what is in.
  bool MayCome(const Block& block) const;
  /// With what a group that comes in takes the place of.
  Change Completed(Change change) const;
  /// @param asks_folds  whether each of what comes in has to be worth its price
  Scored ScoreOf(const Change& change, bool asks_folds = true) const;
  std::vector<Scored> ScoresOf(std::vector<Change> changes) const;
  /// Further members come in at once as long as each brings a share of what the others do,
  /// beside which what is of second order is little.
  /// @param may  which blocks
  void Extend(Scored& best, double share,
              const std::function<bool(const Block&)>& may) const;
  /// What resists a joint is dry and viscous: one of them alone makes up for the other. Both
  /// come in where what the other costs is of second order; fits take out what is not there.
  void CompleteResistances(Scored& best) const;
  void Keep(const std::vector<Scored>& scored);

  const Machine& machine_;
  const std::vector<const RowMap*>& maps_;
  BlockMotion along_;
  std::vector<Block>& blocks_;
  const std::vector<Term>& terms_;
  const Column& other_steps_;
  Looked looked_;
  std::vector<Variation> kept_;
  std::vector<Index> first_of_term_, first_of_kept_;
  std::vector<FoldGram> grams_;
  Moves moves_;
};

void MoveSearch::Whiten() {
  std::vector<const Column*> columns;
  first_of_term_.clear();
  first_of_kept_.clear();
  for (const Term& term : terms_) {
    first_of_term_.push_back(std::ssize(columns));
    for (const Column& column : term.columns) columns.push_back(&column);
    columns.push_back(&term.removed);
  }
  columns.push_back(&other_steps_);
  for (const Variation& one : kept_) {
    first_of_kept_.push_back(std::ssize(columns));
    for (const Column& column : one.columns) columns.push_back(&column);
  }
  grams_.clear();
  for (const RowMap* map : maps_) {
    grams_.push_back(GramOf(*map, columns, kFolds));
  }
}

bool MoveSearch::IsApart(const Change& change, std::size_t variation) const {
  const Block& block = blocks_[kept_[variation].block];
  const auto is_curve = [&](std::size_t v) { return IsCurve(blocks_[kept_[v].block]); };
  // A force without a name is all that is left, or there is a name for it.
  if (!change.added.empty() &&
      (is_curve(variation) || std::ranges::any_of(change.added, is_curve))) {
    return false;
  }
  if (std::ranges::any_of(change.removed, [&](std::size_t t) {
        return IsCurveOf(block, blocks_[terms_[t].block]);
      })) {
    return false;
  }
  return std::ranges::none_of(change.added, [&](std::size_t v) {
    // Two of one block are two waves; of anything else two points of its grid.
    return v == variation ||
           (kept_[v].block == kept_[variation].block && !block.IsWave()) ||
           (!block.group.empty() && block.group == blocks_[kept_[v].block].group);
  });
}

// The shape of a resistance shows where the velocity changes its sign, which no filter
// knows that lacks it: first the simplest comes in, and then, along the motion with that, the
// others in its place, those of other kinds, too: a brake that gives way as it gets faster looks
// like dry friction at first. Where nothing simple is left, all of them. What has no shape is in
// with all that it can be.
bool MoveSearch::MayCome(const Block& block) const {
  const auto any = [&](const auto& is) {
    return std::ranges::any_of(
        terms_, [&](const Term& term) { return is(blocks_[term.block]); });
  };
  if (!block.HasShape() && any([&](const Block& in) { return &in == &block; })) {
    return false;
  }
  // What cancels the inputs explains a machine that hardly moves, whatever holds it, and noise
  // of inputs that it did not feel: friction that grows with the motor's force does, too.
  if (looked_.at_forces) {
    if (block.IsOfDrive() || block.GrowsWithLoad()) return false;
    if (looked_.inputs_are_noise && block.IsInertia()) return false;
  }
  return looked_.at_every_shape || !block.IsResistance() || block.IsSimplest() ||
         any([&](const Block& in) { return in.resists == block.resists; });
}

Change MoveSearch::Completed(Change change) const {
  for (const std::size_t v : change.added) {
    const std::string& group = blocks_[kept_[v].block].group;
    if (group.empty()) continue;
    for (std::size_t t = 0; t < terms_.size(); ++t) {
      if (blocks_[terms_[t].block].group != group) continue;
      if (std::ranges::find(change.removed, t) == change.removed.end()) {
        change.removed.push_back(t);
      }
    }
  }
  std::ranges::sort(change.removed);
  return change;
}

SetOfColumns MoveSearch::ColumnsOf(const Change& change) const {
  SetOfColumns set;
  std::vector<double> sd, mean;
  for (std::size_t t = 0; t < terms_.size(); ++t) {
    const Term& term = terms_[t];
    const Index count = std::ssize(term.columns);
    if (std::ranges::find(change.removed, t) != change.removed.end()) {
      set.given.push_back(first_of_term_[t] + count);
      continue;
    }
    for (Index i = 0; i < count; ++i) {
      set.columns.push_back(first_of_term_[t] + i);
      sd.push_back(term.sd[i]);
      mean.push_back(term.mean[i]);
      set.known.push_back(term.known[static_cast<std::size_t>(i)]);
    }
  }
  for (const std::size_t v : change.added) {
    for (Index i = 0; i < kept_[v].sd.size(); ++i) {
      set.columns.push_back(first_of_kept_[v] + i);
      sd.push_back(kept_[v].sd[i]);
      mean.push_back(0.0);
    }
  }
  set.sd = VectorXd::Map(sd.data(), std::ssize(sd));
  set.mean = VectorXd::Map(mean.data(), std::ssize(mean));
  return set;
}

std::vector<std::pair<const Variation&, VectorXd>> MoveSearch::AddedOf(
    const Change& change, const VectorXd& amplitudes) const {
  std::vector<std::pair<const Variation&, VectorXd>> added;
  Index last = amplitudes.size();
  for (std::size_t i = change.added.size(); i-- > 0;) {
    const Variation& one = kept_[change.added[i]];
    last -= one.sd.size();
    added.emplace_back(one, amplitudes.segment(last, one.sd.size()));
  }
  return added;
}

bool MoveSearch::IsWithinBounds(const Change& change,
                                const VectorXd& amplitudes) const {
  for (const auto& [one, a] : AddedOf(change, amplitudes)) {
    if (one.least.size() > 0 && (a.array() < one.least.array()).any()) return false;
    if (!IsAllowed(blocks_[one.block], one.values(a))) return false;
  }
  return true;
}

bool MoveSearch::IsRepeated(const Change& change, const Scored& scored) const {
  SetOfColumns set = ColumnsOf(change);
  if (scored.other_steps) set.given.push_back(OtherStepsColumn());
  Index first = std::ssize(set.columns);
  for (std::size_t i = change.added.size(); i-- > 0;) {
    const Variation& one = kept_[change.added[i]];
    first -= one.sd.size();
    const double worth =
        WorthOf(grams_[scored.noise], set, scored.fit, first, one.sd.size());
    if (worth < blocks_[one.block].price) return false;
  }
  return true;
}

double MoveSearch::SizesOf(const Change& change, const SetOfColumns& set,
                           const VectorXd& amplitudes) const {
  double sum = 0.0;
  for (const auto& [one, a] : AddedOf(change, amplitudes)) {
    const RegressorValues values = one.values(a);
    if (values) sum += SizePrice(blocks_[one.block], *values);
  }
  for (std::size_t i = 0; i < set.known.size(); ++i) {
    const auto place = static_cast<Index>(i);
    if (set.known[i]) sum += SizePrice(amplitudes[place] - set.mean[place]);
  }
  return sum;
}

MoveSearch::Scored MoveSearch::ScoreOf(const Change& change, bool asks_folds) const {
  Scored best;
  best.change = change;
  SetOfColumns set = ColumnsOf(change);
  double price = 0.0;
  for (std::size_t t = 0; t < terms_.size(); ++t) {
    const bool is_in = std::ranges::find(change.removed, t) == change.removed.end();
    if (is_in) price += blocks_[terms_[t].block].price;
  }
  for (const std::size_t v : change.added) price += blocks_[kept_[v].block].price;
  for (const bool other_steps : {false, true}) {
    if (other_steps) set.given.push_back(OtherStepsColumn());
    for (std::size_t r = 0; r < grams_.size(); ++r) {
      SetFit fit = FitSet(grams_[r], set);
      const double score = fit.unseen + price + SizesOf(change, set, fit.amplitudes);
      if (!(score < best.score)) continue;
      best.score = score;
      best.noise = r;
      best.other_steps = other_steps;
      best.fit = std::move(fit);
    }
  }
  // Without a fit there are no amplitudes.
  if (best.score < kImpossible && (!IsWithinBounds(change, best.fit.amplitudes) ||
                                   (asks_folds && !IsRepeated(change, best)))) {
    best.score = kImpossible;
  }
  return best;
}

std::vector<MoveSearch::Scored> MoveSearch::ScoresOf(
    std::vector<Change> changes) const {
  std::vector<Scored> scored(changes.size());
  ParallelFor(static_cast<int>(changes.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    scored[i] = ScoreOf(Completed(std::move(changes[i])));
  });
  std::ranges::sort(scored, {}, &Scored::score);
  return scored;
}

void MoveSearch::Keep(const std::vector<Scored>& scored) {
  for (const Scored& one : scored) {
    if (!(one.score < moves_.score + kNear)) continue;
    ModelMove move{one.change.removed, {}, one.score, one.noise, one.other_steps};
    for (const auto& [variation, a] : AddedOf(one.change, one.fit.amplitudes)) {
      move.added.push_back({variation, a});
    }
    const bool is_better = one.score < moves_.score;
    // Nobody fits the others.
    if (!is_better) {
      for (Added& added : move.added) added.variation.columns.clear();
    }
    (is_better ? moves_.best : moves_.near).push_back(std::move(move));
  }
}

// One in the place of two, or of all, is what a regression that takes one after the other
// does not see.
std::vector<std::vector<std::size_t>> MoveSearch::LeavingTogether() const {
  constexpr std::size_t kMostInPairs = 6;
  std::vector<std::vector<std::size_t>> sets;
  const std::size_t count = terms_.size();
  for (std::size_t t = 0; t < count; ++t) {
    if (MayLeave(t)) sets.push_back({t});
  }
  for (std::size_t t = 0; t < count && count <= kMostInPairs; ++t) {
    for (std::size_t s = t + 1; s < count; ++s) {
      if (MayLeave(t) && MayLeave(s)) sets.push_back({t, s});
    }
  }
  if (count > 2) {
    std::vector<std::size_t> all;
    for (std::size_t t = 0; t < count; ++t) {
      if (MayLeave(t)) all.push_back(t);
    }
    if (all.size() > 2) sets.push_back(std::move(all));
  }
  return sets;
}

// Behind the latent forces that a model needs which lacks something they do what is missing:
// what would make them needless is seen behind smaller ones.
std::vector<Variation> MoveSearch::Promising(const Scored& here) const {
  constexpr std::size_t kSmaller = 2;  // of NoisesFrom
  std::vector<Variation> kept = PromisingBehind(here.noise, 0.0);
  const std::size_t smaller = here.noise + kSmaller;
  if (looked_.at_forces || smaller >= grams_.size()) return kept;
  const double lost = FitSet(grams_[smaller], ColumnsOf({})).unseen -
                      FitSet(grams_[here.noise], ColumnsOf({})).unseen;
  for (Variation& one : PromisingBehind(smaller, lost)) {
    const bool is_known = std::ranges::any_of(kept, [&](const Variation& other) {
      return other.block == one.block && other.shape == one.shape;
    });
    if (!is_known) kept.push_back(std::move(one));
  }
  return kept;
}

std::vector<Variation> MoveSearch::PromisingBehind(std::size_t noise,
                                                   double least) const {
  const RowMap& map = *maps_[noise];
  const SetOfColumns set = ColumnsOf({});
  const SetFit fit = FitSet(grams_[noise], set);
  std::vector<const Column*> columns;
  std::vector<std::size_t> of_term;
  for (std::size_t t = 0; t < terms_.size(); ++t) {
    for (const Column& column : terms_[t].columns) {
      columns.push_back(&column);
      of_term.push_back(t);
    }
  }
  const MatrixXd W = map.Of(columns);
  const MatrixXd G = W.transpose() * W;
  columns.clear();
  for (const Term& term : terms_) columns.push_back(&term.removed);
  const MatrixXd without = map.Of(columns);
  const auto model_without = [&](const std::vector<std::size_t>& removed) {
    WhitenedModel model{map.left(), {}, {}};
    for (const std::size_t t : removed) model.left -= without.col(Index(t));
    for (std::size_t i = 0; i < of_term.size(); ++i) {
      const bool is_out = std::ranges::find(removed, of_term[i]) != removed.end();
      (is_out ? model.removed : model.in).push_back(static_cast<Index>(i));
    }
    // What stays in does what it can.
    if (removed.empty() && W.cols() > 0) model.left -= W * fit.amplitudes;
    if (!removed.empty() && !model.in.empty()) {
      const MatrixXd in = W(Eigen::indexing::all, model.in);
      MatrixXd H = G(model.in, model.in);
      H.diagonal() += VectorXd(set.sd(model.in)).cwiseAbs2().cwiseInverse();
      model.left -= in * H.llt().solve(in.transpose() * model.left);
    }
    return model;
  };
  std::vector<WhitenedModel> models{model_without({})};
  for (const std::vector<std::size_t>& removed : LeavingTogether()) {
    models.push_back(model_without(removed));
  }
  return PromisingVariations(machine_, along_, map, W, set.sd, models, least, blocks_,
                             [this](const Block& block) { return MayCome(block); });
}

void MoveSearch::Extend(Scored& best, double share,
                        const std::function<bool(const Block&)>& may) const {
  for (;;) {
    std::vector<Change> changes;
    for (std::size_t v = 0; v < kept_.size(); ++v) {
      if (may(blocks_[kept_[v].block]) && IsApart(best.change, v)) {
        changes.push_back(With(best.change, v));
      }
    }
    std::vector<Scored> further = ScoresOf(std::move(changes));
    if (further.empty()) return;
    const double least = std::max(kLeastGain, share * (moves_.score - best.score));
    if (!(further.front().score < best.score - least)) return;
    best = std::move(further.front());
  }
}

void MoveSearch::CompleteResistances(Scored& best) const {
  const Change found = best.change;
  for (std::size_t v = 0; v < kept_.size(); ++v) {
    const Block& block = blocks_[kept_[v].block];
    if (!block.IsResistance() || !block.IsSimplest() || !IsApart(best.change, v)) {
      continue;
    }
    if (std::ranges::none_of(found.added, [&](std::size_t other) {
          return blocks_[kept_[other].block].resists == block.resists;
        })) {
      continue;
    }
    Scored whole = ScoreOf(Completed(With(best.change, v)), false);
    const double gained = moves_.score - best.score;
    if (whole.score < best.score + kShare * gained) best = std::move(whole);
  }
}

Moves MoveSearch::Run() {
  Whiten();
  const Scored here = ScoreOf({});
  moves_.score = here.score;
  moves_.noise = here.noise;
  moves_.other_steps = here.other_steps;
  kept_ = Promising(here);
  moves_.variations = std::ssize(kept_);
  Whiten();

  std::vector<Change> changes;
  for (std::size_t v = 0; v < kept_.size(); ++v) changes.push_back({{}, {v}});
  std::vector<Scored> all = ScoresOf(changes);
  // Two that say something together only.
  constexpr std::size_t kBeam = 6;
  changes.clear();
  for (std::size_t i = 0; i < std::min(kBeam, all.size()); ++i) {
    for (std::size_t v = 0; v < kept_.size(); ++v) {
      if (IsApart(all[i].change, v)) changes.push_back(With(all[i].change, v));
    }
  }
  std::ranges::move(ScoresOf(changes), std::back_inserter(all));
  std::ranges::sort(all, {}, &Scored::score);
  // Six joints that rub are no six moves.
  if (!all.empty() && all.front().score < moves_.score) {
    Extend(all.front(), kShare, [](const Block&) { return true; });
    Extend(all.front(), kShare * kShare, [](const Block& block) {
      return block.IsResistance() && block.IsSimplest();
    });
    CompleteResistances(all.front());
  }
  changes.clear();
  for (const std::vector<std::size_t>& removed : LeavingTogether()) {
    if (removed.size() == 1) changes.push_back({removed, {}});
    for (std::size_t v = 0; v < kept_.size(); ++v) {
      if (IsApart({removed, {}}, v)) changes.push_back({removed, {v}});
    }
  }
  std::ranges::move(ScoresOf(changes), std::back_inserter(all));
  std::ranges::sort(all, {}, &Scored::score);
  Keep(all);
  // The best of those that say the same.
  std::set<std::pair<std::vector<std::size_t>, std::multiset<std::size_t>>> seen;
  for (std::vector<ModelMove>* moves : {&moves_.best, &moves_.near}) {
    std::erase_if(*moves, [&](const ModelMove& move) {
      std::multiset<std::size_t> names;
      for (const Added& added : move.added) names.insert(added.variation.block);
      return !seen.insert({move.removed, names}).second;
    });
  }
  return std::move(moves_);
}

}  // namespace

Moves MovesOf(const Machine& machine, const MeasuredRun& run, const FilterPath& path,
              const std::vector<const RowMap*>& maps, std::vector<Block>& blocks,
              const std::vector<Term>& terms, const Column& other_steps,
              Looked looked) {
  return MoveSearch(machine, run, path, maps, blocks, terms, other_steps, looked).Run();
}

}  // namespace mjdiag
