// mjdiag watch: the diagnosis beside a running machine, with a live page.

#ifdef MJDIAG_HAS_WATCH

#include <cstdio>
#include <memory>
#include <mutex>

#include "app/broker.h"
#include "app/command.h"
#include "app/diagnosis_output.h"
#include "app/format.h"
#include "app/interrupt.h"
#include "app/subject.h"
#include "mjdiag/plugin/plant/fault.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/render/marked_machine.h"
#include "mjdiag/report/page/page_assets.h"
#include "mjdiag/report/page/plot_library.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/watch/live_watch.h"

namespace mjdiag::app {
namespace {

constexpr int kPort = 9871;
constexpr double kLongestTime = 1e6;  // s
/// Of its picture [px].
constexpr int kPictureWidth = 720;
constexpr int kPictureHeight = 480;

struct LiveOptions {
  std::string setup;
  std::vector<std::string> overrides;
  DiagnosisSource diagnosis;
  std::string source;
  std::string publish;
  std::string listen = "127.0.0.1:" + std::to_string(kPort);
  std::string camera;
  bool no_picture = false;
  WatchOptions watch;
};

std::string WordsOf(ModelParameterKind kind) {
  return std::string(MeaningOf(kind)) + " of ";
}

/// "damping of X", "force of x_motor", "sines of 100 and 300 Hz".
std::vector<FaultMeaning> MeaningsOf(const Machine& machine,
                                     const DiagnosisDesign& design) {
  std::vector<FaultMeaning> meanings;
  const mjModel& plant = machine.plant();
  for (const std::string& name : design.FaultNames()) {
    meanings.push_back(
        {name, "", design.Healthy(static_cast<Eigen::Index>(meanings.size()))});
    std::string& words = meanings.back().meaning;
    for (const FaultParameter& fault : FaultParameters(plant)) {
      if (fault.name != name) continue;
      const mjtObj type = ElementOf(fault.kind);
      for (const int element : fault.elements) {
        words += (words.empty() ? WordsOf(fault.kind) : ", ") +
                 ElementName(plant, type, element);
      }
    }
    for (const MultisineSetup& source : machine.setup().disturbances) {
      if (source.name != name) continue;
      for (const double frequency : source.frequencies) {
        words += (words.empty() ? "sines of " : ", ") + Short(frequency);
      }
      words += " Hz";
    }
  }
  return meanings;
}

/// Draws what the fault parameters of these names act on.
std::string DrawFaults(const Machine& machine, const std::vector<std::string>& names,
                       const SceneOptions& scene) {
  std::vector<int> bodies;
  for (const FaultParameter& fault : FaultParameters(machine.plant())) {
    if (std::ranges::find(names, fault.name) == names.end()) continue;
    for (const int body : BodiesOf(machine.plant(), fault)) bodies.push_back(body);
  }
  return DrawMarked(machine.plant(), machine.rest(), bodies, scene);
}

void TakeAddresses(const LiveOptions& options, WatchOptions& watch) {
  watch.source = ParseStreamAddress(options.source, "--source");
  if (!options.publish.empty()) {
    watch.publish = ParseStreamAddress(options.publish, "--publish");
    if (watch.publish->kind != StreamAddress::Kind::kMqtt) {
      throw InputError("--publish", "'" + options.publish + "'",
                       "mqtt:HOST[:PORT]/TOPIC");
    }
  }
  const auto [host, port] = ParseHostPort(options.listen, kPort, "--listen");
  watch.server.host = host.empty() ? "127.0.0.1" : host;
  watch.server.port = port;
  TakePassword(watch.login);
}

void Watch(const LiveOptions& options) {
  WatchOptions watch = options.watch;
  TakeAddresses(options, watch);
  const Machine machine(ReadSetup(options.setup, options.overrides));
  const PlotLibrary plots = LoadPlotLibrary();
  watch.page = {std::string(PageStyle()), plots.script, plots.style};
  watch.server.title = machine.setup().name;
  SceneOptions scene;
  scene.width = kPictureWidth;
  scene.height = kPictureHeight;
  scene.smoothing = Smoothing::kSupersample2;
  scene.camera = options.camera;
  if (scene.camera.empty() &&
      mj_name2id(&machine.plant(), mjOBJ_CAMERA, "machine") >= 0) {
    scene.camera = "machine";
  }
  if (!options.no_picture) {
    watch.draw = [&](const std::vector<std::string>& names) {
      return DrawFaults(machine, names, scene);
    };
  }
  const PreparedDiagnosis prepared = Prepare(machine, options.diagnosis, {});
  watch.faults = MeaningsOf(machine, prepared.design);
  watch.on_event = [](const std::string& line) {
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
  };
  watch.on_note = [](const std::string& note) {
    std::fprintf(stderr, "watch: %s\n", note.c_str());
  };
  const Interrupt interrupt;
  LiveWatch live(machine, prepared, watch);
  std::fprintf(stderr, "watch: %s from %s\nwatch: %s\n", machine.setup().name.c_str(),
               mjdiag::AddressText(watch.source).c_str(), live.url().c_str());
  live.Run([] { return Interrupt::IsWished(); });
}

}  // namespace

void AddWatch(CLI::App& app) {
  auto options = std::make_shared<LiveOptions>();
  CLI::App* command = app.add_subcommand(
      "watch", "Diagnose a running machine, with a live page in the browser");
  command
      ->add_option("--setup", options->setup,
                   "Folder with setup.toml and the plant, or a setup file")
      ->required();
  command->add_option("--set", options->overrides,
                      "Override a key of the setup, for example physics.gravity=false");
  command
      ->add_option("--source", options->source,
                   "Where ticks come from: stdin, udp:[HOST:]PORT or "
                   "mqtt:HOST[:PORT]/TOPIC")
      ->required();
  command->add_flag("--linear", options->diagnosis.nominal.linear,
                    "The machine is taken as linear, without dry friction");
  command->add_option_function<std::string>(
      "--filters",
      [options](const std::string& file) { options->diagnosis.filters = file; },
      "filters.json of `mjdiag design` instead of designing now");
  command->add_option_function<std::string>(
      "--out", [options](const std::string& folder) { options->watch.folder = folder; },
      "Folder for the history and the changes, which the next watch goes on with");
  command->add_option("--listen", options->listen,
                      "[HOST:]PORT of the page; port 0: any that is free");
  command
      ->add_option("--token", options->watch.server.token,
                   "What everybody has to bring who looks; needed where --listen is "
                   "open to other machines")
      ->envname("MJDIAG_WATCH_TOKEN");
  command->add_option("--publish", options->publish,
                      "mqtt:HOST[:PORT]/TOPIC for changes of the verdict");
  AddBrokerOptions(*command, options->watch.login);
  command
      ->add_option("--save-every", options->watch.save_every,
                   "Seconds between two writings of the history")
      ->check(Within(1.0, kLongestTime));
  command->add_option("--camera", options->camera,
                      "Camera of the plant for its picture (default: machine)");
  command->add_flag("--no-picture", options->no_picture,
                    "No picture of the machine, which needs OSMesa");
  command->callback([options] { Watch(*options); });
}

}  // namespace mjdiag::app

#endif
