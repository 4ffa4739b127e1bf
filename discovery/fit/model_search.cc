#include "mjdiag/discovery/fit/model_search.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "mjdiag/discovery/blocks/curve_block.h"
#include "mjdiag/discovery/blocks/path_motion.h"
#include "mjdiag/discovery/fit/converged_model.h"
#include "mjdiag/discovery/fit/exact_columns.h"
#include "mjdiag/discovery/fit/first_look.h"
#include "mjdiag/discovery/fit/input_choice.h"
#include "mjdiag/discovery/fit/moved_model.h"
#include "mjdiag/discovery/fit/other_friction.h"
#include "mjdiag/discovery/fit/pruned_fit.h"
#include "mjdiag/discovery/hypotheses/candidate_bounds.h"
#include "mjdiag/discovery/regression/force_moves.h"
#include "mjdiag/discovery/regression/moves.h"
#include "mjdiag/discovery/regression/whitenings.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/replay/coarser_run.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Of fits behind the gains of another model, which the best are fitted anew behind their own: as
// many as two laws take that say nearly the same, of which one leaves.
constexpr int kIterations = 6;

/// Of a number that is between its ends.
constexpr double kPriceOfShare = 2.0;

/// Where the parabola through three points is least, between 0 and 1.
double LeastOfParabola(const std::vector<std::pair<double, double>>& points) {
  if (points.size() < 3) return points.front().first;
  const auto slope = [&](std::size_t i, std::size_t j) {
    return (points[j].second - points[i].second) / (points[j].first - points[i].first);
  };
  const double bend = (slope(1, 2) - slope(0, 1)) / (points[2].first - points[0].first);
  // Where it has no least it goes down to one of the ends.
  const double middle = 0.5 * (points[0].first + points[1].first);
  if (!(bend > 0.0)) return slope(0, 1) + bend * (0.5 - middle) < 0.0 ? 1.0 : 0.0;
  return std::clamp(middle - 0.5 * slope(0, 1) / bend, 0.0, 1.0);
}

bool SameBlocks(const Model& a, const Model& b) {
  return std::ranges::is_permutation(a, b, {}, &Member::block, &Member::block);
}

/// From which a fit goes the same way.
bool IsNear(const Model& a, const Model& b, double alike = 1e-3) {
  return std::ranges::equal(a, b, [&](const Member& one, const Member& other) {
    return one.block == other.block && one.values.isApprox(other.values, alike);
  });
}

}  // namespace

ConvergedBeside ModelSearch::Beside(PhysicsSteps steps) const {
  return {[this, steps](const Model& model) { return With(model, steps); },
          run_,
          reading_sd_,
          found_.path.dofs,
          found_.blocks,
          is_last_,
          [this] { return IsOver(); }};
}

std::vector<FilterNoise> ModelSearch::NoisesBeside(const FilterNoise& near) const {
  std::vector<FilterNoise> noises{near};
  if (found_.path.noise.size != near.size) noises.push_back(found_.path.noise);
  return noises;
}

void ModelSearch::Take(ConvergedModel model) {
  standing_.reset();
  found_.score = model.score();
  found_.fit = std::move(model.fit);
  found_.path = std::move(model.path);
}

void ModelSearch::Adopt(Proposal proposal) {
  if (!SameBlocks(found_.fit.model, proposal.settled.fit.model)) hopeless_.clear();
  worthless_.clear();
  Take(std::move(proposal.settled));
  found_.input_width = proposal.input_width;
  run_ = std::move(proposal.run);
  steps_ = proposal.steps;
  found_.rivals.clear();  // of the model before
  ChooseFriction();
  found_.steps_taken.push_back({found_.fit, found_.path.noise});
}

