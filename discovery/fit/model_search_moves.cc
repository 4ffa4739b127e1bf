// The best of the moves that a model search may make: fitted behind kept gains, and the best of
// those settled behind noises of their own.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mjdiag/discovery/fit/converged_model.h"
#include "mjdiag/discovery/fit/model_search.h"
#include "mjdiag/discovery/fit/moved_model.h"
#include "mjdiag/discovery/fit/pruned_fit.h"
#include "mjdiag/discovery/regression/force_moves.h"
#include "mjdiag/discovery/regression/moves.h"
#include "mjdiag/discovery/regression/whitenings.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

namespace {

// Of fits behind the gains of another model, which the best are fitted anew behind their own: as
// many as two laws take that say nearly the same, of which one leaves.
constexpr int kIterations = 6;
// Kept gains tell what is gained to a factor of two: a fit need not tell it to a hundredth.
constexpr double kLittle = 0.02;
// What loses so many times what first order promised is what that knows nothing of.
constexpr double kNonsense = 10.0;
/// Whether nobody would miss what a move adds.
bool IsIdle(const ModelMove& move, const Negligible& negligible) {
  if (move.added.empty()) return false;
  std::vector<ScaledColumn> columns;
  for (const Added& added : move.added) {
    const std::vector<Column>& of_one = added.variation.columns;
    for (std::size_t i = 0; i < of_one.size(); ++i) {
      columns.emplace_back(added.amplitudes[static_cast<Eigen::Index>(i)], &of_one[i]);
    }
  }
  return negligible.IsForce(columns) && negligible.IsError(columns);
}

// From there a fit goes the same way.
constexpr double kAsNear = 1e-3;

FitEffort EffortFor(const Moves& moves, int iterations) {
  const double promised =
      moves.best.empty() ? 0.0 : moves.score - moves.best.front().score;
  return {iterations, std::max(FitEffort().end, kLittle * promised)};
}

}  // namespace

/// The model as it is behind the noise that suits it by now; none if nothing is gained, or a
/// tenth of what a move promises: it is settled then with that.
std::optional<ConvergedModel> ModelSearch::ConvergedAnew(
    const Whitenings& whitenings, const Moves& moves, const ModelFit& as_it_is) const {
  constexpr double kShare = 0.1;
  const double promised =
      moves.best.empty() ? 0.0 : moves.score - moves.best.front().score;
  const double least = std::max(kLeastGain, kShare * promised);
  const KeptGains& own = whitenings.behind.front().gains();
  const double before = own.left.squaredNorm() + own.log_determinant +
                        found_.fit.prior + found_.fit.occam;
  if (as_it_is.score() > before - least) return std::nullopt;
  ConvergedModel settled =
      Settle(Beside(steps_), as_it_is, NoisesBeside(whitenings.noises[moves.noise]),
             found_.score, before - as_it_is.score());
  if (settled.score() > found_.score - kLeastGain) return std::nullopt;
  Say("settled: " + Difference(settled.score()));
  return settled;
}

bool ModelSearch::IsForAll(const Moves& moves) const {
  constexpr double kLarge = 100.0;
  return IsFirstLook() &&
         (moves.best.empty() || moves.score - moves.best.front().score < kLarge);
}

std::optional<ModelSearch::Proposal> ModelSearch::BestForces(Standing& standing) {
  const Moves moves = ForceMovesOf(
      With(found_.fit.model), run_, found_.path, found_.blocks, standing.exact.terms,
      {.at_every_shape = at_every_shape_,
       .inputs_are_noise = found_.input_width == 0.0 && inputs_are_noise_});
  Say(std::to_string(moves.variations) + " shapes of forces, " +
      std::to_string(moves.best.size()) + " moves");
  if (IsForAll(moves)) return std::nullopt;
  // Behind the latent forces of a machine that lacks so much a fit hardly sees what is slow:
  // values are those of the regression until the filter has been run with them.
  constexpr std::size_t kMost = 3;
  // What has just been settled is behind the noise that suits it.
  AsFitted none;
  return BestOf(moves, kMost, 0, standing.whitenings, none, found_.fit.model.empty());
}

std::optional<ModelSearch::Proposal> ModelSearch::BestMove(Standing& standing) {
  const Moves& moves = MovesNow(standing);
  if (TakeStepsBehind(standing, moves.noise)) return Incumbent();
  KeepRivals(moves);
  if (IsForAll(moves)) return std::nullopt;
  const Whitenings& whitenings = standing.whitenings;
  const ModelFit& own =
      IncumbentBehind({moves.noise, false}, whitenings, moves, standing.as_fitted);
  if (auto settled = ConvergedAnew(whitenings, moves, own)) {
    return Proposal{std::move(*settled), steps_, found_.input_width, run_};
  }
  Say(std::to_string(moves.variations) + " shapes, " +
      std::to_string(moves.best.size()) + " moves");
  return BestOf(moves, 4, kIterations, whitenings, standing.as_fitted, false);
}

