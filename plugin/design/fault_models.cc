#include "mjdiag/plugin/design/fault_models.h"

#include <algorithm>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr double kDefaultMagnitude = 1e-3;

/// What a knob adds to the model per unit of its value.
struct Slope {
  Eigen::MatrixXd D;
  Eigen::MatrixXd K;
  Eigen::MatrixXd Gamma;
};

/// Relative to the springs of the machine.
constexpr double kMoved = 1e-9;

bool MovesTheEquilibrium(const Machine& machine, const Fault& turned) {
  const Eigen::VectorXd& healthy = machine.rest();
  const Eigen::VectorXd moved = machine.With({{turned}, {}}).rest();
  return (moved - healthy).norm() > kMoved * (1.0 + healthy.norm());
}

}  // namespace

std::vector<Fault> HealthyKnobs(const mjModel& plant) {
  std::vector<Fault> knobs;
  for (const FaultKnob& knob : FaultKnobs(plant)) knobs.push_back({knob.name, 1.0});
  return knobs;
}

Eigen::VectorXd Magnitudes(const Machine& machine) {
  const std::vector<Fault> knobs = HealthyKnobs(machine.plant());
  std::string known;
  for (const Fault& knob : knobs) known += (known.empty() ? "" : ", ") + knob.name;
  Eigen::VectorXd magnitudes = Eigen::VectorXd::Constant(
      static_cast<Eigen::Index>(knobs.size()), kDefaultMagnitude);
  for (const auto& [name, magnitude] : machine.setup().diagnosis.magnitudes) {
    const auto found =
        std::find_if(knobs.begin(), knobs.end(),
                     [&n = name](const Fault& knob) { return knob.name == n; });
    if (found == knobs.end()) {
      throw InputError(
          "setup '" + machine.setup().name + "': diagnosis.estimation.magnitudes",
          "the plant has no knob '" + name + "'", "one of " + known);
    }
    magnitudes[found - knobs.begin()] = magnitude;
  }
  return magnitudes;
}

ModelAt FaultModels(const Machine& machine) {
  const std::vector<Fault> healthy = HealthyKnobs(machine.plant());
  const auto full = [machine, healthy](const Eigen::VectorXd& knobs) {
    std::vector<Fault> faults = healthy;
    for (std::size_t i = 0; i < faults.size(); ++i) {
      faults[i].value = knobs[static_cast<Eigen::Index>(i)];
    }
    return machine.With({faults, {}}).linear();
  };
  const MechanicalModel base = machine.linear();
  std::vector<Slope> slopes;
  for (std::size_t i = 0; i < healthy.size(); ++i) {
    // Half the value tells more than a small step: the models are affine.
    constexpr double kTurned = 0.5;
    if (MovesTheEquilibrium(machine, {healthy[i].name, kTurned})) return full;
    Eigen::VectorXd knobs =
        Eigen::VectorXd::Ones(static_cast<Eigen::Index>(healthy.size()));
    knobs[static_cast<Eigen::Index>(i)] = kTurned;
    const MechanicalModel turned = full(knobs);
    slopes.push_back({(turned.D - base.D) / (kTurned - 1.0),
                      (turned.K - base.K) / (kTurned - 1.0),
                      (turned.Gamma - base.Gamma) / (kTurned - 1.0)});
  }
  return [base, slopes](const Eigen::VectorXd& knobs) {
    MechanicalModel model = base;
    for (std::size_t i = 0; i < slopes.size(); ++i) {
      const double turned = knobs[static_cast<Eigen::Index>(i)] - 1.0;
      model.D += turned * slopes[i].D;
      model.K += turned * slopes[i].K;
      model.Gamma += turned * slopes[i].Gamma;
    }
    return model;
  };
}

std::vector<TurnedModels> TurnModels(const Machine& machine) {
  std::vector<std::string> names;
  for (const Fault& knob : HealthyKnobs(machine.plant())) names.push_back(knob.name);
  const Eigen::VectorXd magnitudes = Magnitudes(machine);
  return TurnAbout(names, Eigen::VectorXd::Ones(magnitudes.size()), magnitudes,
                   FaultModels(machine));
}

std::vector<Multisine> Multisines(const Setup& setup) {
  std::vector<Multisine> sines;
  for (const MultisineSetup& source : setup.disturbances) {
    Eigen::VectorXd amplitude = Eigen::VectorXd::Zero(
        static_cast<Eigen::Index>(setup.channels.actuators.size()));
    for (const auto& [channel, value] : source.amplitude) {
      amplitude[setup.channels.ActuatorIndex(channel)] = value;
    }
    sines.push_back({source.name, source.frequencies, amplitude});
  }
  return sines;
}

}  // namespace mjdiag
