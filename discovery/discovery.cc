#include "mjdiag/discovery/discovery.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iterator>
#include <optional>
#include <thread>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/discovery/answer/answer_notes.h"
#include "mjdiag/discovery/discoverer.h"
#include "mjdiag/discovery/hypotheses/candidate_bounds.h"
#include "mjdiag/discovery/record_replay.h"
#include "mjdiag/discovery/selection/coarse_problem.h"
#include "mjdiag/discovery/selection/completeness.h"
#include "mjdiag/discovery/selection/learned_numbers.h"
#include "mjdiag/discovery/selection/model_choice.h"
#include "mjdiag/discovery/selection/verdict.h"
#include "mjdiag/plugin/plant/fixed_numbers.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Bandwidth of the fast observer, of the control rate.
constexpr double kFastShare = 0.02;
constexpr int kFurtherCauses = 3;

constexpr const char* kFasterObserver = "a search behind a faster observer";

}  // namespace

DiscoveryProblem Discoverer::Pose(double bandwidth) const {
  DiscoveryProblem problem =
      PoseProblem(machine_, RunOf(measurements_.fit), options_.train_share, bandwidth)
          .Charging(work_);
  constexpr double kRuns = 2.0;  // to know the noise
  work_->Add(kRuns * problem.RunWork());
  return problem;
}

void Discoverer::MeasureNominal() {
  nominal_ =
      MeanSquare(problem_, problem_.Residual({}), problem_.skip(), problem_.train());
}

namespace {

/// What is missing along a motion that leaves the rest is balanced on one plant.
void RequireOnePlant(const Measurements& measurements) {
  for (const auto* records : {&measurements.fit, &measurements.unseen}) {
    for (const MeasuredRecord& one : *records) {
      if (!one.own_plant) continue;
      throw InputError(one.name,
                       "has a plant of its own, and the machine leaves its rest in it",
                       "records of one load at a time of such a machine");
    }
  }
}

}  // namespace

/// How long the budget is on this machine, for people: by the time of one run of the plant
/// as it is given. The work that is counted knows nothing of it.
void Discoverer::MeasureSpeed() {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  const DiscoveryProblem own = problem_.Charging(std::make_shared<Work>());
  own.Residual({});
  const std::chrono::duration<double> taken = Clock::now() - begin;
  // A run has one core; work is that of two.
  constexpr unsigned kCores = 2;
  const unsigned cores = std::clamp(std::thread::hardware_concurrency(), 1U, kCores);
  most_seconds_ = work_->limit() * taken.count() / (cores * own.RunWork());
}

void Discoverer::Report(const std::string& what, double fraction,
                        const CauseFit& best) const {
  if (!options_.progress) return;
  DiscoveryProgress progress{what, fraction, "", most_seconds_};
  for (const FittedCause& cause : best.causes) {
    progress.best +=
        (progress.best.empty() ? "" : ", ") + Describe(candidates_[cause.candidate]);
  }
  if (!best.causes.empty() && nominal_ > 0.0) {
    progress.best += " (mismatch 100 % to " +
                     FormatNumber(100.0 * std::sqrt(best.train / nominal_), 2) + " %)";
  }
  options_.progress(progress);
}

// What a real machine does beside all models is no white noise: behind a slow observer
// it piles up, and few of its values are independent of each other. A fast observer
// takes it away as it comes, and smaller causes show.
bool Discoverer::IsColoured(const CauseFit& fit) const {
  return fit.train > kFarAboveNoise &&
         IndependentShare(problem_, fit.residual).minCoeff() < 0.5;
}

/// Goes on from the causes found so far, behind the observer of the problem: in long steps
/// where these are near enough, then in those of the setup. Down to the noise the long
/// steps have to stay near; beside a rest that is far above it anyway they need not.
void Discoverer::Search(const DiscoveryProblem& problem, SearchOptions options,
                        bool down_to_noise) {
  constexpr int kMostCoarse = 4;
  const auto causes = [this] { return static_cast<int>(search_.fit().causes.size()); };
  const int before = causes();
  const int most = options.most_causes;
  for (int i = 0; i < kMostCoarse && work_->MayBegin("further causes"); ++i) {
    const auto coarse =
        Coarsen(problem, ChangesOf(problem, candidates_, search_.fit()));
    if (!coarse) break;
    const int at = causes();
    SearchOptions rough = options;
    rough.last_fit = false;
    rough.serves = [&](const CauseFit& fit) {
      if (options.serves && !options.serves(fit)) return false;
      return !down_to_noise ||
             IsNear(*coarse, problem, ChangesOf(problem, candidates_, fit));
    };
    search_ = SearchCauses(*coarse, candidates_, rough, &search_);
    if (search_.served && options.preliminary && options.preliminary(search_.fit()) &&
        work_->MayBegin(kFasterObserver)) {
      return;
    }
    options.most_causes = std::max(0, most - (causes() - before));
    // Long steps that are near no more may be again, shifted for what has been found.
    if (search_.served || causes() <= at) break;
  }
  search_ = SearchCauses(problem, candidates_, options, &search_);
}

