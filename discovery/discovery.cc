#include "mjdiag/discovery/discovery.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "mjdiag/discovery/candidate.h"
#include "mjdiag/discovery/cause_fit.h"
#include "mjdiag/discovery/data_check.h"
#include "mjdiag/discovery/fault_limits.h"
#include "mjdiag/discovery/law.h"
#include "mjdiag/discovery/problem.h"
#include "mjdiag/discovery/replay_error.h"
#include "mjdiag/discovery/search.h"
#include "mjdiag/discovery/sensor_noise.h"
#include "mjdiag/discovery/telling_motion.h"
#include "mjdiag/plugin/mujoco_model.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Below this share of the excess over noise that causes take away they are not an
// explanation but the best of the wrong ones.
constexpr double kNamedShare = 0.9;
// Bandwidth of the fast observer, of the control rate.
constexpr double kFastShare = 0.02;
constexpr double kLeastProbability = 0.01;
constexpr double kNormal95 = 1.959964;
constexpr Index kLawPoints = 3000;

/// A discovery under way.
class Discoverer {
 public:
  Discoverer(const Setup& setup, const mjModel& plant, const Record& measured,
             const Record* validation, const DiscoverOptions& options)
      : setup_(setup),
        plant_(plant),
        measured_(measured),
        validation_(validation),
        options_(options),
        problem_(PoseProblem(setup, plant, measured, options.train_share,
                             options.bandwidth)),
        candidates_(ListCandidates(setup, plant, problem_.model)) {}

  Discovery Run();

 private:
  void Report(const std::string& what, double fraction) const {
    if (options_.progress) options_.progress(what, fraction);
  }
  Cause CauseOf(const FittedCause& fitted) const;
  Track FollowWith(const Changes& changes) const {
    return FollowRun(setup_, plant_, changes, problem_.run, problem_.observer, true);
  }
  ObservedMotion MotionOf(const Track& track) const {
    return ObserveMotion(plant_, problem_.run, track, problem_.StillSpeed());
  }
  bool IsColoured() const;
  void NameCauses();
  std::vector<CauseParameter> ParametersOf(const FittedCause& fitted,
                                           const MatrixXd& covariance,
                                           Index first) const;
  std::vector<Alternative> AlternativesOf(
      const FittedCause& fitted, const std::vector<Contender>& contenders) const;
  void AddNoiseCauses(const MatrixXd& innovations);
  void Judge();
  void NoteQuietAxes(const ObservedMotion& motion);
  void NoteTwins(std::size_t cause, const std::vector<Contender>& contenders);
  void FindWhere(const Track& nominal, const Track& final);
  void SignRest(const ObservedMotion& motion);
  void AddLaws(const ObservedMotion& motion);
  void AddLadder();
  void AddComparisons();
  void AddLimits(const Track& nominal, const Track& final);

  const Setup& setup_;
  const mjModel& plant_;
  const Record& measured_;
  const Record* validation_;
  const DiscoverOptions& options_;
  DiscoveryProblem problem_;
  std::vector<Candidate> candidates_;
  SearchResult search_;
  Changes changes_;
  Discovery discovery_;
};

Cause Discoverer::CauseOf(const FittedCause& fitted) const {
  const Candidate& candidate = candidates_[fitted.candidate];
  Cause cause = candidate.cause;
  for (std::size_t i = 0; i < candidate.parameters.size(); ++i) {
    cause.spec.parameters[candidate.parameters[i].name] =
        fitted.value[static_cast<Index>(i)];
  }
  return cause;
}

std::vector<CauseParameter> Discoverer::ParametersOf(const FittedCause& fitted,
                                                     const MatrixXd& covariance,
                                                     Index first) const {
  const Candidate& candidate = candidates_[fitted.candidate];
  std::vector<CauseParameter> parameters;
  for (std::size_t i = 0; i < candidate.parameters.size(); ++i) {
    const auto index = static_cast<Index>(i);
    const double value = fitted.value[index];
    const double sd = std::sqrt(covariance(first + index, first + index));
    const std::string& name = candidate.parameters[i].name;
    const std::string unit =
        candidate.cause.fault ? "1" : SiteUnit(plant_, candidate.cause.spec, name);
    parameters.push_back(
        {name, unit, value, sd, value - kNormal95 * sd, value + kNormal95 * sd});
  }
  return parameters;
}

