// What a change of a model is worth (move_search.h): columns whitened behind every noise, one
// regression for every change.

#include <algorithm>
#include <utility>

#include "mjdiag/discovery/regression/move_search.h"
#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr int kFolds = 20;

}  // namespace

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

MoveSearch::Change MoveSearch::Completed(Change change) const {
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

}  // namespace mjdiag