/// The model as it is behind the noise that suits it by now; none if nothing is gained, or a
/// tenth of what a move promises: it is settled then with that.
std::optional<ConvergedModel> ModelSearch::Resettled(const Whitenings& whitenings,
                                                     const Moves& moves,
                                                     const ModelFit& as_it_is) const {
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

ModelSearch::Standing& ModelSearch::StandingNow() {
  if (!standing_) {
    standing_ = Standing{WhiteningsOf(found_.path),
                         ExactColumnsOf([&](const Model& model) { return With(model); },
                                        With(found_.fit.model, steps_.Other()), run_,
                                        found_.path, found_.blocks, found_.fit.model),
                         {},
                         {}};
  }
  return *standing_;
}

const Moves& ModelSearch::MovesNow(Standing& standing) {
  const auto known = standing.moves.find(at_every_shape_);
  if (known != standing.moves.end()) return known->second;
  Moves moves =
      MovesOf(With(found_.fit.model), run_, found_.path, standing.whitenings.maps(),
              found_.blocks, standing.exact.terms, standing.exact.other_steps,
              {.at_forces = false, .at_every_shape = at_every_shape_});
  return standing.moves.emplace(at_every_shape_, std::move(moves)).first->second;
}

std::optional<ModelSearch::Proposal> ModelSearch::BestForces(Standing& standing) {
  const Moves moves =
      ForceMovesOf(With(found_.fit.model), run_, found_.path, found_.blocks,
                   standing.exact.terms, at_every_shape_);
  Say(std::to_string(moves.variations) + " shapes of forces, " +
      std::to_string(moves.best.size()) + " moves");
  // Behind the latent forces of a machine that lacks so much a fit hardly sees what is slow:
  // values are those of the regression until the filter has been run with them.
  constexpr std::size_t kMost = 3;
  // What has just been settled is behind the noise that suits it.
  AsFitted none;
  return BestOf(moves, kMost, 0, standing.whitenings, none, found_.fit.model.empty());
}

// By first order, which of steps is exact.
ModelSearch::StepsBehind ModelSearch::LikelySteps(const Standing& standing,
                                                  std::size_t noise) const {
  const Whitening& map = standing.whitenings.behind[noise];
  const VectorXd other = map.Of({&standing.exact.other_steps}).col(0);
  const double bend = other.squaredNorm();
  if (!(bend > 0.0)) return {steps_, 0.0};
  const double slope = other.dot(map.left());
  // As far as there are steps to take away, or to give back.
  const double whole = steps_.Other().without - steps_.without;
  const double s = std::clamp(steps_.without + whole * slope / bend, 0.0, 1.0);
  const double part = (s - steps_.without) / whole;
  return {{s, steps_.finer}, 2.0 * part * slope - part * part * bend};
}

/// What makes up for steps are latent forces, too: behind smaller ones other steps may be
/// likelier.
bool ModelSearch::TakeStepsBehind(const Standing& standing, std::size_t noise) {
  const StepsBehind own = LikelySteps(standing, 0);
  if (own.gain > kLeastGain && ChooseSteps(own.steps.without)) return true;
  const StepsBehind likely = LikelySteps(standing, noise);
  if (noise == 0 || likely.gain < kLeastGain) return false;
  ConvergedModel settled = Settle(Beside(likely.steps), found_.fit,
                                  NoisesBeside(standing.whitenings.noises[noise]),
                                  found_.score, likely.gain);
  if (settled.score() > found_.score - kLeastGain) return false;
  Say("steps: " + Difference(settled.score()));
  steps_ = likely.steps;
  Take(std::move(settled));
  ChooseSteps(steps_.without);
  return true;
}

std::optional<ModelSearch::Proposal> ModelSearch::BestMove(Standing& standing) {
  const Moves& moves = MovesNow(standing);
  if (TakeStepsBehind(standing, moves.noise)) return Incumbent();
  KeepRivals(moves);
  const Whitenings& whitenings = standing.whitenings;
  const ModelFit& own =
      IncumbentBehind({moves.noise, false}, whitenings, standing.as_fitted);
  if (auto settled = Resettled(whitenings, moves, own)) {
    return Proposal{std::move(*settled), steps_, found_.input_width, run_};
  }
  Say(std::to_string(moves.variations) + " shapes, " +
      std::to_string(moves.best.size()) + " moves");
  return BestOf(moves, 4, kIterations, whitenings, standing.as_fitted, false);
}

ModelFit ModelSearch::Fitted(const Model& model, const Whitenings& whitenings,
                             const Judged& judged, int iterations) const {
  const PhysicsSteps steps = judged.second ? steps_.Other() : steps_;
  return FitModel(InTime([&](const Model& one) { return With(one, steps); },
                         [this] { return IsOver(); }),
                  run_, found_.path, whitenings.behind[judged.first].gains(),
                  found_.blocks, model, iterations);
}

const ModelFit& ModelSearch::IncumbentBehind(const Judged& judged,
                                             const Whitenings& whitenings,
                                             AsFitted& known) const {
  const auto found = known.find(judged);
  if (found != known.end()) return found->second;
  ModelFit fit = Fitted(found_.fit.model, whitenings, judged, kIterations);
  return known.emplace(judged, std::move(fit)).first->second;
}

std::optional<ModelSearch::Proposal> ModelSearch::BestOf(
    const Moves& moves, std::size_t most, int iterations, const Whitenings& whitenings,
    AsFitted& as_it_is, bool beside_itself) {
  const auto fitted = [&](const Model& model, const Judged& judged) {
    return Fitted(model, whitenings, judged, iterations);
  };
  struct Tried {
    ModelFit fit;
    Judged judged;
    double gain = 0.0;
  };
  std::vector<Tried> tried;
  const auto try_one = [&](const Model& model, const ModelMove& move) {
    if (iterations > 0 && std::ranges::any_of(worthless_, [&](const Model& other) {
          return IsNear(other, model);
        })) {
      return;
    }
    try {
      const Judged judged{std::min(move.noise, whitenings.behind.size() - 1),
                          move.other_steps};
      ModelFit fit = fitted(model, judged);
      double gain = moves.score - move.score;
      if (iterations > 0) {
        fit = Pruned(found_.blocks, std::move(fit),
                     [&](const Model& other) { return fitted(other, judged); });
        gain = IncumbentBehind(judged, whitenings, as_it_is).score() - fit.score();
      }
      const auto is_this = [&](const Model& other) {
        return SameBlocks(other, fit.model);
      };
      if (std::ranges::any_of(hopeless_, is_this) ||
          std::ranges::any_of(tried, is_this, [](const Tried& one) -> const Model& {
            return one.fit.model;
          })) {
        return;
      }
      if (!IsResolved(found_.blocks, fit.model)) {
        Decide(fit.model, -gain, "two of its members cannot be told apart");
        return;
      }
      char text[80];
      std::snprintf(text, sizeof text, "  %.1f -> %.1f  ", move.score - moves.score,
                    -gain);
      Say(text + ModelText(found_.blocks, fit.model));
      Rate(model, -gain);
      if (gain < kLeastGain) {
        Decide(fit.model, -gain, "fitted, it is worth less than it costs");
        if (iterations > 0) worthless_.push_back(model);
      }
      tried.push_back({std::move(fit), judged, gain});
    } catch (const NumericalError&) {
    } catch (const InputError&) {
    }
  };
  const auto may_be = [&](const ModelMove& move) { return MayBe(move); };
  for (const ModelMove* move : ToBeFitted(moves, most, may_be)) {
    if (IsOver()) break;
    const Model model = After(*move, found_.fit.model);
    try_one(model, *move);
    // Behind what sticks a filter may be lost, or without it: both are tried of what comes in.
    const bool rubs = std::ranges::any_of(move->added, [&](const Added& added) {
      return found_.blocks[added.variation.block].IsDryFriction();
    });
    const auto try_other = [&](const Model& other) {
      if (!SameBlocks(other, model)) try_one(other, *move);
    };
    if (rubs || iterations == 0) try_other(Creeping(found_.blocks, model));
    if (iterations > 0) continue;
    try_other(Abrupt(found_.blocks, model));
    // A noise that is less likely than another one is no reason for a law.
    if (beside_itself) try_one(found_.fit.model, *move);
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
    return SameBlocks(one.fit.model, found_.fit.model);
  });
  const std::size_t most_filtered = has_itself ? 4 : 3;
  while (tried.size() > most_filtered) {
    Decide(tried.back().fit.model, -tried.back().gain, "three others are worth more");
    tried.pop_back();
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
    if (SameBlocks(After(move, found_.fit.model), rival))
      move.score = std::max(0.0, score);
  }
}