/// Where runs are so long that a search of the whole record would use up the work, it goes
/// on from one of its beginning, whose own choices it looks at again.
void Discoverer::SearchBeginning(SearchOptions options) {
  constexpr double kRuns = 400.0;  // of a search among some numbers and causes
  if (problem_.numbers().empty() || kRuns * problem_.RunWork() < work_->limit()) return;
  const DiscoveryProblem beginning = BeginningOf(problem_);
  if (beginning.run().samples() == problem_.train()) return;
  options.last_fit = false;
  options.exchange = false;
  options.unseen = nullptr;
  options.free_run = nullptr;
  options.serves = [this](const CauseFit&) {
    constexpr double kShare = 0.35;  // the whole record takes more than its beginning
    return work_->used() < kShare * work_->limit();
  };
  Search(beginning, options, true);
}

/// Behind the observer of the problem, and a fast one where it leaves what is coloured.
void Discoverer::SearchBehindObservers(SearchOptions options) {
  SearchBeginning(options);
  options.preliminary = [this](const CauseFit& fit) {
    return options_.bandwidth == 0.0 && IsColoured(fit);
  };
  Search(problem_, options, true);
  if (!options.preliminary(search_.fit()) || !work_->MayBegin(kFasterObserver)) return;
  std::vector<DoubtedNumber> numbers = problem_.numbers();
  problem_ = Pose(kFastShare * machine_.rates().control).Doubting(std::move(numbers));
  MeasureNominal();
  // Every further one takes longer than all before it.
  options.most_causes = std::min(options.most_causes, kFurtherCauses);
  options.preliminary = nullptr;
  Search(problem_, options, false);
}

std::vector<PlantNumber> Discoverer::KnownNumbers() const {
  std::vector<PlantNumber> known;
  for (const std::string& text : options_.known) {
    for (const PlantNumber& number : PlantNumbersOf(machine_.plant(), text)) {
      known.push_back(number);
    }
  }
  return known;
}

double Discoverer::UnseenFree(const Changes& changes) const {
  Index samples = 0;
  for (const MeasuredRecord& one : measurements_.unseen) {
    samples += one.record.samples();
  }
  work_->Add(problem_.RunWork() * static_cast<double>(samples) /
             static_cast<double>(problem_.run().samples()));
  return FreeRun(measurements_.unseen, changes, problem_.observer().noise_sd);
}

void Discoverer::SearchAll() {
  SearchOptions options;
  options.most_causes = options_.most_causes;
  options.progress = [this](const std::string& what, double fraction,
                            const CauseFit& best) { Report(what, fraction, best); };
  std::optional<MeasuredRun> unseen;
  if (!measurements_.unseen.empty()) {
    unseen = RunOf(measurements_.unseen);
    options.unseen = &*unseen;
    if (!falls_) {
      options.free_run = [this](const Changes& changes) { return UnseenFree(changes); };
    }
  }
  if (options_.doubt && work_->MayBegin("numbers of the plant")) {
    Report("numbers of the plant", 0.0);
    problem_ = WithDoubts(problem_, KnownNumbers());
    // Along the motion they are found with the laws.
    if (auto learned = GoesAlongMotion() ? std::nullopt
                                         : LearnedNumbersOf(problem_, candidates_)) {
      search_.numbers_alone = learned->numbers;
      search_.evidence = search_.evidence.Changed(std::move(*learned));
    }
    work_->NoteChange();
  }
  if (TakeForces(options)) {
    // Fitted along the motion.
  } else if (TakeSets(options)) {
    FitSets(options);
  } else {
    SearchBehindObservers(options);
  }
  // Where the search ended before it has screened what is left, the noise tells.
  if (!search_.screened && IsComplete(ProbabilityThatNoiseIsLeft())) {
    search_.significant_rest = false;
  }
  work_->EndLaws();
  if (!force_) LearnCurves(options);
  FitFree();
  work_->EndSearch();
  DropEmptyCauses();
  if (!free_fit_) CompleteJacobian();
}

double Discoverer::ProbabilityThatNoiseIsLeft() const {
  Eigen::ArrayXX<bool> measured;
  if (!measurements_.unseen.empty()) {
    MeasuredRun unseen = RunOf(measurements_.unseen);
    unseen.Discount(problem_.skip());
    measured = unseen.Counted();
  }
  return ProbabilityOfNoise(NoiseValue(problem_, search_.fit().residual,
                                       search_.evidence.Replayed(), measured));
}

