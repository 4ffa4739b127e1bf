#include "mjdiag/studies/bound_study.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/design/filter_design.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/listed.h"
#include "mjdiag/studies/answer.h"
#include "mjdiag/studies/plan/run_machine.h"

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

enum class Wave { kSine, kCosine };

/// What the readings of a machine with faults answer to, in a run without noise whose
/// commands are known.
class Responses {
 public:
  /// @param deviations  of fault parameters, then of disturbances
  Responses(const Machine& machine, const Excitation& motion,
            const VectorXd& deviations)
      : family_(MakeFaultFamily(machine)), synthesis_(SynthesisOf(machine)) {
    const auto parameters = static_cast<Index>(family_.parameters.size());
    values_ = deviations.head(parameters).array() + 1.0;
    worn_ = family_.model_at(values_);
    Changes faults;
    for (Index i = 0; i < parameters; ++i) {
      faults.faults.push_back(
          {family_.parameters[static_cast<std::size_t>(i)], values_[i]});
    }
    RunOptions quiet;
    quiet.noise_scale = 0.0;
    Index at = parameters;
    for (const Multisine& source : family_.disturbances) {
      quiet.disturbances[source.name] = deviations[at++];
    }
    inputs_ =
        Commands(machine.setup(), SimulateLinear(machine.With(faults), motion, quiet));
    tick_ = machine.rates().tick();
    at = parameters;
    for (const Multisine& source : family_.disturbances) {
      for (const double frequency : source.frequencies) {
        inputs_ += deviations[at] * Tone(source, frequency, Wave::kSine);
      }
      ++at;
    }
  }

  const std::vector<Multisine>& disturbances() const { return family_.disturbances; }
  const VectorXd& sensor_noise() const { return synthesis_.sensor_noise; }

  std::vector<MatrixXd> OfParameters() const {
    return OutputSensitivities(family_.PerturbedAbout(values_), synthesis_.timing,
                               inputs_);
  }
  /// To one tone of a disturbance at a magnitude of 1.
  MatrixXd OfTone(const Multisine& source, double frequency, Wave wave) const {
    return OutputResponse(worn_, synthesis_.timing, Tone(source, frequency, wave));
  }

 private:
  MatrixXd Tone(const Multisine& source, double frequency, Wave wave) const {
    const double lead = wave == Wave::kSine ? 0.0 : 0.5 * std::numbers::pi;
    return ToneOf(source, frequency, lead, tick_, inputs_.cols());
  }

  FaultFamily family_;
  SynthesisOptions synthesis_;
  VectorXd values_;
  MechanicalModel worn_;
  MatrixXd inputs_;  // with what disturbs them
  double tick_ = 0.0;
};

}  // namespace

InformationBound FaultBound(const Machine& machine, const Excitation& motion) {
  const auto count = static_cast<Index>(MakeFaultFamily(machine).Names().size());
  const Responses responses(machine, motion, VectorXd::Zero(count));
  std::vector<MatrixXd> sensitivities = responses.OfParameters();
  for (const Multisine& source : responses.disturbances()) {
    MatrixXd sum = responses.OfTone(source, source.frequencies.front(), Wave::kSine);
    for (std::size_t i = 1; i < source.frequencies.size(); ++i) {
      sum += responses.OfTone(source, source.frequencies[i], Wave::kSine);
    }
    sensitivities.push_back(std::move(sum));
  }
  return CramerRaoBound(sensitivities, responses.sensor_noise());
}

VectorXd FaultBoundAt(const Machine& machine, const Excitation& motion,
                      const VectorXd& deviations) {
  const Responses responses(machine, motion, deviations);
  std::vector<MatrixXd> sensitivities = responses.OfParameters();
  const auto parameters = static_cast<Index>(sensitivities.size());
  for (const Multisine& source : responses.disturbances()) {
    for (const double frequency : source.frequencies) {
      sensitivities.push_back(responses.OfTone(source, frequency, Wave::kSine));
      sensitivities.push_back(responses.OfTone(source, frequency, Wave::kCosine));
    }
  }
  const VectorXd all = CramerRaoBound(sensitivities, responses.sensor_noise()).together;
  VectorXd bound(deviations.size());
  bound.head(parameters) = all.head(parameters);
  Index first = parameters;
  Index at = parameters;
  for (const Multisine& source : responses.disturbances()) {
    const auto parts = static_cast<Index>(2 * source.frequencies.size());
    bound[at++] = MagnitudeBound(all.segment(first, parts));
    first += parts;
  }
  return bound;
}

double MagnitudeBound(const VectorXd& parts) {
  double information = 0.0;
  for (Index i = 0; i < parts.size(); i += 2) {
    information += 2.0 / parts.segment(i, 2).squaredNorm();
  }
  return 1.0 / std::sqrt(information);
}

std::ptrdiff_t BoundIndex(const Machine& machine, const std::string& fault) {
  const std::vector<std::string> names = MakeFaultFamily(machine).Names();
  const auto found = std::find(names.begin(), names.end(), fault);
  if (found == names.end()) {
    throw InputError("study", "there is no fault '" + fault + "'",
                     "one of " + Listed(names));
  }
  return found - names.begin();
}

std::vector<StudyTable> AnswerTo(const AskBound&, const LoadedPlan& loaded,
                                 const StudyOptions&) {
  const Machine& machine = loaded.machine;
  const RunMaker maker(loaded);
  const Excitation& motion = maker.motions().front();
  const InformationBound bound = FaultBound(machine, motion);
  RunOptions run;
  run.seed = loaded.plan.seed;
  const Record record = SimulateLinear(machine, motion, run);
  const VectorXd one = EstimatorSd(machine, record, 1);
  const VectorXd all = EstimatorSd(machine, record, 0);
  StudyTable table{
      "Information bound of trajectory " + loaded.plan.motions.front().name,
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