bool ModelSearch::ChooseSteps(std::optional<double> near) {
  // Behind latent forces that make up for steps their share is hardly seen: it is asked again
  // behind those that are left, nearer by.
  constexpr double kApart = 0.02;
  const auto choose_near = [&](double share) {
    const double at = std::clamp(share, kApart, 1.0 - kApart);
    return ChooseStepsOf({at - kApart, at, at + kApart});
  };
  const double before = steps_.without;
  if (!(near ? choose_near(*near) : ChooseStepsOf({0.0, 0.5, 1.0}))) return false;
  for (int round = 0; round < 3 && !IsOver(); ++round) {
    if (!choose_near(steps_.without)) break;
  }
  return steps_.without != before;
}

// What steps do is proportional to them, so that -2 ln L is a parabola over their share.
bool ModelSearch::ChooseStepsOf(const std::vector<double>& shares) {
  std::vector<PhysicsSteps> asked{steps_};
  for (const double without : shares) {
    if (without != steps_.without) asked.push_back({without, steps_.finer});
  }
  std::vector<FilterPath> paths(asked.size());
  const double begin = time_.Seconds();
  ParallelForAll(static_cast<int>(asked.size()) - 1, [&](int number) {
    const auto i = static_cast<std::size_t>(number) + 1;
    try {
      paths[i] = Filtered(asked[i]);
    } catch (const NumericalError&) {
      paths[i].deviance = std::numeric_limits<double>::infinity();
    }
  });
  seconds_of_run_ = (time_.Seconds() - begin) / static_cast<double>(asked.size() - 1);
  paths.front().deviance = found_.path.deviance;
  std::vector<std::pair<double, double>> known;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    known.emplace_back(asked[i].without, paths[i].deviance);
  }
  const PhysicsSteps least{LeastOfParabola(known), steps_.finer};
  if (std::ranges::find(asked, least.without, &PhysicsSteps::without) == asked.end()) {
    asked.push_back(least);
    paths.push_back(Filtered(least));
  }
  // Steps that are known cost nothing; a share of them is a number.
  const auto cost = [&](std::size_t i) {
    const bool is_share = asked[i].without != 0.0 && asked[i].without != 1.0;
    return paths[i].deviance + (is_share ? kPriceOfShare : 0.0);
  };
  std::size_t best = 0;
  for (std::size_t i = 1; i < asked.size(); ++i) {
    if (cost(i) < cost(best)) best = i;
  }
  if (cost(best) > cost(0) - kLeastGain) return false;
  TakeSteps(asked[best], std::move(paths[best]));
  return true;
}

