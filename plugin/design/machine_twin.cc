#include "mjdiag/plugin/design/machine_twin.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mjdiag/diagnosis/twin/twin_in_coordinates.h"
#include "mjdiag/plugin/replay/observer.h"
#include "mjdiag/plugin/replay/plant_twin.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Noise and the steps of a coarse reading.
VectorXd ReadingNoise(const Channels& channels) {
  VectorXd sd(static_cast<Index>(channels.sensors.size()));
  for (Index i = 0; i < sd.size(); ++i) {
    const SensorSetup& sensor = channels.sensors[static_cast<std::size_t>(i)];
    sd[i] = std::hypot(sensor.noise_sd, sensor.resolution / std::sqrt(12.0));
  }
  return sd;
}

TwinGain GainOf(const Machine& machine, const VectorXd& noise, double bandwidth) {
  // Periods of its bandwidth: what a stiffer one has left is small.
  constexpr double kSettling = 2.0;
  const Observer observer = DesignObserver(machine.linear(), machine.rates().step(),
                                           machine.rates().substeps, noise, bandwidth);
  const auto settling =
      static_cast<Index>(kSettling * machine.rates().control / bandwidth);
  return {observer.L, observer.innovation_covariance, settling, observer.P};
}

std::vector<TwinGain> GainsOf(const Machine& machine, const VectorXd& noise,
                              double force_noise) {
  std::vector<TwinGain> gains;
  if (force_noise > 0.0) {
    gains.push_back(GainOf(machine, noise, force_noise));
  } else {
    gains.push_back({MatrixXd::Zero(2 * machine.linear().M.rows(), noise.size()),
                     noise.cwiseAbs2().asDiagonal(), 0});
  }
  for (const double part : kTwinBandwidths) {
    const double bandwidth = part * machine.rates().control;
    gains.push_back(GainOf(machine, noise, std::max(bandwidth, force_noise)));
  }
  // The stiffest knows nothing of where the machine is.
  constexpr double kForgotten = 1e-6;
  const StateSpace tick =
      TickModel(machine.linear(), machine.rates().step(), machine.rates().substeps);
  const double radius = SpectralRadius(tick.A - gains.back().L * tick.C);
  gains.back().settling =
      static_cast<Index>(std::ceil(std::log(kForgotten) / std::log(radius)));
  return gains;
}

/// A root of a covariance of whatever units.
MatrixXd RootOf(const MatrixXd& covariance) {
  const ScaledEigenPairs modes = ScaledEigenDecomposition(covariance);
  return modes.scale.asDiagonal() * modes.vectors *
         modes.values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

/// Fault parameters are the first unknowns.
/// @param first  of the unknowns of tones
std::vector<TwinFault> FaultsOf(const Machine& machine,
                                const UncertainMachine& uncertain, Index first) {
  std::vector<TwinFault> faults;
  for (Index i = 0; i < uncertain.faults; ++i) {
    faults.push_back({uncertain.unknowns[static_cast<std::size_t>(i)].name, i, {}});
  }
  if (uncertain.tones.empty()) return faults;
  for (const MultisineSetup& source : machine.setup().disturbances) {
    faults.push_back({source.name, first, source.frequencies});
    first += 2 * faults.back().tones();
  }
  return faults;
}

}  // namespace

MachineTwin MakeTwin(const Machine& machine, bool linear, UncertaintyOptions options) {
  const VectorXd noise = ReadingNoise(machine.channels());
  if (!(noise.minCoeff() > 0.0)) {
    throw InputError("twin", "a sensor without noise", "a noise on every sensor");
  }
  options.friction = !linear;
  UncertainMachine uncertain = MakeUncertainMachine(machine, options);
  MachineTwin twin;
  twin.sample_time = machine.rates().tick();
  const auto& calibration = machine.setup().calibration;
  const double force_noise = calibration ? calibration->force_noise : 0.0;
  std::vector<TwinGain> gains = GainsOf(machine, noise, force_noise);
  if (!linear) uncertain.start = RootOf(gains.back().P);
  if (linear) {
    twin.twin = std::make_unique<LinearTwin>(MakeUncertainModel(machine, uncertain),
                                             std::move(gains), kTwinBlock);
  } else {
    twin.twin =
        std::make_unique<PlantTwin>(machine, uncertain, std::move(gains), kTwinBlock);
  }
  if (calibration && !options.doubt) {
    const KnownTogether known = AsCalibrated(machine, uncertain);
    twin.twin = std::make_unique<TwinInCoordinates>(std::move(twin.twin), known.T,
                                                    uncertain.tones);
    twin.unknowns = known.unknowns;
  } else {
    twin.unknowns = uncertain.unknowns;
  }
  twin.faults = FaultsOf(machine, uncertain, twin.twin->first_tone());
  if (calibration) {
    twin.tolerated = calibration->tolerated;
    if (options.faults) twin.model = calibration->model;
  }
  return twin;
}

std::unique_ptr<TwinEstimator> MakeTwinEstimator(const Machine& machine, bool linear) {
  const bool nothing =
      FaultParameters(machine.plant()).empty() && machine.setup().disturbances.empty();
  if (nothing || !(ReadingNoise(machine.channels()).minCoeff() > 0.0)) return nullptr;
  MachineTwin twin = MakeTwin(machine, linear);
  PredictionErrorOptions options;
  options.tolerated = twin.tolerated;
  options.exact = !twin.model.any() && twin.tolerated == 1.0;
  return std::make_unique<TwinEstimator>(std::move(twin), options);
}

}  // namespace mjdiag
