#include "app/machine.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "app/format.h"
#include "app/progress.h"
#include "mjdiag/signals/error.h"

namespace mjdiag::app {
namespace {

constexpr double kLongestRun = 1e4;  // s
constexpr double kMostNoise = 1e9;

Fault ParseFault(const std::string& text) {
  const std::size_t equals = text.find('=');
  Fault fault{text.substr(0, equals), 0.0};
  const char* begin = text.data() + (equals == text.npos ? text.size() : equals + 1);
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(begin, end, fault.value);
  if (error != std::errc() || stop != end) {
    throw InputError("--fault '" + text + "'", "no number", "<name>=<value>");
  }
  return fault;
}

bool IsDisturbance(const Setup& setup, const std::string& name) {
  return std::any_of(setup.disturbances.begin(), setup.disturbances.end(),
                     [&](const MultisineSetup& d) { return d.name == name; });
}

// A fault is tried on a copy of the plant, so that a wrong one is reported before
// anything else happens.
void AddFault(const Fault& fault, Machine& machine, mjModel& trial) {
  const auto& faults = machine.options.faults;
  if (machine.options.disturbances.contains(fault.name) ||
      std::any_of(faults.begin(), faults.end(),
                  [&](const Fault& f) { return f.name == fault.name; })) {
    throw InputError("--fault " + fault.name, "given twice", "one value");
  }
  if (!std::isfinite(fault.value)) {
    throw InputError("--fault " + fault.name, "not a finite number", "a finite one");
  }
  if (IsDisturbance(machine.setup, fault.name)) {
    machine.options.disturbances[fault.name] = fault.value;
    return;
  }
  ApplyFault(trial, fault);
  machine.options.faults.push_back(fault);
}

}  // namespace

CLI::Validator Within(double least, double most) {
  const auto check = [=](const std::string& text) -> std::string {
    double value = 0.0;
    const auto [end, error] =
        std::from_chars(text.data(), text.data() + text.size(), value);
    const bool number = error == std::errc() && end == text.data() + text.size();
    if (number && value >= least && value <= most) return "";
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
      "Turn a fault knob of the plant or a disturbance of the setup, for "
      "example zeta_x=1.05");
  command.add_option("--effect", options.effects,
                     "Add physics that the plant lacks, for example "
                     "coulomb_friction@load:force=20");
  command.add_flag("--no-friction", options.no_friction,
                   "Switch the plant's static friction off");
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
  command.add_option("--seed", options.seed, "Seed of the noise");
  command.add_flag("--linear", options.linear,
                   "Run the linearised plant instead of the nonlinear one");
}

Machine LoadMachine(const MachineOptions& options) {
  Machine machine{ReadSetup(options.setup, options.overrides), nullptr, {}};
  if (options.no_friction) machine.setup.static_friction = false;
  machine.plant = LoadPlant(machine.setup);
  const ModelPtr trial = CopyModel(*machine.plant);
  for (const std::string& text : options.faults) {
    AddFault(ParseFault(text), machine, *trial);
  }
  for (const EffectSpec& effect : EffectsOf(*machine.plant))
    CheckEffect(*trial, effect);
  for (const std::string& text : options.effects) {
    machine.options.effects.push_back(ParseEffect(text));
    CheckEffect(*trial, machine.options.effects.back());
  }
  return machine;
}

Excitation MakeExcitation(const Setup& setup, const MotionOptions& motion) {
  if (!motion.replay.empty()) {
    Record record = ReadRecord(motion.replay, setup.record);
    if (motion.duration > 0.0) {
      const auto wanted = static_cast<Eigen::Index>(
          std::max(1.0, motion.duration / record.sample_time() + 0.5));
      record = record.Slice(0, std::min(wanted, record.samples()));
    }
    return Replay(setup, record);
  }
  if (setup.axes.empty()) {
    throw InputError("--setup", "'" + setup.name + "' has no controlled axes",
                     "--replay RECORD with its inputs");
  }
  const std::string& name =
      motion.trajectory.empty() ? setup.default_trajectory : motion.trajectory;
  Trajectory trajectory = setup.FindTrajectory(name);
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
  with_bar.progress = [&bar](double fraction) { bar.Show(fraction); };
  return motion.linear
             ? SimulateLinear(machine.setup, *machine.plant, excitation, with_bar)
             : Simulate(machine.setup, *machine.plant, excitation, with_bar);
}

std::string Describe(const RunOptions& options) {
  std::string text;
  const auto append = [&text](const std::string& item) {
    text += (text.empty() ? "" : ", ") + item;
  };
  for (const Fault& fault : options.faults) {
    append(fault.name + " = " + Short(fault.value));
  }
  for (const auto& [name, magnitude] : options.disturbances) {
    append(name + " = " + Short(magnitude));
  }
  for (const EffectSpec& effect : options.effects) {
    append(effect.effect + " at " + effect.site);
  }
  return text.empty() ? "healthy" : text;
}

nlohmann::json ToJson(const RunOptions& options) {
  nlohmann::json faults = nlohmann::json::array();
  for (const Fault& fault : options.faults) {
    faults.push_back({{"name", fault.name}, {"value", fault.value}});
  }
  for (const auto& [name, magnitude] : options.disturbances) {
    faults.push_back({{"name", name}, {"value", magnitude}});
  }
  nlohmann::json effects = nlohmann::json::array();
  for (const EffectSpec& effect : options.effects) {
    effects.push_back({{"effect", effect.effect},
                       {"site", effect.site},
                       {"parameters", effect.parameters}});
  }
  return {{"faults", faults}, {"effects", effects}};
}

}  // namespace mjdiag::app
