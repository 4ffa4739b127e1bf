#include "mjdiag/watch/judge/tick_judge.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mjdiag/diagnosis/diagnosis_verdict.h"
#include "mjdiag/diagnosis/twin/twin_estimator.h"

namespace mjdiag {
namespace {

using Eigen::Index;

/// Of the filters of a stretch, and of a high-pass of 100 Hz ten times over [s].
constexpr double kFiltersSettle = 0.1;
/// An alarm of the residual counts for so long [s].
constexpr double kAlarmLasts = 1.0;
constexpr Index kSegments = 4;
/// A run that began in motion is fresh for so long [s].
constexpr double kFresh = 10.0;
/// A twin that has lost its machine (kLost) is given
/// twice the time whenever to begin anew was in vain, up to this [s].
constexpr double kLongestLost = 60.0;
/// Standard deviations within which a first reading is one at rest, as a monitor has it.
constexpr double kAtRest = 6.0;
/// Bins of a spectrum within which two tones are one.
constexpr double kSameTone = 2.0;

/// What both stretches show.
DisturbanceReport Confirmed(const DisturbanceReport& before, DisturbanceReport now) {
  const double near = kSameTone * now.spectrum.resolution();
  std::erase_if(now.tones, [&](const DisturbanceTone& tone) {
    return std::ranges::none_of(before.tones, [&](const DisturbanceTone& other) {
      return std::abs(other.frequency - tone.frequency) <= near;
    });
  });
  const auto too_much = [](const DisturbanceReport& report) {
    return report.total > report.total_threshold;
  };
  now.noise_raised = now.noise_raised && before.noise_raised;
  now.disturbed =
      !now.tones.empty() || now.noise_raised || (too_much(now) && too_much(before));
  return now;
}

}  // namespace

TickJudge::TickJudge(const Machine& machine, const PreparedDiagnosis& prepared,
                     const JudgeOptions& options,
                     std::function<void(const Finding&)> on_look)
    : machine_(machine),
      prepared_(prepared),
      options_(options),
      on_look_(std::move(on_look)) {
  const auto ticks = [&](double time) {
    return std::max<Index>(1, std::llround(time / design().sample_time()));
  };
  look_ticks_ = ticks(options.look);
  skipped_ticks_ = ticks(kFiltersSettle);
  stretch_ticks_ =
      skipped_ticks_ +
      std::max(ticks(options.stretch), kSegments * design().limits.disturbance.segment);
  const std::size_t outputs = design().outputs.size();
  measured_ = std::make_unique<bool[]>(outputs);
  last_.resize(outputs + design().inputs.size());
}

void TickJudge::OnNewRun() { recording_.reset(); }

void TickJudge::OnMissing(std::int64_t ticks) {
  recording_.reset();
  missing_ += ticks;
}

void TickJudge::Begin(std::span<const double> values) {
  recording_ = std::make_unique<DiagnosisRecording>(
      BeginDiagnosis(machine_, prepared_, stretch_ticks_));
  ++runs_;
  confirmed_ = in_motion_ = false;
  known_ = 0.0;
  for (std::size_t i = 0; i < design().outputs.size(); ++i) {
    const auto at = static_cast<Index>(i);
    in_motion_ = in_motion_ || std::abs(values[i] - design().offset[at]) >
                                   kAtRest * design().sensor_noise[at];
  }
  since_look_ = 0;
  residual_ = {};
  alarm_ = any_alarm_ = false;
  stretch_before_.reset();
  disturbance_ = {};
  analysed_ = false;
}

void TickJudge::OnTick(const TickHead& head, std::span<const double> values) {
  const std::size_t outputs = design().outputs.size();
  const auto is_finite = [](double value) { return std::isfinite(value); };
  const bool begun = recording_ != nullptr;
  // Without its command a tick is as good as not there; and a run begins with all readings.
  if (!std::ranges::all_of(values.subspan(outputs), is_finite)) return OnMissing(1);
  if (!begun && !std::ranges::all_of(values, is_finite)) return OnMissing(1);
  if (!begun) Begin(values);
  Feed(values);
  AfterTick(head.arrived);
}

void TickJudge::BeginStretch() {
  recording_->recorder = MonitorRecorder(design(), stretch_ticks_);
}

void TickJudge::Feed(std::span<const double> values) {
  const std::size_t outputs = design().outputs.size();
  bool all = true;
  for (std::size_t i = 0; i < outputs; ++i) {
    measured_[i] = std::isfinite(values[i]);
    all = all && measured_[i];
    if (measured_[i]) last_[i] = values[i];
  }
  std::ranges::copy(values.subspan(outputs), last_.begin() + outputs);
  const std::span<const double> readings = std::span(last_).first(outputs);
  const std::span<const double> commands = std::span(last_).subspan(outputs);
  if (all) {
    recording_->Add(readings, commands);
  } else {
    recording_->Add(readings, commands, std::span<const bool>(measured_.get(), outputs),
                    true);
    BeginStretch();
  }
}

void TickJudge::AfterTick(double arrived) {
  const DiagnosisMonitor& monitor = recording_->monitor;
  residual_.Add(monitor.residuals()[0]);
  alarm_ = alarm_ || monitor.residual_alarm();
  if (++since_look_ >= look_ticks_) LookAt(arrived);
  if (recording_ == nullptr) return;  // another opinion is wanted
  if (recording_->recorder.samples() >= stretch_ticks_) AnalyseStretchOfRun();
}

void TickJudge::AnalyseStretchOfRun() {
  const MonitorLog log = recording_->recorder.Log();
  BeginStretch();
  DisturbanceReport report =
      AnalyseStretch(design(), log, JudgeFaults(recording_->monitor), skipped_ticks_);
  if (stretch_before_) {
    disturbance_ = Confirmed(*stretch_before_, report);
    analysed_ = true;
  }
  stretch_before_ = std::move(report);
}

void TickJudge::LookAt(double time) {
  const DiagnosisMonitor& monitor = recording_->monitor;
  Finding look;
  look.time = time;
  look.run_time =
      static_cast<double>(monitor.samples()) * monitor.design().sample_time();
  look.missing = std::exchange(missing_, 0);
  look.residual = std::exchange(residual_, {});
  look.integral = monitor.integral();
  look.residual_alarm = std::exchange(alarm_, false);
  look.lasting_alarm = monitor.lasting_alarm();
  since_look_ = 0;
  if (look.residual_alarm) last_alarm_ = look.run_time;
  any_alarm_ = any_alarm_ || look.residual_alarm;

  DiagnosisResult& result = look.result;
  result.setup = design().setup;
  result.samples = monitor.samples();
  result.sample_time = design().sample_time();
  result.residual = {look.residual.least, look.residual.most};
  result.limits = design().limits.residual.limits;
  result.faults = JudgeFaults(monitor);
  if (const TwinEstimator* twin = monitor.twin(); twin != nullptr) {
    result.by_twin = true;
    if (twin->estimator().began()) result.nis = twin->estimator().recent_nis();
  }
  result.disturbance = disturbance_;
  const bool alarm = any_alarm_ && look.run_time - last_alarm_ < kAlarmLasts;
  result.detected = alarm || look.lasting_alarm || disturbance_.disturbed ||
                    std::ranges::any_of(result.faults, &FaultVerdict::detected);
  look.analysed = analysed_;
  look.kind = KindOf(result);
  look.words = DiagnosisVerdict(result);
  if (look.run_time < options_.settle) {
    look.kind = VerdictKind::kSettling;
    look.words = "The diagnosis of this run has just begun.";
  } else if (WantsAnotherOpinion(look)) {
    look.kind = VerdictKind::kSettling;
    look.words = "What the diagnosis of this run says is being looked at again.";
    recording_.reset();
  } else if (HasLostTheMachine(look.run_time)) {
    recording_.reset();
  }
  on_look_(look);
}

bool TickJudge::HasLostTheMachine(double run_time) {
  const TwinEstimator* twin = recording_->monitor.twin();
  if (twin == nullptr || !twin->estimator().began() || twin->estimator().current()) {
    if (run_time > options_.settle + kFresh) lost_patience_ = kLost;
    known_ = run_time;
    return false;
  }
  if (run_time - known_ < lost_patience_) return false;
  lost_patience_ = std::min(2.0 * lost_patience_, kLongestLost);
  return true;
}

bool TickJudge::WantsAnotherOpinion(const Finding& look) {
  if (look.kind != VerdictKind::kFault) {
    suspects_.clear();
    return false;
  }
  if (!in_motion_ || confirmed_ || any_alarm_ || look.run_time > kFresh) return false;
  std::vector<std::string> names;
  for (const FaultVerdict& fault : look.result.faults) {
    if (fault.detected) names.push_back(fault.name);
  }
  confirmed_ = names == suspects_;
  suspects_ = std::move(names);
  return !confirmed_;
}

}  // namespace mjdiag
