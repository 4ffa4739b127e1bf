#include "mjdiag/studies/excitation/motion_information.h"

#include <cmath>
#include <numbers>

#include "mjdiag/diagnosis/residuals/cramer_rao.h"
#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/design/filter_design.h"
#include "mjdiag/plugin/design/machine_twin.h"
#include "mjdiag/plugin/plant/plant_number.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNumberStep = 1e-3;  // of a number of the plant

MatrixXd Commands(const Machine& machine, const Record& run) {
  return SamplesOf(run, ChannelsOf(machine.channels().actuators));
}

/// A tone of a disturbance on the commands, nu x samples.
MatrixXd Waveform(const Multisine& source, double frequency, double phase, double tick,
                  Index samples) {
  const Eigen::ArrayXd angle =
      2.0 * std::numbers::pi * frequency * tick *
          Eigen::ArrayXd::LinSpaced(samples, 0.0, static_cast<double>(samples - 1)) +
      phase;
  return source.amplitude * angle.sin().matrix().transpose();
}

/// Means over the blocks of a twin, times the root of their ticks: the noise of a mean is
/// that of a tick over it.
MatrixXd OfBlocks(const MatrixXd& sensitivity) {
  const Index blocks = sensitivity.cols() / kTwinBlock;
  MatrixXd means(sensitivity.rows(), blocks);
  for (Index i = 0; i < blocks; ++i) {
    means.col(i) = sensitivity.middleCols(i * kTwinBlock, kTwinBlock).rowwise().sum() /
                   std::sqrt(static_cast<double>(kTwinBlock));
  }
  return means;
}

}  // namespace

MotionInformation::MotionInformation(const Machine& machine,
                                     const std::vector<std::string>& numbers)
    : machine_(machine), timing_(SynthesisOf(machine).timing) {
  noise_ = VectorXd(static_cast<Index>(machine.channels().sensors.size()));
  Index at = 0;
  for (const SensorSetup& sensor : machine.channels().sensors) {
    if (!(sensor.noise_sd > 0.0)) {
      throw InputError("sensor '" + sensor.channel + "'",
                       "has no noise, and whatever moves tells everything",
                       "its noise");
    }
    noise_[at++] = sensor.noise_sd;
  }
  models_ = MakeFaultFamily(machine).Perturbed();
  for (const std::string& name : numbers) {
    const PlantNumber number = FindPlantNumber(machine.plant(), name);
    models_.push_back({name, kNumberStep,
                       machine.WithNumbers({{number, 1.0 - kNumberStep}}).linear(),
                       machine.WithNumbers({{number, 1.0 + kNumberStep}}).linear()});
  }
  for (const PerturbedModels& model : models_) names_.push_back(model.name);
  if (names_.empty()) {
    throw InputError("setup '" + machine.setup().name + "'",
                     "its plant declares no fault parameter",
                     "numbers of the plant that are wanted");
  }
}

std::vector<MatrixXd> MotionInformation::Sensitivities(const Record& run) const {
  return OutputSensitivities(models_, timing_, Commands(machine_, run));
}

MatrixXd MotionInformation::Of(const Record& run, Index from, Index count) const {
  const std::vector<MatrixXd> sensitivities = Sensitivities(run);
  const auto unknowns = static_cast<Index>(sensitivities.size());
  MatrixXd stacked(noise_.size() * (count / kTwinBlock), unknowns);
  for (Index i = 0; i < unknowns; ++i) {
    const MatrixXd scaled =
        noise_.cwiseInverse().asDiagonal() *
        OfBlocks(sensitivities[static_cast<std::size_t>(i)].middleCols(from, count));
    stacked.col(i) = scaled.reshaped();
  }
  return stacked.transpose() * stacked;
}

VectorXd MotionInformation::SdOf(const Record& run) const {
  std::vector<MatrixXd> sensitivities = Sensitivities(run);
  const auto unknowns = static_cast<Index>(sensitivities.size());
  for (const Multisine& source : MakeFaultFamily(machine_).disturbances) {
    for (const double frequency : source.frequencies) {
      for (const double phase : {0.0, 0.5 * std::numbers::pi}) {
        sensitivities.push_back(OutputResponse(
            machine_.linear(), timing_,
            Waveform(source, frequency, phase, run.sample_time(), run.samples())));
      }
    }
  }
  for (MatrixXd& sensitivity : sensitivities) sensitivity = OfBlocks(sensitivity);
  return CramerRaoBound(sensitivities, noise_).together.head(unknowns);
}

}  // namespace mjdiag
