#pragma once
// The search for what a machine lacks along a run (explain.h): one model, changed by moves
// (moves.h) as long as the filter of the machine with what a move makes of it, its noise anew,
// predicts the run better than its price.

#include <Eigen/Core>
#include <cstddef>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mjdiag/discovery/fit/converged_model.h"
#include "mjdiag/discovery/fit/exact_columns.h"
#include "mjdiag/discovery/fit/explain.h"
#include "mjdiag/discovery/fit/moved_model.h"
#include "mjdiag/discovery/regression/negligible.h"
#include "mjdiag/discovery/regression/whitenings.h"
#include "mjdiag/plugin/runtime/work_time.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

class ModelSearch {
 public:
  ModelSearch(const Machine& machine, const MeasuredRun& run,
              const Eigen::VectorXd& reading_sd, const ExplainOptions& options)
      : given_(machine),
        machine_(machine),
        whole_(run),
        as_measured_(run),
        run_(run),
        reading_sd_(reading_sd),
        options_(options) {}

  Explained Run();

 private:
  /// What models are settled beside.
  ConvergedBeside Beside(PhysicsSteps steps) const;
  /// Those to begin with: one that a move was judged behind, and that of the model so far.
  std::vector<FilterNoise> NoisesBeside(const FilterNoise& near) const;
  /// What the search may go on from.
  struct Proposal {
    ConvergedModel settled;
    PhysicsSteps steps = {};
    double input_width = 0.0;  ///< [ticks]
    MeasuredRun run;
  };
  void Adopt(Proposal proposal);
  void Take(ConvergedModel model);
  void KeepRivals(const Moves& moves);
  /// What a rival is worth once it has been fitted. @param score  less that of the model
  void Rate(const Model& rival, double score);
  std::optional<ConvergedModel> ConvergedAnew(const Whitenings& whitenings,
                                              const Moves& moves,
                                              const ModelFit& as_it_is) const;
  std::string Difference(double score) const {
    char text[40];
    std::snprintf(text, sizeof text, "%.1f", score - found_.score);
    return text;
  }
  /// Behind which of the whitenings, and whether with other steps.
  using Judged = std::pair<std::size_t, bool>;
  ModelFit Fitted(const Model& model, const Whitenings& whitenings,
                  const Judged& judged, FitEffort effort) const;
  /// The model as it is, fitted behind gains that moves are compared behind.
  using AsFitted = std::map<Judged, ModelFit>;
  const ModelFit& IncumbentBehind(const Judged& judged, const Whitenings& whitenings,
                                  const Moves& moves, AsFitted& known) const;
  /// The best of some moves, fitted; none if none pays.
  /// @param iterations     of a fit; 0: at the values of the regression
  /// @param beside_itself  where there are none: beside the model as it is, behind its noise
  ///                       anew
  std::optional<Proposal> BestOf(const Moves& moves, std::size_t most, int iterations,
                                 const Whitenings& whitenings, AsFitted& as_it_is,
                                 bool beside_itself);
  /// What is known of the model as it is, along its path.
  struct Standing {
    Whitenings whitenings;
    ExactColumns exact;
    AsFitted as_fitted;
    std::map<bool, Moves> moves;  ///< at the simplest shapes, and at every
  };
  Standing& StandingNow();
  /// Beside the model as it is.
  Negligible NegligibleNow();
  const Moves& MovesNow(Standing& standing);
  struct StepsBehind {
    PhysicsSteps steps;
    double gain = 0.0;
  };
  StepsBehind LikelySteps(const Standing& standing, std::size_t noise) const;
  /// Takes likely steps with values anew where that is better.
  bool TakeStepsBehind(const Standing& standing, std::size_t noise);
  bool TakeSteps(const StepsBehind& likely, const FilterNoise& near);
  void SayOf(PhysicsSteps steps, double score) const;
  /// Whether a part of the run promises next to nothing: what is that small is told apart by
  /// all of it.
  bool IsForAll(const Moves& moves) const;
  std::optional<Proposal> BestForces(Standing& standing);
  std::optional<Proposal> BestMove(Standing& standing);
  /// How much of its inputs did the machine not feel?
  std::optional<Proposal> SmoothedInputs() const;
  Proposal Incumbent() const {
    return {{found_.fit, found_.path}, steps_, found_.input_width, run_};
  }
  /// Takes what is better; false if nothing pays.
  bool Step();
  /// What no law explains may be a force without a name.
  void AddCurves();
  void Prepare();
  void StepOn();
  /// A run, all of it or pieces, once in so many ticks.
  void LookAt(const MeasuredRun& run, int ticks);
  /// A machine along a run, behind the noise of a path of other ticks.
  FilterPath Along(const Machine& machine, const MeasuredRun& run,
                   const FilterPath& path) const;
  /// The same beside the run that is looked at, which tells how long a filter takes.
  FilterPath Timed(const Model& model, const FilterPath& path);
  /// From pieces to all of the run, and to every tick if that tells more.
  void LookAtAll();
  void Decide(const Model& tried, double score, const std::string& why) {
    found_.decisions.push_back({ModelText(found_.blocks, tried), score, why});
  }
  bool HasTooManyCauses(const Model& model) const {
    const auto causes = std::ranges::count_if(model, [&](const Member& member) {
      return found_.blocks[member.block].candidate.has_value();
    });
    return static_cast<std::size_t>(causes) > options_.most_causes;
  }
  /// Whether its values are such as its laws and numbers can have.
  bool MayHave(const Model& model) const {
    return std::ranges::all_of(model, [&](const Member& member) {
      const Block& block = found_.blocks[member.block];
      return IsAllowed(block, member.values) && ((may_be_at_ends_ && !block.number) ||
                                                 !HasActiveBound(block, member.values));
    });
  }
  bool IsOne(const Model& model) const {
    return MayHave(model) && IsResolved(found_.blocks, model);
  }
  bool MayBe(const ModelMove& move) const {
    const Model after = After(move, found_.fit.model);
    return !HasTooManyCauses(after) && IsResolved(found_.blocks, after);
  }
  /// Whether it promises less than first order was off by for a block that it brings.
  bool PromisesNothing(const ModelMove& move, double promise) const {
    return std::ranges::any_of(move.added, [&](const Added& added) {
      const auto off = off_by_.find(added.variation.block);
      return off != off_by_.end() && promise < off->second;
    });
  }
  bool IsFirstLook() const { return is_part_ || found_.ticks > 1; }
  bool IsStopped() const { return options_.stop && options_.stop(); }
  bool IsOver() const { return time_.Seconds() > seconds_ || IsStopped(); }
  void Say(const std::string& text) const {
    if (options_.progress) options_.progress(text);
  }

