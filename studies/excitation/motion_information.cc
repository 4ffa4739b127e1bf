#include "mjdiag/studies/excitation/motion_information.h"

#include <numbers>

#include "mjdiag/diagnosis/residuals/cramer_rao.h"
#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/design/filter_design.h"
#include "mjdiag/plugin/plant/model_parameter.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNumberStep = 1e-3;  // of a number of the plant

}  // namespace

MotionInformation::MotionInformation(const Machine& machine,
                                     const std::vector<std::string>& numbers,
                                     Index ticks)
    : inputs_(ChannelsOf(machine.channels().actuators)),
      timing_(SynthesisOf(machine).timing),
      noise_(SynthesisOf(machine).sensor_noise) {
  const FaultFamily family = MakeFaultFamily(machine);
  models_ = family.Perturbed();
  for (const std::string& name : numbers) {
    const ModelParameter number = FindModelParameter(machine.plant(), name);
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
  for (const Multisine& source : family.disturbances) {
    for (const double frequency : source.frequencies) {
      for (const double phase : {0.0, 0.5 * std::numbers::pi}) {
        const MatrixXd tone =
            ToneOf(source, frequency, phase, machine.rates().tick(), ticks);
        disturbances_.push_back(OutputResponse(machine.linear(), timing_, tone));
      }
    }
  }
}

std::vector<MatrixXd> MotionInformation::Sensitivities(const Record& run, Index from,
                                                       Index count) const {
  std::vector<MatrixXd> sensitivities =
      OutputSensitivities(models_, timing_, SamplesOf(run, inputs_));
  for (MatrixXd& one : sensitivities) one = one.middleCols(from, count).eval();
  return sensitivities;
}

MatrixXd MotionInformation::Of(const Record& run, Index from, Index count) const {
  const std::vector<MatrixXd> sensitivities = Sensitivities(run, from, count);
  const auto unknowns = static_cast<Index>(sensitivities.size());
  MatrixXd stacked(sensitivities.front().size(), unknowns);
  for (Index i = 0; i < unknowns; ++i) {
    const MatrixXd scaled =
        noise_.cwiseInverse().asDiagonal() * sensitivities[static_cast<std::size_t>(i)];
    stacked.col(i) = scaled.reshaped();
  }
  return stacked.transpose() * stacked;
}

VectorXd MotionInformation::SdOf(const Record& run) const {
  std::vector<MatrixXd> sensitivities = Sensitivities(run, 0, run.samples());
  const auto unknowns = static_cast<Index>(sensitivities.size());
  sensitivities.insert(sensitivities.end(), disturbances_.begin(), disturbances_.end());
  return CramerRaoBound(sensitivities, noise_).together.head(unknowns);
}

}  // namespace mjdiag