double Discoverer::Completeness() const {
  const auto is_stopgap = [&](const FittedCause& cause) {
    return curves_.contains(cause.candidate) || IsAtItsEnd(candidates_, cause);
  };
  if (std::ranges::any_of(search_.fit().causes, is_stopgap)) return 0.0;
  // Of whatever colour: noise that has been raised leaves nothing for a screening. What a
  // search that was cut short has not come to may be the other part of what it named.
  const bool is_known =
      search_.fit().train <= kFarAboveNoise && work_->left_out().empty();
  if (search_.significant_rest && !is_known) return 0.0;
  return ProbabilityThatNoiseIsLeft();
}

Discovery Discoverer::Run() {
  discovery_.setup = machine_.setup().name;
  discovery_.train_share = static_cast<double>(problem_.train()) /
                           static_cast<double>(problem_.run().samples());
  discovery_.sample_time = machine_.rates().tick();
  if (problem_.observer().following) RequireOnePlant(measurements_);
  falls_ = problem_.observer().following && AnyFalls(measurements_);
  BoundByRecord(candidates_, machine_, problem_.MotionOf(problem_.Nominal()));
  MeasureNominal();
  if (options_.progress) MeasureSpeed();
  SearchAll();
  discovery_.substeps = machine_.rates().substeps;
  discovery_.complete = Completeness();
  NameCauses();
  FindKinds();
  const std::array plants{Changes{}, ChangesOf(problem_, candidates_, search_.fit())};
  std::array<Track, 2> tracks;
  ParallelFor(2, [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    tracks[i] = problem_.Follow(plants[i]);
  });
  const auto& [nominal, found] = tracks;
  if (!search_.significant_rest) {
    AddNoiseCauses(found.innovations);
  }
  Judge();

  const Track final = discovery_.causes.empty() ? nominal
                      : changes_ == plants[1]   ? found
                                                : problem_.Follow(changes_);
  const ObservedMotion motion = problem_.MotionOf(final);
  NoteQuietAxes(motion);
  for (std::size_t i = 0; i < named_.size(); ++i) NoteTwins(i);
  NoteFarNumbers();
  if (options_.figures || discovery_.verdict == DiscoveryVerdict::kUnexplained) {
    Report("unexplained forces", 0.8);
    FindWhere(nominal, final);
    SignRest(motion);
  }
  if (options_.figures) {
    Report("figures", 0.9);
    AddLaws(motion);
    AddLadder();
    AddComparisons();
    AddLimits();
    discovery_.colour_before =
        1.0 - IndependentShare(problem_, problem_.Scaled(nominal)).mean();
    discovery_.colour_after =
        1.0 - IndependentShare(problem_, problem_.Scaled(final)).mean();
  }
  NoteIncompleteness();
  NoteBudget();
  return std::move(discovery_);
}

Discovery Discover(const Machine& machine, const Measurements& measurements,
                   const DiscoverOptions& options) {
  Measurements split = WithUnseen(measurements, options.train_share);
  const std::vector<std::string> notes =
      NotesOfChecks(machine.plant(), split, options.doubt);
  Discovery discovery = Discoverer(machine, std::move(split), options).Run();
  discovery.notes.insert(discovery.notes.begin(), notes.begin(), notes.end());
  return discovery;
}

Discovery Discover(const Machine& machine, const Record& measured,
                   const Record* validation, const DiscoverOptions& options) {
  return Discover(machine, MeasurementsOf(machine, measured, validation), options);
}

Changes ChangesOf(const Discovery& discovery) {
  std::vector<Cause> causes;
  for (const FoundCause& found : discovery.causes) causes.push_back(found.cause);
  Changes changes = ChangesOf(causes);
  for (const CalibratedNumber& number : discovery.calibration) {
    if (number.factor == 1.0) continue;
    changes.numbers.emplace_back(number.number, number.factor);
  }
  return changes;
}

bool HasFound(const Discovery& discovery) {
  return !discovery.causes.empty() || std::ranges::any_of(discovery.calibration, IsOff);
}

const RecordReplay* Discovery::Fitted() const {
  return records.empty() ? nullptr : &records.front();
}

const RecordReplay* Discovery::Unseen() const {
  const auto first = std::ranges::find(records, false, &RecordReplay::seen);
  return first == records.end() ? nullptr : &*first;
}

// Data have to say more than what was known before, and something else.
constexpr double kBeyondDoubt = 0.5;

bool IsMoved(const CalibratedMoment& moment) {
  const double known = 2.0 * TwoSidedNormalQuantile(0.05) * moment.doubt;
  return moment.high - moment.low < kBeyondDoubt * known &&
         (moment.low > moment.model || moment.high < moment.model);
}

bool IsOff(const CalibratedNumber& number) {
  if (number.is_found) return true;
  const double width = std::log(number.high / number.low);
  const double known = 2.0 * TwoSidedNormalQuantile(0.05) * number.doubt;
  return width < kBeyondDoubt * known && (number.low > 1.0 || number.high < 1.0);
}

}  // namespace mjdiag