std::vector<Alternative> Discoverer::AlternativesOf(
    const FittedCause& fitted, const std::vector<Contender>& contenders) const {
  std::vector<Alternative> alternatives;
  for (const Contender& other : contenders) {
    if (other.cause.candidate == fitted.candidate) continue;
    if (other.probability < kLeastProbability) continue;
    alternatives.push_back({CauseOf(other.cause), other.probability, false});
  }
  return alternatives;
}

// What a real machine does beside all models is no white noise: behind a slow observer
// it piles up, and few of its values are independent of each other. A fast observer
// takes it away as it comes, and smaller causes show.
bool Discoverer::IsColoured() const {
  constexpr double kMuch = 4.0;  // times the noise power of the sensors
  return search_.fit.train > kMuch &&
         IndependentShare(problem_, search_.fit.residual).minCoeff() < 0.5;
}

void Discoverer::NameCauses() {
  const CauseFit& fit = search_.fit;
  if (fit.causes.empty()) return;
  const MatrixXd covariance = ParameterCovariance(problem_, fit);
  Index first = 0;
  for (std::size_t i = 0; i < fit.causes.size(); ++i) {
    FoundCause found;
    found.cause = CauseOf(fit.causes[i]);
    found.parameters = ParametersOf(fit.causes[i], covariance, first);
    first += fit.causes[i].value.size();
    found.probability = 1.0;
    for (const Contender& contender : search_.contenders[i]) {
      if (contender.cause.candidate == fit.causes[i].candidate) {
        found.probability = contender.probability;
      }
    }
    found.alternatives = AlternativesOf(fit.causes[i], search_.contenders[i]);
    for (const Cause& twin : Twins(plant_, found.cause)) {
      found.alternatives.insert(found.alternatives.begin(),
                                {twin, found.probability, true});
    }
    discovery_.causes.push_back(std::move(found));
  }
}

// White noise beyond what the setup says of a sensor. Sensors of which it says nothing
// cannot be judged.
void Discoverer::AddNoiseCauses(const MatrixXd& innovations) {
  for (const RaisedNoise& raised :
       FindRaisedNoise(setup_, problem_.observer, innovations, options_.train_share)) {
    FoundCause found;
    found.cause.spec = {"encoder_noise", raised.element, {{"sd", raised.sd}}};
    found.parameters = {{"sd", raised.unit, raised.sd, raised.sd_error,
                         raised.sd - kNormal95 * raised.sd_error,
                         raised.sd + kNormal95 * raised.sd_error}};
    found.probability = 1.0;
    discovery_.causes.push_back(std::move(found));
  }
}

void Discoverer::Judge() {
  const bool something = !search_.ladder.empty() || search_.significant_rest;
  const bool found = !discovery_.causes.empty();
  const Index channels = problem_.run.outputs.rows();
  const double nominal =
      MeanSquare(problem_.Residual({}), channels, problem_.skip, problem_.train) - 1.0;
  const double rest = std::max(search_.fit.train - 1.0, 0.0);
  const double share = nominal > 0.0 ? 1.0 - rest / nominal : 0.0;
  if (!found) {
    discovery_.verdict =
        something ? DiscoveryVerdict::kUnexplained : DiscoveryVerdict::kNoDiscrepancy;
  } else if (!search_.significant_rest) {
    discovery_.verdict = DiscoveryVerdict::kExplained;
  } else if (share >= kNamedShare) {
    discovery_.verdict = DiscoveryVerdict::kPartlyExplained;
  } else {
    discovery_.verdict = DiscoveryVerdict::kUnexplained;
    std::string tried;
    for (const FoundCause& cause : discovery_.causes) {
      tried += (tried.empty() ? "" : ", ") + Describe(cause.cause);
    }
    discovery_.notes.push_back("not named, for too much is left beside it: " + tried);
    discovery_.causes.clear();
  }
  std::vector<Cause> causes;
  for (const FoundCause& found_cause : discovery_.causes) {
    causes.push_back(found_cause.cause);
  }
  changes_ = ChangesOf(causes);
}

