#include "mjdiag/discovery/regression/moves.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <set>
#include <utility>

#include "mjdiag/discovery/regression/move_search.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Of what a move gains, what is of second order. What resists is at nearly every joint, dry and
// viscous at once: of it what is of second order of that is noise.
constexpr double kShare = 0.03;

}  // namespace

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
  std::vector<WhitenedModels> behind{ModelsBehind(here.noise, 0.0)};
  const std::size_t smaller = here.noise + kSmaller;
  if (!looked_.at_forces && smaller < grams_.size()) {
    const double lost = FitSet(grams_[smaller], ColumnsOf({})).unseen -
                        FitSet(grams_[here.noise], ColumnsOf({})).unseen;
    behind.push_back(ModelsBehind(smaller, lost));
  }
  return PromisingVariations(machine_, along_, behind, blocks_,
                             [this](const Block& block) { return MayCome(block); });
}

WhitenedModels MoveSearch::ModelsBehind(std::size_t noise, double least) const {
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
  return {map, W, set.sd, std::move(models), least};
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

Moves MovesOf(const Machine& machine, const MeasuredRun& run, const FilterPath& path,
              const std::vector<const RowMap*>& maps, std::vector<Block>& blocks,
              const std::vector<Term>& terms, const Column& other_steps,
              Looked looked) {
  return MoveSearch(machine, run, path, maps, blocks, terms, other_steps, looked).Run();
}

}  // namespace mjdiag
