#include "mjdiag/discovery/fit/explain.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include "mjdiag/discovery/blocks/curve_block.h"
#include "mjdiag/discovery/blocks/path_motion.h"
#include "mjdiag/discovery/fit/exact_columns.h"
#include "mjdiag/discovery/fit/input_choice.h"
#include "mjdiag/discovery/fit/pruned_fit.h"
#include "mjdiag/discovery/hypotheses/candidate_bounds.h"
#include "mjdiag/discovery/regression/moves.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/replay/input_noise.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

using Clock = std::chrono::steady_clock;

class Search {
 public:
  Search(const Machine& machine, const MeasuredRun& run, const VectorXd& reading_sd,
         const ExplainOptions& options)
      : machine_(machine),
        as_measured_(run),
        run_(run),
        reading_sd_(reading_sd),
        options_(options) {}

  Explained Run();

 private:
  struct Settled {
    ModelFit fit;
    FilterPath path;
    double score() const { return path.deviance + fit.prior + fit.occam; }
  };
  Settled Settle(ModelFit fit, const FilterNoise& near, bool steps) const;
  /// What the search may go on from.
  struct Proposal {
    Settled settled;
    bool steps = true;
    VectorXd widths;  ///< of the inputs
    MeasuredRun run;
  };
  void Adopt(Proposal proposal);
  void KeepRivals(const Moves& moves);
  std::optional<Settled> Resettled(const Whitenings& whitenings, std::size_t noise,
                                   const ModelFit& as_it_is) const;
  std::string Difference(double score) const {
    char text[40];
    std::snprintf(text, sizeof text, "%.1f", score - found_.score);
    return text;
  }
  std::vector<const ModelMove*> ToBeFitted(const Moves& moves) const;
  /// The best of some moves, fitted; none if none pays.
  std::optional<Proposal> BestMove(const Whitenings& whitenings);
  /// How much of its inputs did the machine not feel?
  std::optional<Proposal> SmoothedInputs(const Whitenings& whitenings) const;
  Proposal AsItIs() const {
    return {{found_.fit, found_.path}, steps_, found_.widths, run_};
  }
  /// Takes what is better; false if nothing pays.
  bool Step();
  /// What no law explains may be a force without a name.
  void AddCurves(const std::vector<Candidate>& candidates);
  Model After(const ModelMove& move) const;
  void Decide(const Model& tried, double score, const std::string& why) {
    found_.decisions.push_back({mjdiag::Describe(found_.blocks, tried), score, why});
  }
  bool HasTooManyCauses(const Model& model) const {
    const auto causes = std::ranges::count_if(model, [&](const Member& member) {
      return found_.blocks[member.block].candidate.has_value();
    });
    return static_cast<std::size_t>(causes) > options_.most_causes;
  }
  bool IsStopped() const { return options_.stop && options_.stop(); }
  bool IsOver() const {
    return std::chrono::duration<double>(Clock::now() - begin_).count() >
               options_.seconds ||
           IsStopped();
  }
  void Say(const std::string& text) const {
    if (options_.progress) options_.progress(text);
  }

  Machine With(const Model& model) const { return With(model, steps_); }
  Machine With(const Model& model, bool steps) const {
    if (IsStopped()) throw NumericalError("fit: asked to end");
    const Machine machine = machine_.With(ChangesOf(found_.blocks, model));
    return steps ? machine : machine.WithoutSteps();
  }
  /// Is the run of a machine with the physics steps of the model, as one that was simulated
  /// with it, or of one that has none?
  bool ChooseSteps();

  const Machine& machine_;
  bool steps_ = true;
  const MeasuredRun& as_measured_;
  MeasuredRun run_;  // with its inputs smoothed
  const VectorXd& reading_sd_;
  const ExplainOptions& options_;
  Clock::time_point begin_ = Clock::now();
  Explained found_;
};

bool SameBlocks(const Model& a, const Model& b) {
  return std::ranges::is_permutation(a, b, {}, &Member::block, &Member::block);
}

