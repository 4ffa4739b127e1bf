// The stages of a discovery: checks, the search, the judgement of what was found by data that
// no fit saw, and the answer with its figures.

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "mjdiag/discovery/answer/answer_data.h"
#include "mjdiag/discovery/answer/answer_notes.h"
#include "mjdiag/discovery/answer/fault_figures.h"
#include "mjdiag/discovery/answer/force_figures.h"
#include "mjdiag/discovery/answer/found_members.h"
#include "mjdiag/discovery/answer/found_moments.h"
#include "mjdiag/discovery/answer/missing_share.h"
#include "mjdiag/discovery/answer/posterior.h"
#include "mjdiag/discovery/answer/prediction_figures.h"
#include "mjdiag/discovery/answer/replay_figures.h"
#include "mjdiag/discovery/answer/resistances.h"
#include "mjdiag/discovery/answer/split_run.h"
#include "mjdiag/discovery/answer/unseen_judgement.h"
#include "mjdiag/discovery/answer/values_that_predict.h"
#include "mjdiag/discovery/discovery.h"
#include "mjdiag/discovery/fit/explain.h"
#include "mjdiag/discovery/fit/first_look.h"
#include "mjdiag/discovery/fit/input_choice.h"
#include "mjdiag/plugin/replay/coarser_run.h"
#include "mjdiag/plugin/replay/sensor_noise.h"
#include "mjdiag/plugin/runtime/work_time.h"
#include "mjdiag/signals/listed.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

/// Of the budget, what the search may use; the rest is for the judgement.
constexpr double kShareOfSearch = 0.7;
/// And both together, the rest is for figures.
constexpr double kShareOfJudgement = 0.85;
/// And with the pictures of laws.
constexpr double kShareOfLaws = 0.93;

/// Seconds since a discovery began, against its budget.
class RunningTime {
 public:
  explicit RunningTime(const DiscoverOptions& options) : options_(options) {}

  double Used() const { return time_.Seconds(); }
  bool IsStopped() const { return options_.stop && options_.stop(); }
  bool IsOver(double share = 1.0) const {
    return IsStopped() || Used() > share * options_.budget;
  }
  double SecondsOfSearch() const { return kShareOfSearch * options_.budget; }
  void Say(const std::string& what, double fraction) const {
    if (options_.progress) options_.progress({what, fraction, best_, options_.budget});
  }
  void SetBest(std::string best) { best_ = std::move(best); }
  double FractionOfSearch() const {
    return kShareOfSearch * std::min(1.0, Used() / SecondsOfSearch());
  }

 private:
  const DiscoverOptions& options_;
  std::string best_;
  WorkTime time_;
};

std::vector<ModelParameter> UncertainParameters(const Machine& machine,
                                                const DiscoverOptions& options) {
  if (!options.doubt) return {};
  std::vector<ModelParameter> numbers = NumbersOf(machine.plant());
  for (const std::string& text : options.known) {
    for (const ModelParameter& known : ModelParametersOf(machine.plant(), text)) {
      std::erase(numbers, known);
    }
  }
  return numbers;
}

/// "coulomb_friction@load (mismatch 100 % to 7 %)": of the latent forces, rms.
std::string BestOf(const Explained& found) {
  std::string names;
  for (const Member& member : found.fit.model) {
    names += (names.empty() ? "" : ", ") + found.blocks[member.block].name;
  }
  if (names.empty()) return "";
  const auto rms = [](const FilterPath& path) {
    return path.forces.norm() / std::sqrt(static_cast<double>(path.samples()));
  };
  const double left = rms(found.path) / std::max(rms(found.nothing), 1e-300);
  return names + " (mismatch 100 % to " + FormatNumber(100.0 * left, 2) + " %)";
}