  Machine With(const Model& model) const { return With(model, steps_); }
  Machine With(const Model& model, PhysicsSteps steps) const {
    if (IsStopped()) throw NumericalError("fit: asked to end");
    return Made(model, steps);
  }
  Machine Made(const Model& model, PhysicsSteps steps) const {
    return steps.Of(machine_.With(ChangesOfModel(found_.blocks, model)));
  }
  /// Whether the model's steps hide something that finer ones show.
  /// @param beat  a score
  bool ChooseFinerSteps(double beat);
  /// Whether what some hundred filters take is a small part of the time that is left.
  bool HasTimeForFits() const;
  /// Whether joints that rub and stand hold, as machines do, or give way, as simulations do.
  /// @return whether they do otherwise than the model so far
  bool ChooseFriction();
  /// How joints stand may be worth more than what told two models apart that rub: those that
  /// were nearly as good are asked again with friction of that form.
  void AskRunnersUp(std::vector<Model> runners_up);

  const Machine& given_;
  Machine machine_;  // as given, in the ticks that are looked at
  PhysicsSteps steps_;
  const MeasuredRun& whole_;
  MeasuredRun as_measured_;  // all of it, or pieces, or once in some ticks
  bool is_part_ = false;
  bool inputs_are_noise_ = false;  // some of what was measured of them
  MeasuredRun run_;                // with its inputs smoothed
  const Eigen::VectorXd& reading_sd_;
  const ExplainOptions& options_;
  WorkTime time_;
  double seconds_of_run_ = 0.0;        // of one filter, about
  double seconds_ = options_.seconds;  // allowed by now
  std::vector<Candidate> candidates_;
  /// What is large comes first.
  bool looks_at_forces_ = true;
  /// What is simple comes first, too.
  bool at_every_shape_ = false;
  /// And what makes up for another thing comes last; of a number of the plant it never does.
  bool may_be_at_ends_ = false;
  /// Values and noises are asked to the end.
  bool is_last_ = false;
  /// Models that a step found better than the one before, and worse than another.
  std::vector<Model> runners_up_;
  /// Models that were tried in the place of this one and are far from it.
  std::vector<Model> hopeless_;
  /// What moves made of this one along this path, and fits behind kept gains found no better.
  std::vector<Model> worthless_;
  /// What first order promised of blocks that came in alone, and a fit lost instead, where it knew
  /// nothing of them.
  std::map<std::size_t, double> off_by_;
  /// Dry friction whose forms have been asked (other_friction.h).
  Model asked_forms_of_;
  Explained found_;
  std::optional<Standing> standing_;  // none where the model or its path is another
};

}  // namespace mjdiag