void Discoverer::NoteQuietAxes(const ObservedMotion& motion) {
  const std::vector<Index> seen = SeenJoints(problem_.model);
  for (std::size_t y = 0; y < seen.size(); ++y) {
    constexpr double kMoves = 50.0;  // times the sensor noise
    const VectorXd q = motion.outputs.row(static_cast<Index>(y));
    const double range = q.maxCoeff() - q.minCoeff();
    const std::string& joint =
        problem_.model.coordinates[static_cast<std::size_t>(seen[y])];
    if (range < kMoves * problem_.observer.noise_sd[static_cast<Index>(y)]) {
      discovery_.notes.push_back(
          "'" + setup_.sensors[y].channel +
          "' does not move: friction, springs, ripple, mass and motor of joint '" +
          joint + "' cannot be judged; record a motion of it");
    }
  }
}

void Discoverer::NoteTwins(std::size_t cause,
                           const std::vector<Contender>& contenders) {
  const FoundCause& found = discovery_.causes[cause];
  for (const Alternative& other : found.alternatives) {
    if (other.indistinguishable) {
      discovery_.notes.push_back(Describe(found.cause) + " and " +
                                 Describe(other.cause) +
                                 " are the same change of the model: no measurement "
                                 "tells them apart");
    }
  }
  constexpr double kCompetes = 0.05;
  const FittedCause& fitted = search_.fit.causes[cause];
  for (const Contender& other : contenders) {
    if (other.cause.candidate == fitted.candidate || other.probability < kCompetes) {
      continue;
    }
    std::string note = "the record does not tell " + Describe(found.cause) + " from " +
                       Describe(CauseOf(other.cause));
    Setup noisy = setup_;
    for (std::size_t y = 0; y < noisy.sensors.size(); ++y) {
      noisy.sensors[y].noise_sd = problem_.observer.noise_sd[static_cast<Index>(y)];
    }
    const auto motion = FindTellingMotion(noisy, plant_, ChangesOf({found.cause}),
                                          ChangesOf({CauseOf(other.cause)}));
    constexpr double kTells = 4.0;
    if (!motion || motion->separation < kTells) {
      note += "; no trajectory of the setup would, a larger or faster motion may";
    } else {
      note += "; trajectory '" + motion->trajectory + "'";
      if (motion->slower > 1.0) {
        note +=
            ", " + std::to_string(static_cast<int>(motion->slower)) + " times slower,";
      }
      note += " would, by " + std::to_string(static_cast<int>(motion->separation)) +
              " standard deviations";
    }
    discovery_.notes.push_back(note);
  }
}

std::vector<std::string> DrivenNames(const MechanicalModel& model) {
  std::vector<std::string> names;
  std::set<Index> seen;
  for (const Index joint : DrivenJoints(model)) {
    if (!seen.insert(joint).second) continue;
    names.push_back(model.coordinates[static_cast<std::size_t>(joint)]);
  }
  return names;
}

void Discoverer::FindWhere(const Track& nominal, const Track& final) {
  std::vector<std::string> joints = DrivenNames(problem_.model);
  joints.resize(std::min<std::size_t>(
      joints.size(), static_cast<std::size_t>(problem_.run.outputs.rows())));
  std::vector<std::string> units;
  for (const std::string& joint : joints) {
    const int id = FindElement(plant_, mjOBJ_JOINT, joint);
    units.push_back(plant_.jnt_type[id] == mjJNT_HINGE ? "N m" : "N");
  }
  const auto estimate = [&](const Track& track) {
    return UnexplainedForces(problem_.model, problem_.observer, problem_.step(),
                             setup_.substeps, track.innovations, joints, units);
  };
  discovery_.forces_before = estimate(nominal);
  discovery_.forces_after =
      discovery_.causes.empty() ? discovery_.forces_before : estimate(final);
}