Negligible ModelSearch::NegligibleNow() {
  const Standing& standing = StandingNow();
  std::vector<ScaledColumn> members;
  for (const Term& term : standing.exact.terms) {
    members.emplace_back(1.0, &term.removed);
  }
  const Column* steps = steps_.without > 0.0 ? &standing.exact.other_steps : nullptr;
  return {machine_, found_.path, reading_sd_, members, steps};
}

ModelFit ModelSearch::Fitted(const Model& model, const Whitenings& whitenings,
                             const Judged& judged, FitEffort effort) const {
  const PhysicsSteps steps = judged.second ? steps_.Other() : steps_;
  return FitModel(InTime([&](const Model& one) { return With(one, steps); },
                         [this] { return IsOver(); }),
                  run_, found_.path, whitenings.behind[judged.first].gains(),
                  found_.blocks, model, effort);
}

const ModelFit& ModelSearch::IncumbentBehind(const Judged& judged,
                                             const Whitenings& whitenings,
                                             const Moves& moves,
                                             AsFitted& known) const {
  const auto found = known.find(judged);
  if (found != known.end()) return found->second;
  ModelFit fit =
      Fitted(found_.fit.model, whitenings, judged, EffortFor(moves, kIterations));
  return known.emplace(judged, std::move(fit)).first->second;
}

