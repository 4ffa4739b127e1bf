#include "mjdiag/plugin/design/machine_twin.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/plant/start_state.h"
#include "mjdiag/plugin/replay/observer.h"
#include "mjdiag/plugin/replay/plant_twin.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Ticks of a block at 8 kHz; what varies faster than it is seen by its mean.
constexpr Index kBlock = 8;
/// Of the twin that is pulled beside a machine that does not begin at rest.
constexpr double kSettlingBandwidth = 100.0;  // Hz
/// How far a factor may be from 1, in its logarithm, before it is known to be.
constexpr double kFactorSpread = 0.1;
constexpr double kToneSpread = 0.1;
/// The linear twin answers to its start as it does to nothing else: exactly linearly.
constexpr double kStartEnergy = 1.0;  // J

/// Noise and the steps of a coarse reading.
VectorXd ReadingNoise(const Channels& channels) {
  VectorXd sd(static_cast<Index>(channels.sensors.size()));
  for (Index i = 0; i < sd.size(); ++i) {
    const SensorSetup& sensor = channels.sensors[static_cast<std::size_t>(i)];
    sd[i] = std::hypot(sensor.noise_sd, sensor.resolution / std::sqrt(12.0));
  }
  return sd;
}

/// Without what rounding leaves of entries that do not change.
MatrixXd SlopeOf(const MatrixXd& moved, const MatrixXd& base, double by) {
  constexpr double kRounding = 1e-12;
  const double least = kRounding * base.cwiseAbs().maxCoeff();
  MatrixXd slope = moved - base;
  slope = (slope.array().abs() > least).select(slope / by, 0.0);
  return slope;
}

/// Fault parameters are the first unknowns.
std::vector<TwinFault> FaultsOf(const Machine& machine, Index first_tone) {
  std::vector<TwinFault> faults;
  for (const FaultParameter& parameter : FaultParameters(machine.plant())) {
    faults.push_back({parameter.name, static_cast<Index>(faults.size()), 0});
  }
  for (const MultisineSetup& source : machine.setup().disturbances) {
    const auto tones = static_cast<Index>(source.frequencies.size());
    faults.push_back({source.name, first_tone, tones});
    first_tone += 2 * tones;
  }
  return faults;
}

}  // namespace

UncertainModel MakeUncertainModel(const Machine& machine) {
  const FaultFamily family = MakeFaultFamily(machine);
  UncertainModel model;
  model.nominal = machine.linear();
  model.timing = {machine.rates().step(), machine.rates().substeps};
  model.rest = SensorReadings(machine.channels(), machine.plant(), machine.rest());
  const auto count = static_cast<Index>(family.parameters.size());
  const MechanicalModel base = family.model_at(VectorXd::Ones(count));
  for (Index i = 0; i < count; ++i) {
    VectorXd values = VectorXd::Ones(count);
    values[i] = 0.5;
    const MechanicalModel moved = family.model_at(values);
    model.slopes.push_back({SlopeOf(moved.D, base.D, -0.5),
                            SlopeOf(moved.K, base.K, -0.5),
                            SlopeOf(moved.Gamma, base.Gamma, -0.5)});
    model.unknowns.push_back(
        {family.parameters[static_cast<std::size_t>(i)], 1.0, kFactorSpread, true});
  }
  for (const Multisine& source : family.disturbances) {
    for (const double frequency : source.frequencies) {
      model.tones.push_back({frequency, source.amplitude});
      model.unknowns.push_back({source.name + " sine", 0.0, kToneSpread, false});
      model.unknowns.push_back({source.name + " cosine", 0.0, kToneSpread, false});
    }
  }
  model.start = StartDirections(model.nominal, kStartEnergy);
  for (Index i = 0; i < model.start.cols(); ++i) {
    model.unknowns.push_back({"start " + std::to_string(i + 1), 0.0, 1.0, false});
  }
  return model;
}

MachineTwin MakeTwin(const Machine& machine, bool linear) {
  MachineTwin twin;
  twin.sensor_noise = ReadingNoise(machine.channels());
  if (!(twin.sensor_noise.minCoeff() > 0.0)) {
    throw InputError("twin", "a sensor without noise", "a noise on every sensor");
  }
  twin.sample_time = machine.rates().tick();
  const MatrixXd gain =
      DesignObserver(machine.linear(), machine.rates().step(), machine.rates().substeps,
                     twin.sensor_noise,
                     std::min(kSettlingBandwidth, 0.02 * machine.rates().control))
          .L;
  if (linear) {
    const UncertainModel model = MakeUncertainModel(machine);
    const auto parameters = static_cast<Index>(model.slopes.size());
    twin.unknowns = model.unknowns;
    twin.faults = FaultsOf(machine, parameters);
    twin.twin = std::make_unique<LinearTwin>(model, gain, kBlock);
    return twin;
  }
  UncertainPlant plant = MakeUncertainPlant(machine);
  const auto parameters = static_cast<Index>(plant.faults.size());
  twin.unknowns = plant.unknowns;
  twin.faults =
      FaultsOf(machine, parameters + static_cast<Index>(plant.rubbing.size()));
  twin.twin = std::make_unique<PlantTwin>(machine, std::move(plant), gain, kBlock);
  return twin;
}

std::unique_ptr<TwinEstimator> MakeTwinEstimator(const Machine& machine, bool linear) {
  const bool nothing =
      FaultParameters(machine.plant()).empty() && machine.setup().disturbances.empty();
  if (nothing || !(ReadingNoise(machine.channels()).minCoeff() > 0.0)) return nullptr;
  return std::make_unique<TwinEstimator>(MakeTwin(machine, linear),
                                         PredictionErrorOptions{});
}

}  // namespace mjdiag