Model Search::After(const ModelMove& move) const {
  Model model;
  for (std::size_t m = 0; m < found_.fit.model.size(); ++m) {
    if (std::ranges::find(move.removed, m) == move.removed.end()) {
      model.push_back(found_.fit.model[m]);
    }
  }
  for (const Added& added : move.added) {
    model.push_back({added.variation.block, *added.variation.values(added.amplitudes)});
  }
  return model;
}

/// A model behind the noise that suits it, fitted anew, until neither gains by the other.
Search::Settled Search::Settle(ModelFit fit, const FilterNoise& near,
                               bool steps) const {
  const auto filter = [&](const Model& model, const std::vector<FilterNoise>& from) {
    return FilterLikeliestFrom(With(model, steps), run_, reading_sd_, found_.path.dofs,
                               from);
  };
  Settled settled{std::move(fit), {}};
  settled.path = filter(settled.fit.model, {near, found_.path.noise});
  // Values that are off make latent forces large, behind which values are hardly seen:
  // where fits behind the noise of the last filter gain no more, one behind a smaller may.
  constexpr int kRounds = 6;
  std::size_t smaller = 0;
  for (int round = 0; round < kRounds && !IsOver(); ++round) {
    const FilterPath& path = settled.path;
    const std::vector<FilterNoise> noises = NoisesFrom(path.noise);
    const KeptGains gains = KeepGains(path, noises[smaller], InflationAlong(path));
    double gain = 0.0;
    try {
      const FitOf fitted = [&](const Model& start) {
        return FitModel([&](const Model& model) { return With(model, steps); }, run_,
                        path, gains, found_.blocks, start, 4);
      };
      Settled next{Pruned(found_.blocks, fitted(settled.fit.model), fitted), {}};
      next.path = filter(next.fit.model, {path.noise, noises[smaller]});
      gain = settled.score() - next.score();
      if (gain > 0.0) settled = std::move(next);
    } catch (const NumericalError&) {
    }
    if (gain >= kLeastGain) {
      smaller = 0;
    } else if (++smaller == noises.size() - 1) {
      break;
    }
  }
  return settled;
}

void Search::Adopt(Proposal proposal) {
  found_.score = proposal.settled.score();
  found_.fit = std::move(proposal.settled.fit);
  found_.path = std::move(proposal.settled.path);
  found_.widths = std::move(proposal.widths);
  run_ = std::move(proposal.run);
  steps_ = proposal.steps;
  found_.rivals.clear();  // of the model before
  ChooseSteps();
}

/// The model as it is behind the noise that suits it by now; none if nothing is gained.
std::optional<Search::Settled> Search::Resettled(const Whitenings& whitenings,
                                                 std::size_t noise,
                                                 const ModelFit& as_it_is) const {
  const KeptGains& own = whitenings.behind.front().gains();
  const double before = own.left.squaredNorm() + own.log_determinant +
                        found_.fit.prior + found_.fit.occam;
  if (as_it_is.score() > before - kLeastGain) return std::nullopt;
  Settled settled = Settle(as_it_is, whitenings.noises[noise], steps_);
  if (settled.score() > found_.score - kLeastGain) return std::nullopt;
  Say("settled: " + Difference(settled.score()));
  return settled;
}

/// The best of all, and the best that brings one block and nothing else: the fewer come at
/// once, the nearer is first order to what a fit finds.
std::vector<const ModelMove*> Search::ToBeFitted(const Moves& moves) const {
  constexpr std::size_t kMost = 4;
  std::vector<const ModelMove*> chosen;
  bool has_single = false;
  for (const ModelMove& move : moves.best) {
    if (move.score > moves.score - kLeastGain || HasTooManyCauses(After(move)))
      continue;
    const bool is_single = move.removed.empty() && move.added.size() == 1;
    if (chosen.size() >= kMost && (has_single || !is_single)) continue;
    chosen.push_back(&move);
    has_single = has_single || is_single;
  }
  return chosen;
}