void Discoverer::SignRest(const ObservedMotion& motion) {
  if (discovery_.verdict != DiscoveryVerdict::kUnexplained &&
      discovery_.verdict != DiscoveryVerdict::kPartlyExplained) {
    return;
  }
  const auto strength = [](const UnknownSignal& s) {
    return s.value.norm() / std::max(s.sd, 1e-300);
  };
  const auto worst =
      std::ranges::max_element(discovery_.forces_after, std::less<>(),
                               [&](const UnknownSignal& s) { return strength(s); });
  const auto joint = std::ranges::find(problem_.model.coordinates, worst->site) -
                     problem_.model.coordinates.begin();
  std::vector<Variable> variables;
  const VectorXd own = motion.velocity.row(joint);
  for (const std::string& name : DrivenNames(problem_.model)) {
    const auto j = std::ranges::find(problem_.model.coordinates, name) -
                   problem_.model.coordinates.begin();
    const bool hinge = plant_.jnt_type[plant_.dof_jntid[j]] == mjJNT_HINGE;
    const std::string unit = hinge ? "rad" : "m";
    variables.push_back({name + " position", unit, motion.position.row(j), false});
    variables.push_back(
        {name + " velocity", unit + "/s", motion.velocity.row(j), j == joint});
    variables.push_back(
        {name + " acceleration", unit + "/s^2", motion.acceleration.row(j), false});
  }
  VectorXd direction = own;
  const double still = problem_.StillSpeed()[joint];
  direction = own.unaryExpr([still](double v) {
    return std::abs(v) < still ? 0.0 : v > 0.0 ? 1.0 : -1.0;
  });
  variables.push_back({"direction", "1", direction, true});
  for (std::size_t u = 0; u < setup_.actuators.size(); ++u) {
    variables.push_back({setup_.actuators[u].channel, setup_.actuators[u].unit,
                         motion.inputs.row(static_cast<Index>(u)), false});
  }
  const Index n = motion.samples();
  variables.push_back(
      {"time", "s",
       VectorXd::LinSpaced(n, 0.0, static_cast<double>(n - 1) * motion.sample_time),
       false});
  discovery_.unexplained = FindSignature(worst->site, worst->value, worst->unit,
                                         std::max(worst->sd, 1e-300), variables);
  discovery_.unexplained_site = worst->site;
}

void Discoverer::AddLaws(const ObservedMotion& motion) {
  for (std::size_t i = 0; i < search_.fit.causes.size() && i < discovery_.causes.size();
       ++i) {
    const Candidate& candidate = candidates_[search_.fit.causes[i].candidate];
    const std::string& joint =
        problem_.model.coordinates[static_cast<std::size_t>(candidate.joint)];
    const auto before =
        std::ranges::find(discovery_.forces_before, joint, &UnknownSignal::site);
    const auto after =
        std::ranges::find(discovery_.forces_after, joint, &UnknownSignal::site);
    if (before == discovery_.forces_before.end()) continue;
    const bool hinge =
        plant_.jnt_type[plant_.dof_jntid[candidate.joint]] == mjJNT_HINGE;
    const std::string input_unit =
        setup_
            .actuators[static_cast<std::size_t>(std::clamp<Index>(
                candidate.channel, 0, problem_.run.inputs.rows() - 1))]
            .unit;
    const LawAxis axis = AxisOf(VariableOf(discovery_.causes[i].cause), candidate,
                                motion, hinge, input_unit);
    LawPlot plot;
    plot.cause = Describe(candidate);
    plot.site = joint;
    plot.x_name = axis.name;
    plot.x_unit = axis.unit;
    plot.y_unit = before->unit;
    const Index stride = std::max<Index>(1, axis.x.size() / kLawPoints);
    const Index count = axis.x.size() / stride;
    plot.x.resize(count);
    plot.y.resize(count);
    for (Index k = 0; k < count; ++k) {
      plot.x[k] = axis.x[k * stride];
      plot.y[k] = before->value[k * stride];
    }
    const Eigen::MatrixX2d curve =
        LawCurve(discovery_.causes[i].cause, axis.x, before->value - after->value);
    plot.law_x = curve.col(0);
    plot.law_y = curve.col(1);
    discovery_.laws.push_back(std::move(plot));
  }
}

