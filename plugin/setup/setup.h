#pragma once
// A setup: the plant and everything around it that makes a machine - rates, channels,
// controllers, noise, trajectories. docs/setup.md describes every key of the file.

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mjdiag/controllers/axis_controller.h"
#include "mjdiag/controllers/trajectory.h"
#include "mjdiag/diagnosis/diagnosis_options.h"
#include "mjdiag/plugin/setup/calibration_file.h"
#include "mjdiag/signals/record_file.h"

namespace mjdiag {

/// [sensors.<channel>]: a component of an MJCF sensor, read once a control tick.
struct SensorSetup {
  std::string channel;
  std::string element;      ///< MJCF sensor
  int component = 0;        ///< index within the sensor's data
  std::string unit;         ///< SI
  double noise_sd = 0.0;    ///< white noise a sample [unit]
  double resolution = 0.0;  ///< quantisation step [unit]; 0: none
};

/// What a recorded input does between its samples.
enum class Hold {
  kZero,        ///< keeps its sample, as the output of a digital controller does
  kLinear,      ///< goes straight to the next one
  kBandLimited  ///< has nothing above half the sampling rate
};

/// [actuators.<channel>]: an MJCF actuator, driven once a control tick.
struct ActuatorSetup {
  std::string channel;
  std::string element;      ///< MJCF actuator
  std::string unit;         ///< SI unit of its control signal
  double limit = 0.0;       ///< |u| is clamped to it; 0: not
  std::string enabled_by;   ///< record channel, 0: an open circuit; empty: always on
  Hold hold = Hold::kZero;  ///< of recorded inputs; commands of a controller are held
};

/// [axes.<name>]: one controlled axis.
struct AxisSetup {
  std::string name;
  std::string sensor;       ///< sensor channel
  std::string actuator;     ///< actuator channel
  double drive_gain = 1.0;  ///< actuator unit per command unit, for example N/A
  FeedforwardGains feedforward;
  std::optional<DiscreteCompensator> feedback;
  std::optional<NestedLoops> nested;
  std::string known_disturbance;  ///< record channel added to the command; empty: none
  MoveLimits limits;              ///< all 0: the setup gives none
};

/// [disturbances.<name>]: the multisine of Eq. 7 on actuator channels, switched on by
/// its magnitude (gamma; 0: healthy).
struct MultisineSetup {
  std::string name;
  std::vector<double> frequencies;          ///< [Hz]
  std::map<std::string, double> amplitude;  ///< actuator channel -> A = r |F_max|
};

/// [compare]: how figures of a measured record are computed.
struct CompareSetup {
  int skip_samples = 0;    ///< left out at the start
  int low_pass_order = 0;  ///< zero-phase Butterworth before differentiating; 0: none
  double low_pass_cutoff = 0.0;  ///< [Hz]
  /// actuator channel -> factor and name of the derived force, for example gtau
  struct Derived {
    std::string name;
    std::string channel;
    double factor = 1.0;
    std::string unit;
  };
  std::vector<Derived> forces;
};

/// [studies.<name>]: fault -> value, in the order of the file: the sizes that a study
/// works on, for example those that were published.
struct FaultSizes {
  std::string name;
  std::vector<std::pair<std::string, double>> values;
};

/// [rates]: the clock of the controller, and how finely physics follows it.
struct Rates {
  double control = 0.0;  ///< [Hz]
  int substeps = 1;      ///< physics steps a control tick

  double tick() const { return 1.0 / control; }             ///< [s]
  double step() const { return 1.0 / control / substeps; }  ///< of the physics [s]
};

/// [physics]
struct Physics {
  bool gravity = true;
  bool static_friction = true;
};

/// [sensors] and [actuators]: what is read and driven once a control tick.
struct Channels {
  std::string setup;  ///< whose they are, for messages
  std::vector<SensorSetup> sensors;
  std::vector<ActuatorSetup> actuators;

  /// The channel of that name; InputError lists the others without it.
  const SensorSetup& Sensor(std::string_view channel) const;
  const ActuatorSetup& Actuator(std::string_view channel) const;
  /// Its place in `sensors` and `actuators`; InputError as above.
  std::ptrdiff_t SensorIndex(std::string_view channel) const;
  std::ptrdiff_t ActuatorIndex(std::string_view channel) const;
  /// Channels that say whether actuators are on, each once.
  std::vector<std::string> Switches() const;
  /// A of a disturbance, of every command.
  Eigen::VectorXd AmplitudeOf(const MultisineSetup& source) const;
};

/// Names of the channels of sensors or actuators, in their order.
template <typename Element>
std::vector<std::string> ChannelsOf(const std::vector<Element>& elements) {
  std::vector<std::string> names;
  names.reserve(elements.size());
  for (const Element& element : elements) names.push_back(element.channel);
  return names;
}

/// [axes]
struct Control {
  std::vector<AxisSetup> axes;  ///< empty: open loop, records drive the actuators
};

/// [trajectories]
struct Trajectories {
  std::string setup;  ///< whose they are, for messages
  std::vector<Trajectory> all;
  std::string fallback;  ///< name of the one that is taken if none is named

  /// InputError lists the others without it.
  const Trajectory& Find(std::string_view name) const;
};

/// What the file says, part by part; a consumer takes the part that it needs.
struct Setup {
  std::filesystem::path folder;
  std::string name;
  std::filesystem::path plant;                     ///< MJCF file
  std::optional<std::filesystem::path> analytic;   ///< linear chain, see linear_chain.h
  std::optional<std::filesystem::path> published;  ///< printed parity relation
  /// What healthy runs have said about it (calibration_file.h).
  std::optional<Calibration> calibration;
  Rates rates;
  Physics physics;
  Channels channels;
  Control control;
  std::vector<MultisineSetup> disturbances;
  Trajectories trajectories;
  std::optional<ColumnMap> record;  ///< how a measured file becomes a Record
  CompareSetup compare;
  DiagnosisOptions diagnosis;
  std::vector<FaultSizes> studies;

  const FaultSizes& Study(std::string_view study) const;
};

/// Whether that is a disturbance of the setup, and no fault parameter of the plant.
bool IsDisturbance(const Setup& setup, std::string_view name);

/// `where` itself if it is a file, else `<where>/setup.toml`.
std::filesystem::path FindSetupFile(const std::filesystem::path& where);

/// Reads the file that FindSetupFile names. `overrides` are `key.path=value` in TOML
/// syntax and replace values of the file. InputError names file, line and key:
/// malformed TOML, unknown or missing key, wrong type, value out of range, a name that
/// nothing declares.
Setup ReadSetup(const std::filesystem::path& where,
                const std::vector<std::string>& overrides = {});

}  // namespace mjdiag
