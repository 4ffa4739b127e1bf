#include "mjdiag/plugin/design/fault_family.h"

#include <algorithm>
#include <numbers>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/listed.h"

namespace mjdiag {
namespace {

constexpr double kDefaultMagnitude = 1e-3;

/// What a fault parameter adds to the model per unit of its value.
struct Slope {
  Eigen::MatrixXd M;
  Eigen::MatrixXd D;
  Eigen::MatrixXd K;
  Eigen::MatrixXd Gamma;
};

/// Relative to the springs of the machine.
constexpr double kMoved = 1e-9;

bool MovesTheEquilibrium(const Machine& machine, const Fault& fault) {
  const Eigen::VectorXd& healthy = machine.rest();
  const Eigen::VectorXd moved = machine.With({{fault}, {}}).rest();
  return (moved - healthy).norm() > kMoved * (1.0 + healthy.norm());
}

Eigen::VectorXd Magnitudes(const Setup& setup,
                           const std::vector<std::string>& parameters) {
  Eigen::VectorXd magnitudes = Eigen::VectorXd::Constant(
      static_cast<Eigen::Index>(parameters.size()), kDefaultMagnitude);
  for (const auto& [name, magnitude] : setup.diagnosis.magnitudes) {
    const auto found = std::find(parameters.begin(), parameters.end(), name);
    if (found == parameters.end()) {
      throw InputError("setup '" + setup.name + "': diagnosis.estimation.magnitudes",
                       "the plant has no fault parameter '" + name + "'",
                       "one of " + Listed(parameters));
    }
    magnitudes[found - parameters.begin()] = magnitude;
  }
  return magnitudes;
}

ModelAt FaultModels(const Machine& machine,
                    const std::vector<std::string>& parameters) {
  const auto full = [machine, parameters](const Eigen::VectorXd& values) {
    Changes changes;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      changes.faults.push_back({parameters[i], values[static_cast<Eigen::Index>(i)]});
    }
    return machine.With(changes).linear();
  };
  const MechanicalModel& base = machine.linear();
  std::vector<Slope> slopes;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    // Half the value tells more than a small step: the models are affine.
    constexpr double kMovedTo = 0.5;
    if (MovesTheEquilibrium(machine, {parameters[i], kMovedTo})) return full;
    Eigen::VectorXd values =
        Eigen::VectorXd::Ones(static_cast<Eigen::Index>(parameters.size()));
    values[static_cast<Eigen::Index>(i)] = kMovedTo;
    const MechanicalModel moved = full(values);
    slopes.push_back({(moved.M - base.M) / (kMovedTo - 1.0),
                      (moved.D - base.D) / (kMovedTo - 1.0),
                      (moved.K - base.K) / (kMovedTo - 1.0),
                      (moved.Gamma - base.Gamma) / (kMovedTo - 1.0)});
  }
  return [base, slopes](const Eigen::VectorXd& values) {
    MechanicalModel model = base;
    for (std::size_t i = 0; i < slopes.size(); ++i) {
      const double moved = values[static_cast<Eigen::Index>(i)] - 1.0;
      model.M += moved * slopes[i].M;
      model.D += moved * slopes[i].D;
      model.K += moved * slopes[i].K;
      model.Gamma += moved * slopes[i].Gamma;
    }
    return model;
  };
}

std::vector<Multisine> Multisines(const Setup& setup) {
  std::vector<Multisine> sines;
  for (const MultisineSetup& source : setup.disturbances) {
    sines.push_back(
        {source.name, source.frequencies, setup.channels.AmplitudeOf(source)});
  }
  return sines;
}

}  // namespace

std::vector<std::string> FaultFamily::Names() const {
  std::vector<std::string> names = parameters;
  for (const Multisine& source : disturbances) names.push_back(source.name);
  return names;
}

std::vector<PerturbedModels> FaultFamily::Perturbed() const {
  return PerturbedAbout(Eigen::VectorXd::Ones(magnitudes.size()));
}

std::vector<PerturbedModels> FaultFamily::PerturbedAbout(
    const Eigen::VectorXd& values) const {
  std::vector<PerturbedModels> perturbed;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    Eigen::VectorXd minus = values;
    Eigen::VectorXd plus = values;
    minus[i] -= magnitudes[i];
    plus[i] += magnitudes[i];
    perturbed.push_back({parameters[static_cast<std::size_t>(i)], magnitudes[i],
                         model_at(minus), model_at(plus)});
  }
  return perturbed;
}

Eigen::MatrixXd ToneOf(const Multisine& source, double frequency, double phase,
                       double tick, Eigen::Index samples) {
  const auto last = static_cast<double>(samples - 1);
  const Eigen::ArrayXd angle = 2.0 * std::numbers::pi * frequency * tick *
                               Eigen::ArrayXd::LinSpaced(samples, 0.0, last);
  return source.amplitude * (angle + phase).sin().matrix().transpose();
}

FaultFamily MakeFaultFamily(const Machine& machine) {
  FaultFamily family;
  for (const FaultParameter& parameter : FaultParameters(machine.plant())) {
    family.parameters.push_back(parameter.name);
  }
  family.magnitudes = Magnitudes(machine.setup(), family.parameters);
  family.model_at = FaultModels(machine, family.parameters);
  family.disturbances = Multisines(machine.setup());
  return family;
}

}  // namespace mjdiag