// What is of second order in them is of no law: it comes before one that explains less. Asking
// takes as long as some runs, and all runs take as many times longer then.
bool ModelSearch::ChooseFinerSteps(double beat) {
  constexpr int kFiner = 4;  // 16 times less of second order
  constexpr int kFinest = 16;
  constexpr double kShareOfTime = 0.05;
  if (steps_.AreGiven() || steps_.finer == kFinest) return false;
  if (kFiner * seconds_of_run_ > kShareOfTime * (seconds_ - time_.Seconds())) {
    return false;
  }
  // Of steps as long as those of the run nothing is left to take away.
  const double own = 1.0 - steps_.without;
  const PhysicsSteps finer{std::max(0.0, 1.0 - kFiner * own), kFiner * steps_.finer};
  FilterPath path = Filtered(finer);
  // Values that make up for steps hide them: where little is gained otherwise they are fitted anew.
  constexpr double kLittle = 0.1;  // of what all did
  const bool is_little =
      found_.score - beat < kLittle * (found_.nothing.deviance - found_.score);
  if (!is_little && found_.path.deviance - path.deviance < kLeastGain) return false;
  ConvergedModel settled = SettleNear(Beside(finer), found_.fit, std::move(path));
  if (settled.score() > beat) return false;
  Say("finer steps: " + Difference(settled.score()));
  steps_ = finer;
  Take(std::move(settled));
  ChooseSteps(steps_.without);
  return true;
}

