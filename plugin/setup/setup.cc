#include "mjdiag/plugin/setup/setup.h"

#include <algorithm>
#include <set>

#include "mjdiag/plugin/setup/setup_reader.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

/// The element whose `name` is `wanted`; InputError lists the others without it.
template <typename Element>
const Element& FindNamed(const std::string& setup, const std::vector<Element>& elements,
                         std::string Element::*name, std::string_view wanted,
                         const std::string& kind) {
  std::string known;
  for (const Element& element : elements) {
    if (element.*name == wanted) return element;
    known += (known.empty() ? "" : ", ") + element.*name;
  }
  throw InputError("setup '" + setup + "'",
                   "there is no " + kind + " '" + std::string(wanted) + "'",
                   known.empty() ? "a setup that declares one" : "one of " + known);
}

}  // namespace

const SensorSetup& Channels::Sensor(std::string_view channel) const {
  return FindNamed(setup, sensors, &SensorSetup::channel, channel, "sensor channel");
}

const ActuatorSetup& Channels::Actuator(std::string_view channel) const {
  return FindNamed(setup, actuators, &ActuatorSetup::channel, channel,
                   "actuator channel");
}

std::ptrdiff_t Channels::SensorIndex(std::string_view channel) const {
  return &Sensor(channel) - sensors.data();
}

std::ptrdiff_t Channels::ActuatorIndex(std::string_view channel) const {
  return &Actuator(channel) - actuators.data();
}

std::vector<std::string> Channels::Switches() const {
  std::set<std::string> names;
  for (const ActuatorSetup& actuator : actuators) names.insert(actuator.enabled_by);
  names.erase("");
  return {names.begin(), names.end()};
}

Eigen::VectorXd Channels::AmplitudeOf(const MultisineSetup& source) const {
  Eigen::VectorXd amplitude =
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(actuators.size()));
  for (const auto& [channel, value] : source.amplitude) {
    amplitude[ActuatorIndex(channel)] = value;
  }
  return amplitude;
}

const Trajectory& Trajectories::Find(std::string_view name) const {
  return FindNamed(setup, all, &Trajectory::name, name, "trajectory");
}

const FaultSizes& Setup::Study(std::string_view study) const {
  return FindNamed(name, studies, &FaultSizes::name, study, "[studies] table");
}

bool IsDisturbance(const Setup& setup, std::string_view name) {
  return std::any_of(setup.disturbances.begin(), setup.disturbances.end(),
                     [&](const MultisineSetup& d) { return d.name == name; });
}

std::filesystem::path FindSetupFile(const std::filesystem::path& where) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(where, ignored) ? where
                                                          : where / "setup.toml";
}

Setup ReadSetup(const std::filesystem::path& where,
                const std::vector<std::string>& overrides) {
  std::set<std::string> known_keys;
  return ReadSetup(where, overrides, known_keys);
}

}  // namespace mjdiag
