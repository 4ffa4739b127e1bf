#include "mjdiag/discovery/fit/model_search.h"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <optional>
#include <utility>

#include "mjdiag/discovery/blocks/curve_block.h"
#include "mjdiag/discovery/blocks/path_motion.h"
#include "mjdiag/discovery/fit/converged_model.h"
#include "mjdiag/discovery/fit/exact_columns.h"
#include "mjdiag/discovery/fit/first_look.h"
#include "mjdiag/discovery/fit/input_choice.h"
#include "mjdiag/discovery/fit/other_friction.h"
#include "mjdiag/discovery/fit/pruned_fit.h"
#include "mjdiag/discovery/hypotheses/candidate_bounds.h"
#include "mjdiag/discovery/regression/moves.h"
#include "mjdiag/discovery/regression/whitenings.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/replay/coarser_run.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

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
  if (!HaveSameBlocks(found_.fit.model, proposal.settled.fit.model)) hopeless_.clear();
  worthless_.clear();
  Take(std::move(proposal.settled));
  found_.input_width = proposal.input_width;
  run_ = std::move(proposal.run);
  steps_ = proposal.steps;
  found_.rivals.clear();  // of the model before
  if (ChooseFriction()) AskRunnersUp(std::move(runners_up_));
  found_.steps_taken.push_back({found_.fit, found_.path.noise});
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

bool ModelSearch::HasTimeForFits() const {
  constexpr double kRuns = 200.0;  // that fits of a few rivals take, about
  constexpr double kShareOfTime = 0.15;
  return kRuns * seconds_of_run_ < kShareOfTime * (seconds_ - time_.Seconds());
}

bool ModelSearch::ChooseFriction() {
  // What was asked of all but the same friction is known.
  constexpr double kAlike = 0.2;
  Model rubs;
  for (const Member& member : found_.fit.model) {
    if (found_.blocks[member.block].IsDryFriction()) rubs.push_back(member);
  }
  if (AreNear(rubs, asked_forms_of_, kAlike)) return false;
  asked_forms_of_ = rubs;
  auto other =
      WithOtherFriction(Beside(steps_), {found_.fit, found_.path}, HasTimeForFits());
  if (!other) return false;
  Say("joints that stand: " + Difference(other->score()) + "  " +
      ModelText(found_.blocks, other->fit.model));
  Take(std::move(*other));
  return true;
}

void ModelSearch::AskRunnersUp(std::vector<Model> runners_up) {
  std::vector<Model> models;
  for (const Model& one : runners_up) {
    Model model = InFormsOf(found_.blocks, one, found_.fit.model);
    const bool is_another =
        !HaveSameBlocks(model, one) && !HaveSameBlocks(model, found_.fit.model);
    if (is_another) models.push_back(std::move(model));
  }
  // Each may come out best.
  const double hoped = found_.nothing.deviance - found_.score;
  auto settled =
      SettleInPlaceOf({found_.fit, found_.path}, Beside(steps_), models, hoped);
  for (auto& one : settled) {
    if (!one || !IsOne(one->fit.model)) continue;
    if (one->score() > found_.score - kLeastGain) continue;
    Say("stands, too: " + Difference(one->score()) + "  " +
        ModelText(found_.blocks, one->fit.model));
    Take(std::move(*one));
  }
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
  runners_up_.clear();
  std::optional<Proposal> move;
  // Inputs that are noise are smoothed where forces say nothing more: before, what a machine
  // lacks passes for noise of its inputs, which takes away what would have told it.
  bool asks_inputs = true;
  if (looks_at_forces_) {
    move = BestForces(StandingNow());
    if (!move) {
      asks_inputs = false;
      move = SmoothedInputs();
    }
    looks_at_forces_ = move.has_value();
    // What a drive does is no force along the motion: where nothing is known yet, what looks
    // like one may be that, beside the steps that the run knows.
    if (move && found_.fit.model.empty() && HasTimeForFits()) {
      std::optional<Proposal> other;
      do {
        other = BestMove(StandingNow());
      } while (other && other->settled.fit.model.empty());
      if (other && other->settled.score() < move->settled.score()) move = other;
    }
  }
  if (!move) move = BestMove(StandingNow());
  if (!move && asks_inputs) move = SmoothedInputs();
  if (!move) return false;
  if (!ChooseFinerSteps(move->settled.score())) Adopt(std::move(*move));
  return true;
}

