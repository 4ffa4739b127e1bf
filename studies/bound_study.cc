#include "mjdiag/studies/bound_study.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/fault_models.h"
#include "mjdiag/plugin/filter_design.h"
#include "mjdiag/plugin/linearize.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd Commands(const Setup& setup, const Record& record) {
  MatrixXd commands(static_cast<Index>(setup.actuators.size()), record.samples());
  for (std::size_t i = 0; i < setup.actuators.size(); ++i) {
    commands.row(static_cast<Index>(i)) = record.At(setup.actuators[i].channel).samples;
  }
  return commands;
}

std::vector<std::string> FaultNames(const Setup& setup, const mjModel& plant) {
  std::vector<std::string> names;
  for (const Fault& knob : HealthyKnobs(plant)) names.push_back(knob.name);
  for (const MultisineSetup& source : setup.disturbances) names.push_back(source.name);
  return names;
}

/// Standard deviations that the estimator claims for a healthy run.
VectorXd EstimatorSd(Setup setup, const mjModel& plant, const Record& record,
                     int rows) {
  setup.diagnosis.estimation_rows = rows;
  const DiagnosisDesign design = DesignFilters(setup, plant);
  DiagnosisMonitor monitor(design);
  Run(monitor, record);
  return monitor.estimator().Estimate().covariance.diagonal().cwiseSqrt();
}

}  // namespace

InformationBound FaultBound(const Setup& setup, const mjModel& plant,
                            const Excitation& motion) {
  const MechanicalModel healthy = Linearize(plant, setup);
  const SynthesisOptions options = SynthesisOf(setup, healthy);
  RunOptions quiet;
  quiet.noise_scale = 0.0;
  const MatrixXd commands =
      Commands(setup, SimulateLinear(setup, plant, motion, quiet));
  std::vector<MatrixXd> sensitivities =
      OutputSensitivities(TurnModels(plant, setup), options.timing, commands);
  const std::vector<Multisine> sources = Multisines(setup);
  MatrixXd waveforms(commands.rows(), static_cast<Index>(sources.size()));
  for (std::size_t i = 0; i < sources.size(); ++i) {
    MatrixXd waveform(commands.rows(), commands.cols());
    for (Index k = 0; k < commands.cols(); ++k) {
      Waveforms(sources, static_cast<double>(k) * setup.sample_time(), waveforms);
      waveform.col(k) = waveforms.col(static_cast<Index>(i));
    }
    sensitivities.push_back(OutputResponse(healthy, options.timing, waveform));
  }
  return CramerRaoBound(sensitivities, options.sensor_noise);
}

std::ptrdiff_t BoundIndex(const Setup& setup, const mjModel& plant,
                          const std::string& fault) {
  const std::vector<std::string> names = FaultNames(setup, plant);
  const auto found = std::find(names.begin(), names.end(), fault);
  if (found == names.end()) {
    std::string known;
    for (const auto& name : names) known += (known.empty() ? "" : ", ") + name;
    throw InputError("study", "there is no fault '" + fault + "'", "one of " + known);
  }
  return found - names.begin();
}

std::vector<StudyTable> BoundStudy(const Setup& setup, const mjModel& plant,
                                   const StudyOptions& options) {
  const Excitation motion = DefaultMotion(setup);
  const InformationBound bound = FaultBound(setup, plant, motion);
  RunOptions run;
  run.seed = options.seed;
  const Record record = SimulateLinear(setup, plant, motion, run);
  const VectorXd one = EstimatorSd(setup, plant, record, 1);
  const VectorXd all = EstimatorSd(setup, plant, record, 0);
  StudyTable table{
      "Information bound of trajectory " + setup.default_trajectory,
      {"fault", "bound alone", "bound together", "sd, one row", "times bound",
       "sd, all rows", "times bound"},
      {},
      {"Standard deviations of the knob's deviation from healthy; linear "
       "plant, known commands, sensor noise of the setup, start at rest."}};
  const std::vector<std::string> names = FaultNames(setup, plant);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto at = static_cast<Index>(i);
    table.rows.push_back({names[i], bound.alone[at], bound.together[at], one[at],
                          one[at] / bound.together[at], all[at],
                          all[at] / bound.together[at]});
  }
  return {table};
}

}  // namespace mjdiag