void Discoverer::AddLadder() {
  const Index channels = problem_.run.outputs.rows();
  const auto step = [&](const std::string& added, const CauseFit& fit) {
    LadderStep entry;
    entry.added = added;
    entry.train = std::sqrt(fit.train);
    entry.held_out = std::sqrt(fit.held_out);
    if (options_.figures) {
      const Changes changes = ChangesOf(candidates_, fit.causes);
      entry.error_percent = ReplayErrors(setup_, plant_, changes, measured_);
      if (validation_ != nullptr) {
        entry.validation_percent = ReplayErrors(setup_, plant_, changes, *validation_);
      }
    }
    discovery_.ladder.push_back(std::move(entry));
  };
  CauseFit nominal;
  nominal.residual = problem_.Residual({});
  nominal.train = MeanSquare(nominal.residual, channels, problem_.skip, problem_.train);
  nominal.held_out =
      MeanSquare(nominal.residual, channels, problem_.train, problem_.run.samples());
  step("nothing", nominal);
  for (const Rung& rung : search_.ladder) {
    if (!rung.kept) continue;
    step(Describe(candidates_[rung.fit.causes.back().candidate]), rung.fit);
  }
}

/// rms of measured minus simulated, samples first .. last - 1.
std::map<std::string, double> MismatchRms(const Comparison& comparison, Index first,
                                          Index last) {
  std::map<std::string, double> rms;
  for (const ChannelMismatch& channel : comparison.channels) {
    const VectorXd difference = comparison.measured.At(channel.name).samples -
                                comparison.simulated.At(channel.name).samples;
    rms[channel.name] = Rms(difference.segment(first, last - first));
  }
  return rms;
}

double Gain(const std::map<std::string, double>& before,
            const std::map<std::string, double>& after,
            const std::map<std::string, double>& floor) {
  double was = 0.0;
  double is = 0.0;
  for (const auto& [channel, rms] : before) {
    const double scale = std::max(floor.at(channel), 1e-300);
    was += std::pow(rms / scale, 2);
    is += std::pow(after.at(channel) / scale, 2);
  }
  return was > 0.0 ? 1.0 - std::sqrt(is / was) : 0.0;
}

void Discoverer::AddComparisons() {
  RunOptions nominal;
  nominal.seed = options_.seed;
  RunOptions extended = nominal;
  extended.faults = changes_.faults;
  extended.effects = changes_.effects;
  discovery_.before = Compare(setup_, plant_, measured_, nominal);
  discovery_.after = Compare(setup_, plant_, measured_, extended);
  const Index skip = problem_.skip;
  discovery_.mismatch_before.train =
      MismatchRms(discovery_.before, skip, problem_.train);
  discovery_.mismatch_after.train = MismatchRms(discovery_.after, skip, problem_.train);
  if (validation_ != nullptr) {
    discovery_.validation_before = Compare(setup_, plant_, *validation_, nominal);
    discovery_.validation_after = Compare(setup_, plant_, *validation_, extended);
    const Index n = validation_->samples();
    discovery_.mismatch_before.validation =
        MismatchRms(*discovery_.validation_before, skip, n);
    discovery_.mismatch_after.validation =
        MismatchRms(*discovery_.validation_after, skip, n);
  } else {
    const Index n = measured_.samples();
    discovery_.mismatch_before.validation =
        MismatchRms(discovery_.before, problem_.train, n);
    discovery_.mismatch_after.validation =
        MismatchRms(discovery_.after, problem_.train, n);
  }
  for (const ChannelMismatch& channel : discovery_.after.channels) {
    discovery_.noise_floor[channel.name] = channel.noise_floor.rms;
    discovery_.unit[channel.name] = channel.unit;
  }
  discovery_.gain_train = Gain(discovery_.mismatch_before.train,
                               discovery_.mismatch_after.train, discovery_.noise_floor);
  discovery_.gain_validation =
      Gain(discovery_.mismatch_before.validation, discovery_.mismatch_after.validation,
           discovery_.noise_floor);
}