std::optional<Search::Proposal> Search::BestMove(const Whitenings& whitenings) {
  const ExactColumns exact = ExactColumnsOf(
      [&](const Model& model) { return With(model); }, With(found_.fit.model, !steps_),
      run_, found_.path, found_.blocks, found_.fit.model);
  const Moves moves = MovesOf(With(found_.fit.model), run_, found_.path, whitenings,
                              found_.blocks, exact.terms, exact.other_steps);
  if (moves.other_steps && ChooseSteps()) return AsItIs();
  KeepRivals(moves);
  constexpr int kIterations = 6;
  /// Behind which gains, and whether with other steps.
  using Judged = std::pair<std::size_t, bool>;
  const auto fitted = [&](const Model& model, const Judged& judged) {
    const bool steps = steps_ != judged.second;
    return FitModel([&](const Model& one) { return With(one, steps); }, run_,
                    found_.path, whitenings.behind[judged.first].gains(), found_.blocks,
                    model, kIterations);
  };
  // Moves are compared with the model as it is behind the same gains.
  std::map<Judged, ModelFit> as_it_is;
  const auto base = [&](const Judged& judged) -> const ModelFit& {
    const auto known = as_it_is.find(judged);
    if (known != as_it_is.end()) return known->second;
    return as_it_is.emplace(judged, fitted(found_.fit.model, judged)).first->second;
  };
  if (auto settled = Resettled(whitenings, moves.noise, base({moves.noise, false}))) {
    return Proposal{std::move(*settled), steps_, found_.widths, run_};
  }
  Say(std::to_string(moves.variations) + " shapes, " +
      std::to_string(moves.best.size()) + " moves");
  struct Tried {
    ModelFit fit;
    Judged judged;
    double gain = 0.0;
  };
  std::vector<Tried> tried;
  for (const ModelMove* move : ToBeFitted(moves)) {
    if (IsOver()) break;
    try {
      const Judged judged{move->noise, move->other_steps};
      ModelFit fit = Pruned(found_.blocks, fitted(After(*move), judged),
                            [&](const Model& model) { return fitted(model, judged); });
      const double gain = base(judged).score() - fit.score();
      if (std::ranges::any_of(tried, [&](const Tried& other) {
            return SameBlocks(other.fit.model, fit.model);
          })) {
        continue;
      }
      char text[80];
      std::snprintf(text, sizeof text, "  %.1f -> %.1f  ", move->score - moves.score,
                    -gain);
      Say(text + Describe(found_.blocks, fit.model));
      if (gain < kLeastGain) {
        Decide(fit.model, -gain, "fitted, it is worth less than it costs");
      }
      tried.push_back({std::move(fit), judged, gain});
    } catch (const NumericalError&) {
    } catch (const InputError&) {
    }
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
    if (std::ranges::all_of(one.fit.model, [&](const Member& member) {
          return IsAllowed(found_.blocks[member.block], member.values);
        })) {
      return false;
    }
    Decide(one.fit.model, -one.gain, "its values are none that such a law can have");
    return true;
  });
  std::vector<std::optional<Settled>> settled(tried.size());
  ParallelForAll(static_cast<int>(tried.size()), [&](int number) {
    const auto place = static_cast<std::size_t>(number);
    const Tried& one = tried[place];
    try {
      settled[place] = Settle(one.fit, whitenings.noises[one.judged.first],
                              steps_ != one.judged.second);
    } catch (const NumericalError&) {
    } catch (const InputError&) {
    }
  });
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < settled.size(); ++i) {
    if (!settled[i]) continue;
    Say("  filtered: " + Difference(settled[i]->score()) + "  " +
        Describe(found_.blocks, settled[i]->fit.model));
    const double least = best ? settled[*best]->score() : found_.score - kLeastGain;
    if (settled[i]->score() < least) best = i;
  }
  for (std::size_t i = 0; i < settled.size(); ++i) {
    if (!settled[i]) continue;
    const double score = settled[i]->score() - found_.score;
    Decide(settled[i]->fit.model, score,
           best == i ? "taken"
           : score < -kLeastGain
               ? "another one is better"
               : "behind the noise that suits it, it is worth less than it costs");
  }
  if (!best) return std::nullopt;
  return Proposal{std::move(*settled[*best]), steps_ != tried[*best].judged.second,
                  found_.widths, run_};
}

/// Of a model that nothing is better than. Where first order says that something is, and a
/// fit does not, that is as good.
void Search::KeepRivals(const Moves& moves) {
  found_.rivals.clear();
  for (const std::vector<ModelMove>* some : {&moves.best, &moves.near}) {
    for (ModelMove move : *some) {
      move.score = std::max(0.0, move.score - moves.score);
      found_.rivals.push_back(std::move(move));
    }
  }
}