ExplainOptions OptionsOfSearch(const Machine& machine, const DiscoverOptions& options,
                               RunningTime& time) {
  ExplainOptions search;
  search.seconds = time.SecondsOfSearch();
  search.choice = options.choice;
  search.numbers = UncertainParameters(machine, options);
  // What has more at one joint is no knowledge of it.
  constexpr int kOfJoint = 8;
  const int most = options.most_causes.value_or(kOfJoint * machine.plant().nv);
  search.most_causes = static_cast<std::size_t>(std::max(0, most));
  search.stop = options.stop;
  search.progress = [&time](const std::string& text) {
    time.Say(text, time.FractionOfSearch());
  };
  search.better = [&time](const Explained& found) { time.SetBest(BestOf(found)); };
  return search;
}

/// Behind the smoothing that the inputs deserve.
SplitRun WithInputsFelt(SplitRun run, double width) {
  run.seen = WithInputsOver(run.seen, width);
  run.unseen = WithInputsOver(run.unseen, width);
  return run;
}

void NoteInputNoise(const Machine& machine, const SplitRun& measured,
                    const SplitRun& felt, std::vector<std::string>& notes) {
  Index i = 0;
  for (const ActuatorSetup& actuator : machine.channels().actuators) {
    const VectorXd noise =
        (measured.seen.inputs.row(i) - felt.seen.inputs.row(i)).transpose();
    ++i;
    if (noise.isZero(0.0)) continue;
    const double rms =
        std::sqrt(noise.squaredNorm() / static_cast<double>(noise.size()));
    notes.push_back(actuator.channel + " was measured with noise of " +
                    FormatQuantity(rms, actuator.unit) +
                    ", which the machine did not feel");
  }
}

/// Waves over time that come round a few times each are, three at once, a course of time as a
/// Fourier series has it: any law along a motion that repeats itself as little looks so.
bool IsCourseOfTime(const std::vector<FoundCause>& causes, const MeasuredRun& run) {
  constexpr double kFewTimes = 10.0;
  constexpr Index kSeries = 3;
  Index longest = 0;
  for (std::size_t r = 0; r < run.records.size(); ++r) {
    longest = std::max(longest, run.SamplesOf(r));
  }
  const double seconds = run.sample_time * static_cast<double>(longest);
  return std::ranges::count_if(causes, [&](const FoundCause& found) {
           return found.cause.effect->variable() == LawVariable::kTime &&
                  std::ranges::any_of(found.parameters, [&](const CauseParameter& one) {
                    return one.name == "frequency" && one.value * seconds < kFewTimes;
                  });
         }) >= kSeries;
}

/// What the budget did not allow.
void NoteTime(const RunningTime& time, const DiscoverOptions& options,
              const Explained& explained, const UnseenJudgement& judged,
              bool has_all_laws, Discovery& discovery) {
  Budget& budget = discovery.budget;
  budget = {time.Used(), options.budget, time.IsStopped(), {}};
  if (explained.is_cut_short) budget.left_out.emplace_back("further causes");
  if (judged.is_cut_short) {
    budget.left_out.emplace_back(
        "whether unseen data ask for every member of the answer");
  }
  if (!has_all_laws) budget.left_out.emplace_back("pictures of some laws");
  if (options.figures && discovery.ladder.empty()) {
    budget.left_out.emplace_back("figures of every member by itself");
  }
  if (budget.left_out.empty()) return;
  discovery.notes.push_back(NoteOfBudget(budget, Listed(budget.left_out, " and ")));
}

}  // namespace

