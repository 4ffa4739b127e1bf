#include "app/subject.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <utility>

#include "app/format.h"
#include "app/progress.h"
#include "mjdiag/plugin/draft/setup_draft.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/time_step.h"
#include "mjdiag/plugin/runtime/late_faults.h"
#include "mjdiag/plugin/setup/measured_file.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/listed.h"
#include "mjdiag/signals/number_text.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag::app {
namespace {

constexpr double kLongestRun = 1e4;  // s
constexpr double kMostNoise = 1e9;

void AddLateFault(const LateFault& late, Subject& subject) {
  const auto& [fault, time, growth] = late;
  if (!(time >= 0.0) || time > kLongestRun) {
    throw InputError("--fault " + fault.name, "appears at no time of a run",
                     "0 to " + Short(kLongestRun) + " s");
  }
  for (const LateFault& other : subject.options.late_faults) {
    if (other.fault.name == fault.name && other.time == time) {
      throw InputError("--fault " + fault.name, "given twice", "one value a time");
    }
  }
  // Complains of names and values that there are not.
  if (!IsDisturbance(subject.setup(), fault.name)) subject.nominal.With({{fault}, {}});
  subject.options.late_faults.push_back(late);
}

void AddFault(const Fault& fault, Subject& subject) {
  const std::vector<Fault>& faults = subject.machine.changes().faults;
  if (subject.options.disturbances.contains(fault.name) ||
      std::any_of(faults.begin(), faults.end(),
                  [&](const Fault& f) { return f.name == fault.name; })) {
    throw InputError("--fault " + fault.name, "given twice", "one value");
  }
  if (IsDisturbance(subject.setup(), fault.name)) {
    subject.options.disturbances[fault.name] = fault.value;
    return;
  }
  subject.machine = subject.machine.With({{fault}, {}});
}

void AddFault(const std::string& text, Subject& subject) {
  const LateFault fault = ParseLateFault(text);
  if (!std::isfinite(fault.fault.value)) {
    throw InputError("--fault " + fault.fault.name, "not a finite number",
                     "a finite one");
  }
  if (text.find('@') == text.npos) {
    AddFault(fault.fault, subject);
  } else {
    AddLateFault(fault, subject);
  }
}

}  // namespace

CLI::Validator Within(double least, double most) {
  const auto check = [=](const std::string& text) -> std::string {
    const auto number = ParseNumber(text);
    if (number && *number >= least && *number <= most) return "";
    return "'" + text + "' is not a number from " + Short(least) + " to " + Short(most);
  };
  return {check, "FROM " + Short(least) + " TO " + Short(most)};
}

void AddMachineOptions(CLI::App& command, MachineOptions& options) {
  command
      .add_option("--setup", options.setup,
                  "Folder with setup.toml and the plant, or a setup file")
      ->required();
  command.add_option("--set", options.overrides,
                     "Override a key of the setup, for example physics.gravity=false");
  command.add_option(
      "--fault", options.faults,
      "Set a fault parameter of the plant or a disturbance of the setup, for "
      "example zeta_x=1.05; from a time of the run on [s]: zeta_x=1.05@0.5");
  command.add_option("--effect", options.effects,
                     "Add physics that the plant lacks, for example "
                     "coulomb_friction@load:force=20");
  command.add_flag("--no-friction", options.no_friction,
                   "Switch the plant's static friction off");
}

void AddMachineOrPlantOptions(CLI::App& command, MachineOptions& options) {
  AddMachineOptions(command, options);
  CLI::Option* setup = command.get_option("--setup")->required(false);
  command
      .add_option(
          "--plant", options.plant,
          "In the place of --setup, an MJCF or URDF file, where a setup follows "
          "from it and the record without doubt (mjdiag init)")
      ->excludes(setup);
}