bool Search::ChooseSteps() {
  FilterPath path =
      RunForceFilter(With(found_.fit.model, !steps_), run_, found_.path.dofs,
                     found_.path.starts, found_.path.noise);
  const double gain = found_.path.deviance - path.deviance;
  if (gain < kLeastGain) return false;
  steps_ = !steps_;
  Say((steps_ ? "with physics steps: " : "without physics steps: ") +
      std::to_string(-gain));
  found_.score -= gain;
  found_.path = std::move(path);
  return true;
}

std::optional<Search::Proposal> Search::SmoothedInputs(
    const Whitenings& whitenings) const {
  const Machine machine = With(found_.fit.model);
  const InputChoice choice =
      ChooseInputs(machine, as_measured_, found_.path, whitenings, found_.widths);
  if (choice.widths == found_.widths) return std::nullopt;
  MeasuredRun run = WithSmoothedInputs(as_measured_, choice.widths);
  Settled settled{found_.fit,
                  FilterLikeliestFrom(machine, run, reading_sd_, found_.path.dofs,
                                      {choice.noise, found_.path.noise})};
  if (found_.path.deviance + PriceOfWidths(found_.widths) <
      settled.path.deviance + PriceOfWidths(choice.widths) + kLeastGain) {
    return std::nullopt;
  }
  std::string text = "inputs over";
  for (const double width : choice.widths) text += " " + std::to_string(width);
  Say(text + " ticks: " + Difference(settled.score()));
  return Proposal{std::move(settled), steps_, choice.widths, std::move(run)};
}

void Search::AddCurves(const std::vector<Candidate>& candidates) {
  const ObservedMotion motion = MotionAlong(With(found_.fit.model), run_, found_.path);
  std::ranges::move(
      BlocksOf(machine_, CurveCandidates(machine_, candidates, motion), {}),
      std::back_inserter(found_.blocks));
}

bool Search::Step() {
  const Whitenings whitenings = WhiteningsOf(found_.path);
  std::optional<Proposal> smoothed = SmoothedInputs(whitenings);
  std::optional<Proposal> move = BestMove(whitenings);
  if (!smoothed && !move) return false;
  const bool smooths =
      !move || (smoothed && smoothed->settled.score() < move->settled.score());
  Adopt(std::move(smooths ? *smoothed : *move));
  return true;
}

Explained Search::Run() {
  found_.path = FilterLikeliest(machine_, run_, reading_sd_);
  found_.nothing = found_.path;
  found_.score = found_.path.deviance;
  found_.widths = VectorXd::Zero(run_.inputs.rows());
  ChooseSteps();
  std::vector<Candidate> candidates = ChooseCandidates(machine_, options_.choice, true);
  BoundByRecord(candidates, machine_, MotionAlong(machine_, run_, found_.path));
  BoundByReadings(candidates, machine_, run_);
  const std::vector<PlantNumber> in_doubt = IsExact(machine_.plant())
                                                ? std::vector<PlantNumber>{}
                                                : NumbersOf(machine_.plant());
  found_.blocks = BlocksOf(machine_, candidates, options_.numbers.value_or(in_doubt));
  bool has_curves = !options_.choice.only.empty();
  try {
    while (!IsOver()) {
      if (!Step()) {
        if (std::exchange(has_curves, true)) break;
        AddCurves(candidates);
        continue;
      }
      char text[80];
      std::snprintf(text, sizeof text, "%.1f  ", found_.score);
      Say(text + Describe(found_.blocks, found_.fit.model));
      if (options_.better) options_.better(found_);
    }
  } catch (const NumericalError&) {
    // A machine that diverges beside what is measured, or the wish to end: what was found
    // until then stays.
  }
  found_.steps = steps_;
  found_.is_cut_short = IsOver();
  return std::move(found_);
}

}  // namespace

Explained Explain(const Machine& machine, const MeasuredRun& run,
                  const VectorXd& reading_sd, const ExplainOptions& options) {
  return Search(machine, run, reading_sd, options).Run();
}

}  // namespace mjdiag