void ModelSearch::LookAt(const MeasuredRun& run, int ticks) {
  machine_ = InTicksOf(given_, ticks);
  as_measured_ = Coarser(run, ticks);
  run_ = WithInputsOver(as_measured_, found_.input_width);
  inputs_are_noise_ = InputsAreNoise(as_measured_);
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
  found_.path = Timed(found_.fit.model, found_.path);
  candidates_ = ChooseCandidates(machine_, options_.choice, true);
  found_.nothing = nothing;
  const MeasuredRun all = is_part_ ? Coarser(whole_, found_.ticks) : as_measured_;
  if (is_part_) found_.nothing = Along(machine_, all, nothing);
  const ObservedMotion motion = MotionAlong(machine_, all, found_.nothing);
  BoundByRecord(candidates_, machine_, motion);
  BoundDriveLimits(candidates_, machine_, motion);
  BoundByReadings(candidates_, machine_, whole_);
  BoundPlays(candidates_, machine_, reading_sd_);
  BoundSprings(candidates_, machine_, whole_.sample_time);
  const std::vector<ModelParameter> in_doubt = IsExact(machine_.plant())
                                                   ? std::vector<ModelParameter>{}
                                                   : NumbersOf(machine_.plant());
  found_.blocks = BlocksOf(machine_, candidates_, options_.numbers.value_or(in_doubt));
}

void ModelSearch::StepOn() {
  try {
    // What a machine lacks is told apart beside the steps that its run knows.
    while (found_.fit.model.empty() && !IsOver() && TakeStepsBehind(StandingNow(), 0)) {
    }
    while (!IsOver() && Step()) {
      char text[80];
      std::snprintf(text, sizeof text, "%.1f  ", found_.score);
      Say(text + ModelText(found_.blocks, found_.fit.model));
      if (options_.better) options_.better(found_);
    }
  } catch (const NumericalError&) {
    // A machine that diverges beside what is measured, or the wish to end: what was found
    // until then stays, and the next look begins there.
  }
}

FilterPath ModelSearch::Along(const Machine& machine, const MeasuredRun& run,
                              const FilterPath& path) const {
  return RunForceFilter(machine, run, path.dofs,
                        FilterStarts(machine, run, reading_sd_),
                        NoiseInTicksOf(path, run.sample_time));
}

FilterPath ModelSearch::Timed(const Model& model, const FilterPath& path) {
  const double begin = time_.Seconds();
  FilterPath timed = Along(Made(model, steps_), run_, path);
  seconds_of_run_ = time_.Seconds() - begin;
  return timed;
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
  off_by_.clear();
  asked_forms_of_.clear();
  looks_at_forces_ = false;
  for (Block& block : found_.blocks) {
    if (block.candidate) WidenFrequencies(*block.candidate, as_measured_.sample_time);
  }
  if (ticks != before) found_.nothing = Along(machine_, whole_, found_.nothing);
  try {
    // Also of what has been asked to end.
    found_.path = Timed(found_.fit.model, found_.path);
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
  if (IsFirstLook()) StepOn();
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
    // What is left may have a shape that shows beside nothing simple, and then no name.
    if (!IsOver()) {
      at_every_shape_ = true;
      looks_at_forces_ = true;
      StepOn();
    }
    if (!IsOver() && options_.choice.only.empty()) {
      AddCurves();
      standing_.reset();
      looks_at_forces_ = true;
      StepOn();
    }
  } catch (const NumericalError&) {
    // All of the run as one: what was found by a part of it stays.
  }
  found_.fit = WithoutIdle(found_.blocks, std::move(found_.fit));
  found_.steps = steps_;
  found_.is_cut_short = IsOver();
  return std::move(found_);
}

}  // namespace mjdiag
