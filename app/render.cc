// mjdiag render: a clip of the machine, the healthy one beside the faulty one.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "app/command.h"
#include "app/diagnosis_output.h"
#include "app/format.h"
#include "app/interrupt.h"
#include "app/output.h"
#include "app/progress.h"
#include "app/subject.h"
#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/discovery/comparison/observed_joints.h"
#include "mjdiag/plugin/design/diagnosis.h"
#include "mjdiag/render/clip.h"
#include "mjdiag/signals/error.h"

namespace mjdiag::app {
namespace {

constexpr double kLatest = 1e9;  // s

struct RenderOptions {
  MachineOptions machine;
  MotionOptions motion;
  OutputOptions output;
  ClipOptions clip;
  std::vector<std::string> records;
  std::vector<std::string> amplify;
  std::optional<double> still;
  bool frames = false;
  bool diagnose = false;
  DiagnosisSource source;
};

/// "5000" for all joints, "u3=2000" for one.
void ParseAmplification(const std::string& text, PictureOptions& picture) {
  const std::size_t equals = text.find('=');
  const std::string number = equals == text.npos ? text : text.substr(equals + 1);
  std::size_t used = 0;
  double factor = 0.0;
  try {
    factor = std::stod(number, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used == 0 || used != number.size() || !(factor > 0.0)) {
    throw InputError("--amplify '" + text + "'", "no positive factor",
                     "<factor> or <joint>=<factor>");
  }
  if (equals == text.npos) {
    picture.amplify_all = factor;
  } else {
    picture.amplify[text.substr(0, equals)] = factor;
  }
}

struct TitledRecord {
  std::string title;
  Record record;
};

/// The healthy machine, and beside it the one with the faults and effects asked for.
std::vector<TitledRecord> SimulateRuns(const Subject& subject,
                                       const MotionOptions& motion,
                                       std::vector<std::string>& notes) {
  const Excitation excitation = MakeExcitation(subject.setup(), motion, notes);
  RunOptions faulty = subject.options;
  SetMotion(motion, faulty);
  faulty.log_joints = true;
  RunOptions healthy = faulty;
  healthy.disturbances.clear();
  healthy.late_faults.clear();
  std::vector<TitledRecord> runs;
  runs.push_back({"healthy", Run(subject.nominal, motion, excitation, healthy,
                                 "simulating the healthy")});
  if (!subject.healthy()) {
    runs.push_back({SubjectText(subject), Run(subject.machine, motion, excitation,
                                              faulty, "simulating the faulty")});
  }
  return runs;
}

/// Of a measurement, which has encoders but no joints, the joints are estimated.
std::vector<TitledRecord> ReadRuns(const Machine& machine,
                                   const std::vector<std::string>& files,
                                   std::vector<std::string>& notes) {
  std::vector<TitledRecord> runs;
  for (const std::string& file : files) {
    Record record = ReadMeasured(machine.setup(), file, notes);
    const bool logged = std::ranges::any_of(
        record.channels(),
        [](const Channel& channel) { return channel.name.starts_with("joint."); });
    if (!logged) record = WithObservedJoints(machine, record);
    runs.push_back({std::filesystem::path(file).stem().string(), std::move(record)});
  }
  return runs;
}

/// The estimate as the diagnosis would judge it now: about the middle of what healthy
/// runs gave, and no surer than they agree on. NaN while the motion so far does not
/// determine the faults.
void NoteEstimate(const DiagnosisMonitor& monitor, Eigen::Index column,
                  std::vector<EstimateHistory>& histories) {
  if (monitor.twin() != nullptr) {
    for (std::size_t i = 0; i < histories.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      histories[i].value[column] = histories[i].healthy + monitor.estimate()[at];
      histories[i].half_width[column] =
          TwoSidedNormalQuantile(0.05) * monitor.estimate_sd()[at];
    }
    return;
  }
  std::optional<FaultEstimate> estimate;
  if (monitor.estimator().samples() > 0 && monitor.estimator().Inseparable().empty()) {
    estimate = monitor.estimator().Estimate();
  }
  for (std::size_t i = 0; i < histories.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    EstimateHistory& history = histories[i];
    history.value[column] = std::numeric_limits<double>::quiet_NaN();
    history.half_width[column] = std::numeric_limits<double>::quiet_NaN();
    if (!estimate) continue;
    const CalibratedEstimate calibrated =
        Calibrate(monitor.design(), at, estimate->value[at],
                  std::sqrt(estimate->covariance(at, at)));
    history.value[column] = history.healthy + calibrated.deviation;
    history.half_width[column] = TwoSidedNormalQuantile(0.05) * calibrated.sd;
  }
}

/// The monitor of `simulate --diagnose` over a run, sample by sample, with what it knew
/// at every estimate.
DiagnosisOverlay OverlayOf(const Machine& machine, const PreparedDiagnosis& prepared,
                           const Record& record, std::size_t run) {
  const DiagnosisDesign& design = prepared.design;
  // A clip shows some hundred moments.
  constexpr Eigen::Index kMostEstimates = 2000;
  const Eigen::Index every =
      design.decimation *
      std::max<Eigen::Index>(1,
                             record.samples() / (design.decimation * kMostEstimates));
  const Eigen::Index count = (record.samples() + every - 1) / every;
  DiagnosisOverlay overlay;
  overlay.run = run;
  overlay.limit_low = design.limits.residual.limits.min;
  overlay.limit_high = design.limits.residual.limits.max;
  overlay.estimate_time.resize(count);
  const std::vector<std::string> names = design.FaultNames();
  for (std::size_t i = 0; i < names.size(); ++i) {
    overlay.estimates.push_back({names[i], design.Healthy(static_cast<Eigen::Index>(i)),
                                 Eigen::VectorXd(count), Eigen::VectorXd(count)});
  }
  DiagnosisRecording recording = BeginDiagnosis(machine, prepared, record.samples());
  const DiagnosisMonitor& monitor = recording.monitor;
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index first = k * every;
    const Eigen::Index samples = std::min(every, record.samples() - first);
    RunPart(recording, record.Slice(first, samples));
    if (k + 1 == count) recording.Finish();
    overlay.estimate_time[k] =
        record.start_time() +
        static_cast<double>(first + samples - 1) * record.sample_time();
    NoteEstimate(monitor, k, overlay.estimates);
  }
  if (const auto sample = monitor.first_detection()) {
    overlay.detection =
        record.start_time() + static_cast<double>(*sample) * record.sample_time();
  }
  overlay.residual = Record(record.sample_time(), record.start_time());
  overlay.residual.Add({"residual", "1", recording.recorder.Log().residual});
  return overlay;
}

/// The diagnosis of the last run: the faulty one, or the record given last.
DiagnosisOverlay DiagnosisOf(const RenderOptions& options, const Machine& machine,
                             const std::vector<TitledRecord>& runs) {
  const Record& record = runs.back().record;
  DiagnosisSource source = options.source;
  source.nominal.linear = options.motion.linear;
  Excitation motion;
  if (NeedsMotion(source)) {
    std::vector<std::string> known;
    motion = options.records.empty()
                 ? MakeExcitation(machine.setup(), options.motion, known)
                 : Replay(machine.setup(), record);
  }
  return OverlayOf(machine, Prepare(machine, source, motion), record, runs.size() - 1);
}

/// Of records, as of a simulation: as long as that from where the clip begins.
void LimitDuration(const std::vector<TitledRecord>& runs, double duration,
                   PictureOptions& picture) {
  if (runs.empty() || !(duration > 0.0)) return;
  double begin = runs.front().record.start_time();
  for (const TitledRecord& run : runs) begin = std::max(begin, run.record.start_time());
  const Record& first = runs.front().record;
  const double end = picture.begin.value_or(begin) + duration;
  if (end < first.start_time() + first.duration()) {
    picture.end = std::min(end, picture.end.value_or(end));
  }
}

void Render(RenderOptions options) {
  const Interrupt interrupt;  // what is half written is taken away again
  const Subject subject = LoadSubject(options.machine);
  const Machine& machine = subject.nominal;
  for (const std::string& text : options.amplify) {
    ParseAmplification(text, options.clip.picture);
  }
  std::vector<std::string> notes;
  const std::vector<TitledRecord> titled =
      options.records.empty() ? std::vector<TitledRecord>()
                              : ReadRuns(machine, options.records, notes);
  LimitDuration(titled, options.motion.duration, options.clip.picture);
  PrepareOutput(options.output);
  CheckPicture(machine.plant(), options.clip.picture);
  const std::vector<TitledRecord> records =
      titled.empty() ? SimulateRuns(subject, options.motion, notes) : titled;
  std::vector<ClipRun> runs;
  runs.reserve(records.size());
  for (const TitledRecord& run : records) runs.push_back({run.title, &run.record});
  Interrupt::ThrowIfWished();
  if (options.diagnose) {
    options.clip.picture.diagnosis = DiagnosisOf(options, machine, records);
  }

  const std::filesystem::path folder = options.output.folder;
  nlohmann::json document = ToJson(subject);
  document["schema"] = "mjdiag.render/1";
  document["setup"] = machine.setup().name;
  document["command"] = CommandLine();
  document["width"] = options.clip.picture.width;
  document["height"] = options.clip.picture.height;
  if (options.diagnose) {
    const std::optional<double> detection = options.clip.picture.diagnosis->detection;
    document["first_detection"] = detection ? nlohmann::json(*detection) : nullptr;
  }
  std::string text;
  // Frames come into their folder by themselves.
  if (!options.frames) HoldFiles();
  if (options.still) {
    document["amplification"] = RenderStill(machine.plant(), runs, options.clip.picture,
                                            *options.still, folder / "still.png");
    document["still"] = "still.png";
    text = "picture: " + (folder / "still.png").string() + "\n";
  } else {
    if (options.frames) options.clip.frames = folder / "frames";
    ClipSummary summary;
    {
      ProgressBar bar("rendering");
      options.clip.progress = [&bar](double fraction) {
        Interrupt::ThrowIfWished();
        bar.Show(fraction);
      };
      summary = RenderClip(machine.plant(), runs, options.clip, folder / "clip.mp4");
    }
    document["clip"] = "clip.mp4";
    document["speed"] = options.clip.speed;
    document["frames"] = summary.frames;
    document["codec"] = summary.codec;
    document["amplification"] = summary.amplification;
    text = "clip: " + (folder / "clip.mp4").string() + " (" +
           std::to_string(summary.frames) + " frames, " + summary.codec + ")\n";
  }
  AddNotes(notes, document, text);
  Publish(options.output, "render", document, text);
}

}  // namespace

void AddRender(CLI::App& app) {
  auto options = std::make_shared<RenderOptions>();
  PictureOptions& picture = options->clip.picture;
  CLI::App* command = app.add_subcommand(
      "render",
      "A clip of the machine: healthy and faulty side by side or one in the other");
  AddMachineOptions(*command, options->machine);
  AddMotionOptions(*command, options->motion);
  AddOutputOptions(*command, options->output, true);
  CLI::Option* records = command->add_option(
      "--record", options->records,
      "Show these records, simulated or measured, instead of simulating");
  for (const char* name : {"--fault", "--effect", "--trajectory", "--replay"}) {
    records->excludes(name);
  }
  command->add_option("--camera", picture.camera, "Camera of the plant");
  command->add_option("--width", picture.width, "Pixels, even");
  command->add_option("--height", picture.height, "Pixels, even");
  command->add_option("--fps", options->clip.fps, "Frames a second of clip")
      ->check(Within(1.0, 240.0));
  command
      ->add_option("--speed", options->clip.speed,
                   "Seconds of the machine a second of clip")
      ->check(Within(1e-6, 1e3));
  command->add_option("--from", picture.begin, "First moment shown [s]")
      ->check(Within(-kLatest, kLatest));
  command->add_option("--to", picture.end, "Last moment shown [s]")
      ->check(Within(-kLatest, kLatest));
  command->add_option("--amplify", options->amplify,
                      "Factor on the small motion: 5000, or u3=2000 for one joint "
                      "(default: chosen from the data)");
  command
      ->add_option("--still", options->still,
                   "One picture of this moment [s] instead of a clip")
      ->check(Within(-kLatest, kLatest));
  command->add_flag("--frames", options->frames, "Also write every frame as PNG");
  command->add_flag("--ghost", picture.ghost,
                    "One view: the faulty machine, the healthy one translucent in it");
  command->add_option("--path", picture.path_site,
                      "Site whose path is drawn, or none (default: the tool's)");
  command->add_flag("--diagnose", options->diagnose,
                    "Show what the diagnosis of the last run says in step with it");
  AddDiagnosisOptions(*command, options->source);
  command->callback([options] { Render(*options); });
}

}  // namespace mjdiag::app