std::vector<std::string> DraftMachine(MachineOptions& options,
                                      const std::string& record) {
  if (options.plant.empty()) {
    if (options.setup.empty()) {
      throw InputError("--setup", "is missing", "a setup, or --plant with its plant");
    }
    return {};
  }
  const SourcePlant source = LoadSourcePlant(options.plant);
  const SetupDraft draft = DraftSetup(source, options.plant, record);
  if (!draft.certain()) {
    const std::string log = record.empty() ? "" : " --record " + record;
    throw InputError("--plant " + options.plant, Listed(draft.questions, "; "),
                     "a setup: `mjdiag init --plant " + options.plant + log +
                         " --out FOLDER` writes what is certain");
  }
  options.drafted = std::make_shared<ScratchFolder>();
  options.setup = options.drafted->path().string();
  WriteDraft(draft, source, options.drafted->path());
  std::vector<std::string> notes = draft.notes;
  for (const auto* lines : {&draft.assumed, &draft.added}) {
    const char* what = lines == &draft.assumed ? "assumed: " : "added to the plant: ";
    if (!lines->empty()) notes.push_back(what + Listed(*lines, "; "));
  }
  return notes;
}

void AddMotionOptions(CLI::App& command, MotionOptions& options) {
  command.add_option("--trajectory", options.trajectory,
                     "Trajectory of the setup (default: its default)");
  command
      .add_option("--replay", options.replay,
                  "Follow the reference, or apply the inputs, of this record")
      ->excludes("--trajectory");
  command.add_option("--duration", options.duration, "Stop after this time [s]")
      ->check(Within(0.0, kLongestRun));
  command.add_option("--mode", options.mode, "Which part of the controllers acts")
      ->check(CLI::IsMember({"both", "feedback", "feedforward"}));
  command
      .add_option("--noise", options.noise_scale, "Factor on all sensor noise; 0: none")
      ->check(Within(0.0, kMostNoise));
  AddSeedOption(command, options.seed, "Seed of the noise");
  command.add_flag("--linear", options.linear,
                   "Run the linearised plant instead of the nonlinear one");
}

void AddSeedOption(CLI::App& command, std::uint64_t& seed, const std::string& words) {
  command.add_option("--seed", seed, words)
      ->check([](const std::string& text) -> std::string {
        if (text.find('-') == text.npos) return "";
        return "'" + text + "' is negative; expected a whole number from 0 on";
      });
}

void RequireUnchanged(const MachineOptions& options, const std::string& written) {
  if (options.overrides.empty() && options.faults.empty() && options.effects.empty()) {
    return;
  }
  throw InputError("--set, --fault, --effect", written + " would not have them",
                   "the setup and its plant as they are");
}

Subject LoadSubject(const MachineOptions& options) {
  Setup setup = ReadSetup(options.setup, options.overrides);
  if (options.no_friction) setup.physics.static_friction = false;
  const Machine nominal(std::move(setup));
  Subject subject{nominal, nominal, {}};
  for (const std::string& text : options.faults) AddFault(text, subject);
  for (const PlacedEffect& effect : nominal.effects()) {
    CheckEffect(nominal.plant(), effect);
  }
  for (const std::string& text : options.effects) {
    subject.machine = subject.machine.With({{}, {ParseEffect(text)}});
  }
  return subject;
}

std::vector<std::string> AdoptClock(MachineOptions& options,
                                    const std::string& record) {
  const Setup setup = ReadSetup(options.setup, options.overrides);
  const double tick = setup.rates.tick();
  Resampling resampling;
  resampling.sample_time = tick;
  resampling.own_clock = kNearStep;
  double own = tick;
  try {
    own = ReadMeasuredFile(record, setup.record, resampling).record.sample_time();
  } catch (const InputError&) {
    return {};  // who reads it says so, with what a manifest says of it
  }
  const double off = own / tick - 1.0;
  if (std::abs(off) <= kSameClock) return {};
  char rate[40];
  std::snprintf(rate, sizeof rate, "%.17g", 1.0 / own);
  options.overrides.push_back(std::string("rates.control=") + rate);
  return {std::filesystem::path(record).filename().string() + ": the sample time is " +
          FormatNumber(100.0 * std::abs(off), 2) +
          " % off the control tick: its samples are taken as ticks"};
}

Record ReadMeasured(const Setup& setup, const std::string& file,
                    std::vector<std::string>& notes) {
  MeasuredFile measured = mjdiag::ReadMeasured(setup, file);
  for (const std::string& note : measured.notes) {
    notes.push_back(std::filesystem::path(file).filename().string() + ": " + note);
  }
  return std::move(measured.record);
}