void Discoverer::AddLimits(const Track& nominal, const Track& final) {
  const auto limits = [&](const Track& track) {
    return FaultLimits(problem_, candidates_, MotionOf(track), problem_.Scaled(track));
  };
  const auto before = limits(nominal);
  const auto after = limits(final);
  for (const auto& [fault, limit] : before) {
    const auto now = after.find(fault);
    if (now == after.end()) continue;
    discovery_.fault_limits.push_back({fault, limit, now->second});
  }
}

Discovery Discoverer::Run() {
  discovery_.setup = setup_.name;
  discovery_.train_share = options_.train_share;
  discovery_.sample_time = setup_.sample_time();
  SearchOptions search;
  search.most_causes = options_.most_causes;
  search.progress = options_.progress;
  search_ = SearchCauses(problem_, candidates_, search);
  if (options_.bandwidth == 0.0 && IsColoured()) {
    problem_ = PoseProblem(setup_, plant_, measured_, options_.train_share,
                           kFastShare * setup_.control_rate);
    search_ = SearchCauses(problem_, candidates_, search, &search_);
  }
  NameCauses();
  const Track found = FollowWith(ChangesOf(candidates_, search_.fit.causes));
  if (!search_.significant_rest) AddNoiseCauses(found.innovations);
  Judge();

  const Track nominal = FollowWith({});
  const Track final = discovery_.causes.empty() ? nominal : FollowWith(changes_);
  const ObservedMotion motion = MotionOf(final);
  NoteQuietAxes(motion);
  for (std::size_t i = 0; i < search_.contenders.size() && i < discovery_.causes.size();
       ++i) {
    NoteTwins(i, search_.contenders[i]);
  }
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
    AddLimits(nominal, final);
    discovery_.colour_before =
        1.0 - IndependentShare(problem_, problem_.Scaled(nominal)).mean();
    discovery_.colour_after =
        1.0 - IndependentShare(problem_, problem_.Scaled(final)).mean();
  }
  return std::move(discovery_);
}

}  // namespace

Discovery Discover(const Setup& setup, const mjModel& plant, const Record& measured,
                   const Record* validation, const DiscoverOptions& options) {
  std::vector<std::string> notes = CheckRecord(setup, plant, measured);
  if (validation != nullptr) {
    for (std::string& note : CheckRecord(setup, plant, *validation)) {
      notes.push_back("validation record: " + note);
    }
  }
  Discovery discovery = Discoverer(setup, plant, measured, validation, options).Run();
  discovery.notes.insert(discovery.notes.begin(), notes.begin(), notes.end());
  return discovery;
}

std::string VerdictName(DiscoveryVerdict verdict) {
  switch (verdict) {
    case DiscoveryVerdict::kNoDiscrepancy:
      return "no_discrepancy";
    case DiscoveryVerdict::kExplained:
      return "explained";
    case DiscoveryVerdict::kPartlyExplained:
      return "partly_explained";
    case DiscoveryVerdict::kUnexplained:
      return "unexplained";
  }
  return "";
}

Changes ChangesOf(const Discovery& discovery) {
  std::vector<Cause> causes;
  for (const FoundCause& found : discovery.causes) causes.push_back(found.cause);
  return ChangesOf(causes);
}

}  // namespace mjdiag
