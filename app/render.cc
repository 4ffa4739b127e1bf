// mjdiag render: a clip of the machine, the healthy one beside the faulty one.

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "app/command.h"
#include "app/format.h"
#include "app/machine.h"
#include "app/output.h"
#include "app/progress.h"
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
std::vector<TitledRecord> SimulateRuns(const Machine& machine,
                                       const MotionOptions& motion) {
  const Excitation excitation = MakeExcitation(machine.setup, motion);
  RunOptions faulty = machine.options;
  SetMotion(motion, faulty);
  faulty.log_joints = true;
  RunOptions healthy = faulty;
  healthy.faults.clear();
  healthy.effects.clear();
  healthy.disturbances.clear();
  std::vector<TitledRecord> runs;
  runs.push_back(
      {"healthy", Run(machine, motion, excitation, healthy, "simulating the healthy")});
  if (Describe(faulty) != Describe(healthy)) {
    runs.push_back({Describe(faulty),
                    Run(machine, motion, excitation, faulty, "simulating the faulty")});
  }
  return runs;
}

std::vector<TitledRecord> ReadRuns(const std::vector<std::string>& files) {
  std::vector<TitledRecord> runs;
  for (const std::string& file : files) {
    runs.push_back({std::filesystem::path(file).stem().string(), ReadRecord(file)});
  }
  return runs;
}

void Render(RenderOptions options) {
  const Machine machine = LoadMachine(options.machine);
  for (const std::string& text : options.amplify) {
    ParseAmplification(text, options.clip.picture);
  }
  const std::vector<TitledRecord> titled =
      options.records.empty() ? std::vector<TitledRecord>() : ReadRuns(options.records);
  PrepareOutput(options.output);
  const std::vector<TitledRecord> records =
      titled.empty() ? SimulateRuns(machine, options.motion) : titled;
  std::vector<ClipRun> runs;
  for (const TitledRecord& run : records) runs.push_back({run.title, &run.record});

  const std::filesystem::path folder = options.output.folder;
  nlohmann::json document = ToJson(machine.options);
  document["schema"] = "mjdiag.render/1";
  document["setup"] = machine.setup.name;
  document["command"] = CommandLine();
  document["width"] = options.clip.picture.width;
  document["height"] = options.clip.picture.height;
  std::string text;
  if (options.still) {
    RenderStill(*machine.plant, runs, options.clip.picture, *options.still,
                folder / "still.png");
    document["still"] = "still.png";
    text = "picture: " + (folder / "still.png").string() + "\n";
  } else {
    if (options.frames) options.clip.frames = folder / "frames";
    ClipSummary summary;
    {
      ProgressBar bar("rendering");
      options.clip.progress = [&bar](double fraction) { bar.Show(fraction); };
      summary = RenderClip(*machine.plant, runs, options.clip, folder / "clip.mp4");
    }
    document["clip"] = "clip.mp4";
    document["frames"] = summary.frames;
    document["codec"] = summary.codec;
    text = "clip: " + (folder / "clip.mp4").string() + " (" +
           std::to_string(summary.frames) + " frames, " + summary.codec + ")\n";
  }
  Publish(options.output, "render", document, text);
}

}  // namespace

void AddRender(CLI::App& app) {
  auto options = std::make_shared<RenderOptions>();
  PictureOptions& picture = options->clip.picture;
  CLI::App* command = app.add_subcommand(
      "render", "A clip of the machine: healthy and faulty side by side");
  AddMachineOptions(*command, options->machine);
  AddMotionOptions(*command, options->motion);
  AddOutputOptions(*command, options->output, true);
  CLI::Option* records = command->add_option(
      "--record", options->records,
      "Show these records (with joints logged) instead of simulating");
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
  command->callback([options] { Render(*options); });
}

}  // namespace mjdiag::app