void ModelSearch::TakeSteps(PhysicsSteps steps, FilterPath path) {
  char text[80];
  std::snprintf(text, sizeof text, "steps %.3f of %d: %.1f", 1.0 - steps.without,
                steps.finer, path.deviance - found_.path.deviance);
  Say(text);
  steps_ = steps;
  // Values made up for the steps as far as they could.
  Take(SettleNear(Beside(steps_), found_.fit, std::move(path)));
}

void ModelSearch::ChooseFriction() {
  // What was asked of all but the same friction is known.
  constexpr double kAlike = 0.2;
  Model rubs;
  for (const Member& member : found_.fit.model) {
    if (found_.blocks[member.block].IsDryFriction()) rubs.push_back(member);
  }
  if (IsNear(rubs, asked_forms_of_, kAlike)) return;
  asked_forms_of_ = rubs;
  auto other = WithOtherFriction(Beside(steps_), {found_.fit, found_.path});
  if (!other) return;
  Say("joints that stand: " + Difference(other->score()) + "  " +
      ModelText(found_.blocks, other->fit.model));
  Take(std::move(*other));
}

std::optional<ModelSearch::Proposal> ModelSearch::SmoothedInputs() const {
  const double width = found_.input_width;
  std::optional<InputChoice> choice =
      ChooseInputs(With(found_.fit.model), as_measured_, reading_sd_, found_.path,
                   width, [this] { return IsOver(); });
  if (!choice) return std::nullopt;
  ConvergedModel settled{found_.fit, std::move(choice->path)};
  Say("inputs over " + std::to_string(choice->width) + " ticks: " +
      Difference(settled.score() + PriceOfWidth(choice->width) - PriceOfWidth(width)));
  return Proposal{std::move(settled), steps_, choice->width,
                  WithInputsOver(as_measured_, choice->width)};
}

void ModelSearch::AddCurves() {
  const ObservedMotion motion = MotionAlong(With(found_.fit.model), run_, found_.path);
  std::ranges::move(
      BlocksOf(machine_, CurveCandidates(machine_, candidates_, motion), {}),
      std::back_inserter(found_.blocks));
}

bool ModelSearch::Step() {
  Standing& standing = StandingNow();
  std::optional<Proposal> move;
  // Inputs that are noise are smoothed where forces say nothing more: before, what a machine
  // lacks passes for noise of its inputs, which takes away what would have told it.
  bool asks_inputs = true;
  if (looks_at_forces_) {
    move = BestForces(standing);
    if (!move) {
      asks_inputs = false;
      move = SmoothedInputs();
    }
    looks_at_forces_ = move.has_value();
  }
  if (!move) move = BestMove(standing);
  if (!move && asks_inputs) move = SmoothedInputs();
  if (!move) return false;
  if (!ChooseFinerSteps(move->settled.score())) Adopt(std::move(*move));
  return true;
}

void ModelSearch::LookAt(const MeasuredRun& run, int ticks) {
  machine_ = InTicksOf(given_, ticks);
  as_measured_ = Coarser(run, ticks);
  run_ = WithInputsOver(as_measured_, found_.input_width);
  found_.ticks = ticks;
  is_part_ = run.samples() < whole_.samples();
}

