#include "mjdiag/plugin/replay/input_hold.h"

#include <Eigen/Core>
#include <algorithm>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/replay/force_filter.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/plugin/replay/sensor_noise.h"
#include "mjdiag/plugin/replay/tracking.h"
#include "mjdiag/plugin/setup/measured_file.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

namespace {

struct MachineAlong {
  Machine machine;
  MeasuredRun run;
};

MachineAlong Along(const Setup& setup, const std::filesystem::path& record) {
  MachineAlong along{Machine(setup),
                     ToMeasuredRun(setup, ReadMeasured(setup, record).record)};
  along.run =
      PiecesOfRun(along.machine, along.run, LatentDofs(along.machine, along.run));
  return along;
}

}  // namespace

std::vector<std::string> InputsOfUnknownHold(const Setup& setup) {
  std::vector<std::string> channels;
  for (const ActuatorSetup& actuator : setup.channels.actuators) {
    const bool is_driven = std::ranges::any_of(
        setup.control.axes,
        [&](const AxisSetup& axis) { return axis.actuator == actuator.channel; });
    if (!actuator.hold && !is_driven) channels.push_back(actuator.channel);
  }
  return channels;
}

double GainOfStraightInputs(const Setup& setup, const std::filesystem::path& record) {
  Setup straight = setup;
  for (const std::string& channel : InputsOfUnknownHold(setup)) {
    const auto place = setup.channels.ActuatorIndex(channel);
    straight.channels.actuators[static_cast<std::size_t>(place)].hold = Hold::kLinear;
  }
  const MachineAlong held = Along(setup, record);
  const MachineAlong other = Along(straight, record);
  try {
    const Eigen::VectorXd reading_sd = SensorNoise(setup.channels, held.run);
    const FilterPath path = FilterLikeliest(held.machine, held.run, reading_sd);
    return path.deviance - FilterLikeliestNear(other.machine, other.run, reading_sd,
                                               path.dofs, path.noise)
                               .deviance;
  } catch (const NumericalError&) {
    return 0.0;
  }
}

}  // namespace mjdiag