Excitation MakeExcitation(const Setup& setup, const MotionOptions& motion,
                          std::vector<std::string>& notes) {
  if (!motion.replay.empty()) {
    Record record = ReadMeasured(setup, motion.replay, notes);
    if (motion.duration > 0.0) {
      const auto wanted = static_cast<Eigen::Index>(
          std::max(1.0, motion.duration / record.sample_time() + 0.5));
      record = record.Slice(0, std::min(wanted, record.samples()));
    }
    return Replay(setup, record);
  }
  if (setup.control.axes.empty()) {
    throw InputError("--setup", "'" + setup.name + "' has no controlled axes",
                     "--replay RECORD with its inputs");
  }
  const std::string& name =
      motion.trajectory.empty() ? setup.trajectories.fallback : motion.trajectory;
  Trajectory trajectory = setup.trajectories.Find(name);
  if (motion.duration > 0.0) trajectory.duration = motion.duration;
  return FollowTrajectory(setup, trajectory);
}

void SetMotion(const MotionOptions& motion, RunOptions& options) {
  options.mode = motion.mode == "feedback"      ? ControlMode::kFeedback
                 : motion.mode == "feedforward" ? ControlMode::kFeedforward
                                                : ControlMode::kBoth;
  options.noise_scale = motion.noise_scale;
  options.seed = motion.seed;
}

Record Run(const Machine& machine, const MotionOptions& motion,
           const Excitation& excitation, const RunOptions& options,
           const std::string& label) {
  ProgressBar bar(label);
  RunOptions with_bar = options;
  with_bar.progress = bar.Shower();
  return motion.linear ? SimulateLinear(machine, excitation, with_bar)
                       : Simulate(machine, excitation, with_bar);
}

std::string SubjectText(const Subject& subject) {
  const auto& [faults, effects, numbers] = subject.machine.changes();
  std::string text;
  const auto append = [&text](const std::string& item) {
    text += (text.empty() ? "" : ", ") + item;
  };
  for (const Fault& fault : faults) {
    append(fault.name + " = " + Short(fault.value));
  }
  for (const auto& [name, magnitude] : subject.options.disturbances) {
    append(name + " = " + Short(magnitude));
  }
  for (const auto& [fault, time, growth] : subject.options.late_faults) {
    append(fault.name + " = " + Short(fault.value) + " from " +
           FormatQuantity(time, "s") + " on");
  }
  for (const PlacedEffect& effect : effects) {
    append(effect.name() + " at " + effect.site);
  }
  return text.empty() ? "healthy" : text;
}

nlohmann::json ToJson(const Subject& subject) {
  nlohmann::json faults = nlohmann::json::array();
  for (const Fault& fault : subject.machine.changes().faults) {
    faults.push_back({{"name", fault.name}, {"value", fault.value}});
  }
  for (const auto& [name, magnitude] : subject.options.disturbances) {
    faults.push_back({{"name", name}, {"value", magnitude}});
  }
  for (const auto& [fault, time, growth] : subject.options.late_faults) {
    faults.push_back({{"name", fault.name}, {"value", fault.value}, {"since", time}});
  }
  nlohmann::json effects = nlohmann::json::array();
  for (const PlacedEffect& effect : subject.machine.changes().effects) {
    effects.push_back({{"effect", effect.name()},
                       {"site", effect.site},
                       {"parameters", NamedValues(effect)}});
  }
  return {{"faults", faults}, {"effects", effects}};
}

std::vector<std::string> NotesOn(const Machine& machine) {
  std::string names;
  int count = 0;
  const mjModel& plant = machine.plant();
  for (int id = 0; id < plant.nu; ++id) {
    const std::vector<int>& driven = machine.actuator_addresses();
    if (std::ranges::find(driven, id) != driven.end()) continue;
    names +=
        (count++ == 0 ? "'" : ", '") + ElementName(plant, mjOBJ_ACTUATOR, id) + "'";
  }
  if (count == 0) return {};
  return {(count == 1 ? "actuator " : "actuators ") + names +
          (count == 1 ? " of the plant is 0" : " of the plant are 0") +
          " all the time: no [actuators] of the setup gives an input"};
}

}  // namespace mjdiag::app