std::optional<ModelSearch::Proposal> ModelSearch::BestOf(
    const Moves& moves, std::size_t most, int iterations, const Whitenings& whitenings,
    AsFitted& as_it_is, bool beside_itself) {
  struct Attempt {
    Model model;
    const ModelMove* move = nullptr;
    std::optional<ModelFit> fit;
    Judged JudgedBehind(std::size_t noises) const {
      return {std::min(move->noise, noises - 1), move->other_steps};
    }
  };
  const std::size_t noises = whitenings.behind.size();
  std::vector<Attempt> attempts;
  const FitEffort effort = EffortFor(moves, iterations);
  const Negligible negligible = NegligibleNow();
  const ModelMove* best_idle = nullptr;
  const auto may_be = [&](const ModelMove& move) {
    if (!MayBe(move) || PromisesNothing(move, moves.score - move.score)) return false;
    const bool is_idle = IsIdle(move, negligible);
    if (is_idle && best_idle == nullptr) best_idle = &move;
    return !is_idle;
  };
  const std::vector<const ModelMove*> chosen = ToBeFitted(moves, most, may_be);
  if (best_idle != nullptr) {
    Decide(After(*best_idle, found_.fit.model), best_idle->score - moves.score,
           "nobody would miss what it adds");
  }
  for (const ModelMove* move : chosen) {
    const Model model = After(*move, found_.fit.model);
    attempts.push_back({model, move, {}});
    // Behind what sticks a filter may be lost, or without it: both are tried of what comes in.
    const bool rubs = std::ranges::any_of(move->added, [&](const Added& added) {
      return found_.blocks[added.variation.block].IsDryFriction();
    });
    const auto add_other = [&](const Model& other) {
      if (!HaveSameBlocks(other, model)) attempts.push_back({other, move, {}});
    };
    if (rubs || iterations == 0) add_other(Creeping(found_.blocks, model));
    if (iterations > 0) continue;
    add_other(Abrupt(found_.blocks, model));
    // A noise that is less likely than another one is no reason for a law.
    if (beside_itself) attempts.push_back({found_.fit.model, move, {}});
  }
  if (iterations > 0) {
    std::erase_if(attempts, [&](const Attempt& one) {
      return std::ranges::any_of(worthless_, [&](const Model& other) {
        return AreNear(other, one.model, kAsNear);
      });
    });
  }
  ParallelForAll(static_cast<int>(attempts.size()), [&](int number) {
    Attempt& one = attempts[static_cast<std::size_t>(number)];
    if (IsOver()) return;
    const auto fitted = [&](const Model& model) {
      const Judged judged = one.JudgedBehind(noises);
      FitEffort of_move = effort;
      of_move.hopeless = whitenings.behind[judged.first].left().squaredNorm();
      return Fitted(model, whitenings, judged, of_move);
    };
    try {
      ModelFit fit = fitted(one.model);
      if (iterations > 0) fit = Pruned(found_.blocks, std::move(fit), fitted);
      one.fit = std::move(fit);
    } catch (const NumericalError&) {
    } catch (const InputError&) {
    }
  });
  struct Tried {
    ModelFit fit;
    Judged judged;
    double gain = 0.0;
  };
  std::vector<Tried> tried;
  for (Attempt& one : attempts) {
    if (!one.fit) continue;
    ModelFit fit = *std::move(one.fit);
    const Judged judged = one.JudgedBehind(noises);
    double gain = moves.score - one.move->score;
    if (iterations > 0) {
      try {
        gain =
            IncumbentBehind(judged, whitenings, moves, as_it_is).score() - fit.score();
      } catch (const NumericalError&) {
        continue;
      }
    }
    const auto is_this = [&](const Model& other) {
      return HaveSameBlocks(other, fit.model);
    };
    if (std::ranges::any_of(hopeless_, is_this) ||
        std::ranges::any_of(tried, is_this, [](const Tried& other) -> const Model& {
          return other.fit.model;
        })) {
      continue;
    }
    if (!IsResolved(found_.blocks, fit.model)) {
      Decide(fit.model, -gain, "two of its members cannot be told apart");
      continue;
    }
    char text[80];
    std::snprintf(text, sizeof text, "  %.1f -> %.1f  ", one.move->score - moves.score,
                  -gain);
    Say(text + ModelText(found_.blocks, fit.model));
    Rate(one.model, -gain);
    const double hoped = moves.score - one.move->score;
    if (iterations > 0 && -gain > kNonsense * hoped && one.move->removed.empty() &&
        one.move->added.size() == 1) {
      double& off = off_by_[one.move->added.front().variation.block];
      off = std::max(off, hoped - gain);
    }
    if (gain < kLeastGain) {
      Decide(fit.model, -gain, "fitted, it is worth less than it costs");
      if (iterations > 0) worthless_.push_back(one.model);
    }
    tried.push_back({std::move(fit), judged, gain});
  }
  std::ranges::sort(tried, std::greater<>(), &Tried::gain);
  // Kept gains are those of what the machine was without a move: which is the best is said
  // by the filters of the machines with each.
  std::erase_if(tried, [&](const Tried& one) {
    // Kept gains tell what is gained to a factor of two.
    if (one.gain < std::max(kLeastGain, 0.5 * tried.front().gain)) {
      Decide(one.fit.model, -one.gain, "another one is worth more than twice as much");
      return true;
    }
    if (MayHave(one.fit.model)) return false;
    Decide(one.fit.model, -one.gain, "its values are none that such a law can have");
    return true;
  });
  const bool has_itself = std::ranges::any_of(tried, [&](const Tried& one) {
    return HaveSameBlocks(one.fit.model, found_.fit.model);
  });
  const std::size_t most_filtered = has_itself ? 4 : 3;
  while (tried.size() > most_filtered) {
    Decide(tried.back().fit.model, -tried.back().gain, "three others are worth more");
    tried.pop_back();
  }
  if (IsOver()) {
    // What has been found is not thrown away for want of a filter, unless one takes long.
    constexpr double kShare = 0.05;  // of the time
    if (seconds_of_run_ > kShare * seconds_) return std::nullopt;
    if (tried.size() > 1) tried.resize(1);
  }
  std::vector<std::optional<ConvergedModel>> settled(tried.size());
  for (const bool other_steps : {false, true}) {
    std::vector<ModelFit> fits;
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < tried.size(); ++i) {
      if (tried[i].judged.second != other_steps) continue;
      fits.push_back(tried[i].fit);
      places.push_back(i);
    }
    if (fits.empty()) continue;
    const Tried& first = tried[places.front()];
    auto rivals = SettleRivals(
        Beside(other_steps ? steps_.Other() : steps_), std::move(fits),
        NoisesBeside(whitenings.noises[first.judged.first]), found_.score, first.gain);
    for (std::size_t i = 0; i < places.size(); ++i) {
      settled[places[i]] = std::move(rivals[i]);
    }
  }
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < settled.size(); ++i) {
    if (!settled[i]) continue;
    Say("  filtered: " + Difference(settled[i]->score()) + "  " +
        ModelText(found_.blocks, settled[i]->fit.model));
    if (!IsOne(settled[i]->fit.model)) continue;
    const double least = best ? settled[*best]->score() : found_.score - kLeastGain;
    if (settled[i]->score() < least) best = i;
  }
  for (std::size_t i = 0; i < settled.size(); ++i) {
    constexpr double kHopeless = 10.0;  // times what it was to gain
    if (!settled[i] ||
        settled[i]->score() - found_.score > kHopeless * std::abs(tried[i].gain)) {
      hopeless_.push_back(tried[i].fit.model);
    }
    if (!settled[i]) continue;
    const double score = settled[i]->score() - found_.score;
    Rate(settled[i]->fit.model, score);
    if (best != i && IsOne(settled[i]->fit.model) && score < -kLeastGain) {
      runners_up_.push_back(settled[i]->fit.model);
    }
    Decide(settled[i]->fit.model, score,
           best == i ? "taken"
           : !IsOne(settled[i]->fit.model)
               ? "its values are at the end of what is known, or two of it are one"
           : score < -kLeastGain
               ? "another one is better"
               : "behind the noise that suits it, it is worth less than it costs");
  }
  if (!best) return std::nullopt;
  return Proposal{std::move(*settled[*best]),
                  tried[*best].judged.second ? steps_.Other() : steps_,
                  found_.input_width, run_};
}

/// Of a model that nothing is better than. Where first order says that something is, and a
/// fit does not, that is as good.
void ModelSearch::KeepRivals(const Moves& moves) {
  found_.rivals.clear();
  for (const std::vector<ModelMove>* some : {&moves.best, &moves.near}) {
    for (ModelMove move : *some) {
      move.score = std::max(0.0, move.score - moves.score);
      found_.rivals.push_back(std::move(move));
    }
  }
}

void ModelSearch::Rate(const Model& rival, double score) {
  for (ModelMove& move : found_.rivals) {
    if (HaveSameBlocks(After(move, found_.fit.model), rival))
      move.score = std::max(0.0, score);
  }
}

}  // namespace mjdiag