Discovery Discover(const Machine& machine, const Measurements& measurements,
                   const DiscoverOptions& options) {
  RunningTime time(options);
  Discovery discovery;
  discovery.notes = NotesOfChecks(machine.plant(), measurements, options.doubt);
  const SplitRun run = Split(measurements, options.train_share);
  const VectorXd reading_sd = SensorNoise(machine.channels(), run.seen);
  discovery.setup = machine.setup().name;
  discovery.train_share = run.share;
  discovery.sample_time = machine.rates().tick();

  time.Say("the machine as given", 0.0);
  Explained explained =
      Explain(machine, run.seen, reading_sd, OptionsOfSearch(machine, options, time));
  discovery.substeps = explained.steps.finer * machine.rates().substeps;
  const Machine looked_at = InTicksOf(machine, explained.ticks);
  const SplitRun looked = Coarser(run, explained.ticks);
  const SplitRun felt = WithInputsFelt(looked, explained.input_width);
  const AnswerData data{looked_at, felt, reading_sd, explained.blocks, explained.steps};
  NoteInputNoise(machine, looked, felt, discovery.notes);
  time.Say("what unseen data say", kShareOfSearch);
  UnseenJudgement judged =
      JudgeUnseen(data, explained, [&] { return time.IsOver(kShareOfJudgement); });
  if (auto better =
          WithValuesThatPredict(data, judged.answer, judged.nothing.seen.noise,
                                [&] { return time.IsOver(); })) {
    judged.answer = std::move(better->answer);
    judged.decisions.push_back(
        {ModelText(data.blocks, judged.answer.fit.model), better->log_ratio,
         "taken: values that leave less of what lasts predict both "
         "what fits saw and what they did not better"});
  }
  MissingShare share = ShareLeft(data, judged);
  // Likelier it may be, of what is worse than the machine as given nobody can use anything.
  if (share.IsWorse()) {
    LeaveNothing(
        data.blocks,
        "left out: more force is missing on data that no fit saw than without it",
        share.left, judged);
    share = ShareLeft(data, judged);
  }
  discovery.decisions = explained.decisions;
  std::ranges::copy(judged.decisions, std::back_inserter(discovery.decisions));
  discovery.verdict = VerdictOf(share, !judged.answer.fit.model.empty());
  if (share.is_left && !judged.answer.fit.model.empty()) {
    discovery.force_left = share.left;
  }
  const CoordinateErrors errors = CoordinateErrorsOf(data, judged.answer);
  AddMembers(data, judged, PosteriorOf(explained, judged), errors.sd, discovery);
  AddMoments(data, judged.answer, errors, discovery);
  AddResistances(data, judged.answer, errors, discovery);
  // A force without a name is described, not explained.
  if (discovery.verdict == DiscoveryVerdict::kExplained &&
      (!std::ranges::all_of(discovery.causes, &FoundCause::HasName) ||
       IsCourseOfTime(discovery.causes, data.run.seen))) {
    discovery.verdict = DiscoveryVerdict::kPartlyExplained;
  }
  const bool is_left = discovery.verdict == DiscoveryVerdict::kPartlyExplained ||
                       discovery.verdict == DiscoveryVerdict::kUnexplained;
  if (!is_left) {
    AddRaisedNoise(data, judged.answer, options.choice, discovery);
    if (!discovery.causes.empty()) discovery.verdict = DiscoveryVerdict::kExplained;
  }
  AddNotes(
      data, judged, [&] { return options.figures && !time.IsOver(); }, discovery);
  bool has_all_laws = true;
  if (options.figures || discovery.verdict == DiscoveryVerdict::kUnexplained) {
    time.Say("unexplained forces", 0.8);
    const ObservedMotion motion = MotionOfAnswer(data, judged);
    AddForces(data, judged, discovery);
    if (is_left && !time.IsOver()) {
      AddResidualDependence(data, judged, motion, discovery);
    }
    if (options.figures) {
      has_all_laws = AddLawPlots(
          data, judged, motion, [&] { return time.IsOver(kShareOfLaws); }, discovery);
    }
  }
  if (options.figures) {
    time.Say("figures", 0.9);
    const Changes changes = ChangesOfAnswer(discovery);
    const bool follows = AddReplays(
        measurements, changes, data.steps, machine.setup().compare.skip_samples,
        options.seed, NoiseInTicksOf(explained.nothing, machine.rates().tick()),
        discovery);
    if (follows) AddPredictions(data, judged, discovery);
    if (!time.IsOver()) AddLadderOf(data, judged, measurements, follows, discovery);
    if (!time.IsOver()) AddMinimumDetectableFaults(data, judged, discovery);
  }
  NoteTime(time, options, explained, judged, has_all_laws, discovery);
  return discovery;
}

Discovery Discover(const Machine& machine, const Record& measured,
                   const Record* validation, const DiscoverOptions& options) {
  return Discover(machine, MeasurementsOf(machine, measured, validation), options);
}

}  // namespace mjdiag
