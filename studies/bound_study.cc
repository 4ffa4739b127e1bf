#include "mjdiag/studies/bound_study.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/design/filter_design.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd Commands(const Setup& setup, const Record& record) {
  return SamplesOf(record, ChannelsOf(setup.channels.actuators));
}

/// Standard deviations that the estimator claims for a healthy run.
VectorXd EstimatorSd(const Machine& machine, const Record& record, int residuals) {
  Setup setup = machine.setup();
  setup.diagnosis.estimation_residuals = residuals;
  const DiagnosisDesign design = DesignFilters(machine.WithSetup(setup));
  DiagnosisMonitor monitor(design);
  Run(monitor, record);
  return monitor.estimator().Estimate().covariance.diagonal().cwiseSqrt();
}

}  // namespace

InformationBound FaultBound(const Machine& machine, const Excitation& motion) {
  const MechanicalModel& healthy = machine.linear();
  const FaultFamily family = MakeFaultFamily(machine);
  const SynthesisOptions options = SynthesisOf(machine);
  RunOptions quiet;
  quiet.noise_scale = 0.0;
  const MatrixXd commands =
      Commands(machine.setup(), SimulateLinear(machine, motion, quiet));
  std::vector<MatrixXd> sensitivities =
      OutputSensitivities(family.Perturbed(), options.timing, commands);
  const std::vector<Multisine>& sources = family.disturbances;
  MatrixXd waveforms(commands.rows(), static_cast<Index>(sources.size()));
  for (std::size_t i = 0; i < sources.size(); ++i) {
    MatrixXd waveform(commands.rows(), commands.cols());
    for (Index k = 0; k < commands.cols(); ++k) {
      Waveforms(sources, static_cast<double>(k) * machine.rates().tick(), waveforms);
      waveform.col(k) = waveforms.col(static_cast<Index>(i));
    }
    sensitivities.push_back(OutputResponse(healthy, options.timing, waveform));
  }
  return CramerRaoBound(sensitivities, options.sensor_noise);
}

VectorXd FaultBoundAt(const Machine& machine, const Excitation& motion,
                      const VectorXd& deviations) {
  const FaultFamily family = MakeFaultFamily(machine);
  const SynthesisOptions options = SynthesisOf(machine);
  const auto parameters = static_cast<Index>(family.parameters.size());
  const VectorXd values = deviations.head(parameters).array() + 1.0;
  Changes faults;
  for (Index i = 0; i < parameters; ++i) {
    faults.faults.push_back(
        {family.parameters[static_cast<std::size_t>(i)], values[i]});
  }
  RunOptions quiet;
  quiet.noise_scale = 0.0;
  for (std::size_t i = 0; i < family.disturbances.size(); ++i) {
    quiet.disturbances[family.disturbances[i].name] =
        deviations[parameters + static_cast<Index>(i)];
  }
  MatrixXd inputs =
      Commands(machine.setup(), SimulateLinear(machine.With(faults), motion, quiet));
  const auto angle = [&](double frequency) {
    return (2.0 * std::numbers::pi * frequency * machine.rates().tick() *
            Eigen::ArrayXd::LinSpaced(inputs.cols(), 0.0,
                                      static_cast<double>(inputs.cols() - 1)))
        .eval();
  };
  for (std::size_t i = 0; i < family.disturbances.size(); ++i) {
    const Multisine& source = family.disturbances[i];
    for (const double frequency : source.frequencies) {
      inputs += deviations[parameters + static_cast<Index>(i)] * source.amplitude *
                angle(frequency).sin().matrix().transpose();
    }
  }
  std::vector<MatrixXd> sensitivities =
      OutputSensitivities(family.PerturbedAbout(values), options.timing, inputs);
  const MechanicalModel worn = family.model_at(values);
  for (const Multisine& source : family.disturbances) {
    for (const double frequency : source.frequencies) {
      const Eigen::ArrayXd phase = angle(frequency);
      for (const Eigen::ArrayXd& wave : {phase.sin().eval(), phase.cos().eval()}) {
        sensitivities.push_back(OutputResponse(
            worn, options.timing, source.amplitude * wave.matrix().transpose()));
      }
    }
  }
  const VectorXd all = CramerRaoBound(sensitivities, options.sensor_noise).together;
  VectorXd bound(deviations.size());
  bound.head(parameters) = all.head(parameters);
  Index tone = parameters;
  for (std::size_t i = 0; i < family.disturbances.size(); ++i) {
    double information = 0.0;
    for (std::size_t f = 0; f < family.disturbances[i].frequencies.size(); ++f) {
      information += 2.0 / all.segment(tone, 2).squaredNorm();
      tone += 2;
    }
    bound[parameters + static_cast<Index>(i)] = 1.0 / std::sqrt(information);
  }
  return bound;
}

std::ptrdiff_t BoundIndex(const Machine& machine, const std::string& fault) {
  const std::vector<std::string> names = MakeFaultFamily(machine).Names();
  const auto found = std::find(names.begin(), names.end(), fault);
  if (found == names.end()) {
    std::string known;
    for (const auto& name : names) known += (known.empty() ? "" : ", ") + name;
    throw InputError("study", "there is no fault '" + fault + "'", "one of " + known);
  }
  return found - names.begin();
}

std::vector<StudyTable> BoundStudy(const Machine& machine,
                                   const StudyOptions& options) {
  const Excitation motion = DefaultMotion(machine.setup());
  const InformationBound bound = FaultBound(machine, motion);
  RunOptions run;
  run.seed = options.seed;
  const Record record = SimulateLinear(machine, motion, run);
  const VectorXd one = EstimatorSd(machine, record, 1);
  const VectorXd all = EstimatorSd(machine, record, 0);
  StudyTable table{
      "Information bound of trajectory " + machine.setup().trajectories.fallback,
      {"fault", "bound alone", "bound together", "sd, one residual", "times bound",
       "sd, all residuals", "times bound"},
      {},
      {"Standard deviations of the deviation from healthy; linear plant, "
       "known commands, sensor noise of the setup, start at rest."}};
  const std::vector<std::string> names = MakeFaultFamily(machine).Names();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto at = static_cast<Index>(i);
    table.rows.push_back({names[i], bound.alone[at], bound.together[at], one[at],
                          one[at] / bound.together[at], all[at],
                          all[at] / bound.together[at]});
  }
  return {table};
}

}  // namespace mjdiag