void ModelSearch::Prepare() {
  const FirstLook look = FirstLookAt(given_, whole_, reading_sd_);
  LookAt(look.run, look.ticks);
  // All of it gets at least as long.
  if (IsFirstLook()) seconds_ = 0.5 * options_.seconds;
  const IsTimeOver is_over = [this] { return IsOver(); };
  found_.path = FilterLikeliest(machine_, run_, reading_sd_, is_over);
  const FilterPath nothing = found_.path;
  found_.score = found_.path.deviance;
  ChooseSteps();
  candidates_ = ChooseCandidates(machine_, options_.choice, true);
  found_.nothing = nothing;
  const MeasuredRun all = is_part_ ? Coarser(whole_, found_.ticks) : as_measured_;
  if (is_part_) found_.nothing = Along(machine_, all, nothing);
  const ObservedMotion motion = MotionAlong(machine_, all, found_.nothing);
  BoundByRecord(candidates_, machine_, motion);
  BoundDriveLimits(candidates_, machine_, motion);
  BoundByReadings(candidates_, machine_, whole_);
  BoundPlays(candidates_, machine_, reading_sd_);
  const std::vector<ModelParameter> in_doubt = IsExact(machine_.plant())
                                                   ? std::vector<ModelParameter>{}
                                                   : NumbersOf(machine_.plant());
  found_.blocks = BlocksOf(machine_, candidates_, options_.numbers.value_or(in_doubt));
}

void ModelSearch::StepOn() {
  while (!IsOver() && Step()) {
    char text[80];
    std::snprintf(text, sizeof text, "%.1f  ", found_.score);
    Say(text + ModelText(found_.blocks, found_.fit.model));
    if (options_.better) options_.better(found_);
  }
}

FilterPath ModelSearch::Along(const Machine& machine, const MeasuredRun& run,
                              const FilterPath& path) const {
  return RunForceFilter(machine, run, path.dofs,
                        FilterStarts(machine, run, reading_sd_),
                        NoiseInTicksOf(path, run.sample_time));
}

void ModelSearch::LookAtAll() {
  seconds_ = options_.seconds;
  const int before = found_.ticks;
  const int ticks = IsOver() || !TellsMoreInBetween(found_.path) ? before : 1;
  if (!is_part_ && ticks == before) return;
  found_.input_width *= before / ticks;
  LookAt(whole_, ticks);
  standing_.reset();
  found_.rivals.clear();
  found_.steps_taken.clear();
  hopeless_.clear();
  worthless_.clear();
  asked_forms_of_.clear();
  looks_at_forces_ = false;
  for (Block& block : found_.blocks) {
    if (block.candidate) WidenFrequencies(*block.candidate, as_measured_.sample_time);
  }
  if (ticks != before) found_.nothing = Along(machine_, whole_, found_.nothing);
  try {
    // Also of what has been asked to end.
    found_.path = Along(Made(found_.fit.model, steps_), run_, found_.path);
  } catch (const NumericalError&) {
    found_.fit = {};
    found_.path = found_.nothing;
    found_.input_width = 0.0;
    run_ = as_measured_;
    steps_ = {};
  }
  // What was found so far is where the search begins, whatever it is worth by all.
  found_.score = ConvergedModel{found_.fit, found_.path}.score();
  if (IsOver()) return;
  ConvergedModel settled = SettleNear(Beside(steps_), found_.fit, found_.path);
  Take(std::move(settled));
  Say("with all of the run: " + std::to_string(found_.score) + "  " +
      ModelText(found_.blocks, found_.fit.model));
}

Explained ModelSearch::Run() {
  Prepare();
  try {
    if (IsFirstLook()) StepOn();
  } catch (const NumericalError&) {
  }
  try {
    LookAtAll();
    StepOn();
    is_last_ = true;
    if (!IsOver()) {
      ChooseFinerSteps(found_.score - kLeastGain);
      may_be_at_ends_ = true;
      asked_forms_of_.clear();
      looks_at_forces_ = true;
      hopeless_.clear();
      StepOn();
    }
    // What is left may have a shape that shows beside nothing simple, or no name.
    if (!IsOver()) {
      if (options_.choice.only.empty()) AddCurves();
      at_every_shape_ = true;
      looks_at_forces_ = true;
      StepOn();
    }
  } catch (const NumericalError&) {
    // A machine that diverges beside what is measured, or the wish to end: what was found
    // until then stays.
  }
  found_.steps = steps_;
  found_.is_cut_short = IsOver();
  return std::move(found_);
}

}  // namespace mjdiag
