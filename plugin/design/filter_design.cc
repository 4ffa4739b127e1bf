#include "mjdiag/plugin/design/filter_design.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "mjdiag/diagnosis/residuals/parity_choice.h"
#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/design/monitor_observer.h"
#include "mjdiag/plugin/plant/start_state.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/butterworth.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/listed.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRandomRun = 2.0;  // s of excitation without a controller

/// Unit generalised forces on the joints that the setup names.
MatrixXd UnknownForces(const Setup& setup, const MechanicalModel& model) {
  const auto& names = setup.diagnosis.unknown_forces;
  MatrixXd forces = MatrixXd::Zero(model.M.rows(), static_cast<Index>(names.size()));
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto& joints = model.coordinates;
    const auto found = std::find(joints.begin(), joints.end(), names[i]);
    if (found == joints.end()) {
      throw InputError("setup '" + setup.name + "': diagnosis.unknown_forces",
                       "there is no joint '" + names[i] + "'",
                       "one of " + Listed(joints));
    }
    forces(found - joints.begin(), static_cast<Index>(i)) = 1.0;
  }
  return forces;
}

/// White noise of a unit on every actuator: any input that excites all modes serves to
/// compare parity relations, and its size does not matter on the linear plant.
Excitation RandomInputs(const Setup& setup) {
  Excitation excitation;
  excitation.inputs = Record(setup.rates.tick());
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal;
  const auto samples = static_cast<Index>(kRandomRun * setup.rates.control);
  for (const ActuatorSetup& actuator : setup.channels.actuators) {
    const VectorXd values =
        VectorXd::NullaryExpr(samples, [&](Index) { return normal(generator); });
    excitation.inputs.Add({actuator.channel, actuator.unit, values});
  }
  return excitation;
}

/// What excites every part of the machine.
Excitation DefaultExcitation(const Setup& setup) {
  return setup.control.axes.empty() ? RandomInputs(setup) : DefaultMotion(setup);
}

/// Energies of the residuals under unit white noise on the commands, for plants without
/// fault parameters or disturbances.
MatrixXd CommandEnergy(const FilterBank& bank, Index outputs) {
  VectorXd noise = VectorXd::Ones(bank.inputs());
  noise.head(outputs).setZero();
  return OutputCovariance(bank, noise);
}

/// The parity relation in which every tone of the disturbances stands out best from the
/// noise at its own frequency, for that is where a spectrum looks for it.
VectorXd RelationForTones(const FilterBank& bank, const VectorXd& sensor_noise,
                          const std::vector<Multisine>& sources) {
  const Index ny = sensor_noise.size();
  std::vector<MatrixXd> tones;
  std::vector<MatrixXd> noises;
  for (const Multisine& source : sources) {
    for (const double frequency : source.frequencies) {
      const Eigen::MatrixXcd response = FrequencyResponse(bank, frequency);
      const Eigen::VectorXcd tone =
          response.rightCols(bank.inputs() - ny) * source.amplitude;
      const Eigen::MatrixXcd noise = response.leftCols(ny) * sensor_noise.asDiagonal();
      tones.emplace_back((tone * tone.adjoint()).real());
      noises.emplace_back((noise * noise.adjoint()).real());
    }
  }
  if (!tones.empty() && sensor_noise.minCoeff() > 0.0) {
    return BestRatioRelation(tones, noises);
  }
  return MostSensitiveRelation({CommandEnergy(bank, ny)});
}

DisturbanceFilter DesignDisturbanceFilter(const Machine& machine,
                                          const std::vector<PerturbedModels>& perturbed,
                                          const std::vector<Multisine>& disturbances) {
  const DiagnosisOptions& wanted = machine.setup().diagnosis;
  SynthesisOptions options = SynthesisOf(machine);
  options.residual.denominator = wanted.disturbance_denominator;
  const ResidualSpace space = MakeResidualSpace(machine.linear(), options);
  const FilterBank all = MakeFilterBank(space.relations, options.residual.denominator,
                                        options.timing.tick());
  const VectorXd relation = RelationForTones(all, options.sensor_noise, disturbances);
  const ResidualBank bank =
      SynthesiseBank(space, relation.transpose(), perturbed, options);
  return {Outputs(bank.filters, 0, 1),
          Outputs(bank.filters, 1, static_cast<Index>(perturbed.size())),
          DigitalButterworth(FilterKind::kHighPass, wanted.high_pass_order,
                             wanted.high_pass_cutoff, options.timing.tick())};
}

int Decimation(const Setup& setup) {
  const double ticks = setup.diagnosis.sampling * setup.rates.control;
  const auto decimation = static_cast<int>(std::lround(ticks));
  if (decimation < 1 || std::abs(ticks - decimation) > 1e-6 * ticks) {
    throw InputError("setup '" + setup.name + "': diagnosis.estimation.sampling",
                     std::to_string(setup.diagnosis.sampling) + " s",
                     "a multiple of the control tick");
  }
  return decimation;
}

/// Parity relations of too high a degree under too low a cut-off lose their digits:
/// they then leave a residual on the very machine they are made for.
void RequireBlindness(const DiagnosisDesign& design, const MatrixXd& healthy_run) {
  constexpr double kLeak = 0.3;  // of the noise of the residual
  const MatrixXd residuals =
      FilterSignals(design.bank.filters, healthy_run).topRows(design.bank.residuals);
  const double leak = residuals.cwiseAbs().maxCoeff();
  if (leak > kLeak) {
    throw NumericalError("parity relations of degree " +
                         std::to_string(design.options.residual.degree) + " at " +
                         std::to_string(design.options.residual.denominator.cutoff) +
                         " Hz lose their digits: a healthy run without noise leaves " +
                         std::to_string(leak) +
                         " times the noise; a lower degree or a higher cut-off "
                         "helps");
  }
}

/// What a nominal run leaves.
struct NominalLog {
  MonitorLog log;
  VectorXd estimate;
  MatrixXd residuals;
};

NominalLog RunNominal(const DiagnosisDesign& design, const Machine& machine,
                      const Excitation& excitation, const MatrixXd& baseline,
                      std::uint64_t seed, bool linear) {
  DiagnosisRecording recording(design, excitation.samples(), baseline);
  MonitorObserver observer(recording);
  RunOptions options;
  options.seed = seed;
  RunWith(machine, excitation, observer, options, linear);
  return {recording.recorder.Log(), recording.monitor.estimate(),
          recording.recorder.Residuals()};
}

/// One of the plants that the calibration does not tell apart.
Machine DrawnPlant(const Machine& machine, std::uint64_t seed) {
  const auto& calibration = machine.setup().calibration;
  if (!calibration || calibration->numbers.empty()) return machine;
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> drawn;
  VectorXd normal(static_cast<Index>(calibration->numbers.size()));
  for (double& value : normal) value = drawn(generator);
  const VectorXd moved = calibration->root * normal;
  NumberFactors factors;
  for (Index i = 0; i < moved.size(); ++i) {
    factors.emplace_back(
        FindModelParameter(machine.plant(),
                           calibration->numbers[static_cast<std::size_t>(i)]),
        std::exp(moved[i]));
  }
  return machine.WithNumbers(factors);
}

/// Runs of one motion that differ in their noise.
std::vector<NominalLog> RunMany(const DiagnosisDesign& design, const Machine& machine,
                                const Excitation& excitation, const MatrixXd& baseline,
                                const NominalRuns& options) {
  std::vector<NominalLog> logs(static_cast<std::size_t>(options.runs));
  ParallelFor(
      options.runs,
      [&](int i) {
        logs[static_cast<std::size_t>(i)] =
            RunNominal(design, machine, excitation, baseline,
                       options.seed + static_cast<std::uint64_t>(i), options.linear);
      },
      options.progress);
  return logs;
}

/// Where the next value of a normal distribution lies, but for this probability, of
/// which these were drawn: mean -+ t s sqrt(1 + 1/n).
Interval PredictionInterval(const VectorXd& values) {
  const auto n = static_cast<double>(values.size());
  const double mean = values.mean();
  const double variance = (values.array() - mean).square().sum() / (n - 1.0);
  const double reach = StudentQuantile(0.5 * kOutsideLimits, n - 1.0) *
                       std::sqrt(variance * (1.0 + 1.0 / n));
  return {mean - reach, mean + reach};
}

/// The limits that these runs, all healthy, call for. Estimates are judged from those
/// of `repeated` only, which are all of one motion.
DiagnosisLimits LimitsOf(const DiagnosisDesign& design,
                         const std::vector<NominalLog>& repeated,
                         const std::vector<NominalLog>& others, bool linear) {
  const DiagnosisOptions& options = design.options;
  std::vector<VectorXd> residuals;
  std::vector<VectorXd> disturbances;
  double integral = 0.0;
  for (const auto* logs : {&repeated, &others}) {
    for (const NominalLog& nominal : *logs) {
      residuals.push_back(nominal.log.residual);
      integral = std::max(integral, nominal.log.integral.maxCoeff());
    }
  }
  disturbances.reserve(repeated.size());
  for (const NominalLog& nominal : repeated) {
    disturbances.push_back(nominal.log.disturbance);
  }
  DiagnosisLimits limits;
  limits.residual =
      options.false_alarms > 0.0
          ? ThresholdsByFalseAlarms(residuals, options.false_alarms,
                                    static_cast<double>(repeated[0].residuals.cols()))
          : ThresholdsByMargin(residuals, options.margin);
  limits.integral = limits.residual.alpha * integral;
  limits.disturbance = DesignDisturbanceThresholds(disturbances, design.sample_time(),
                                                   options.disturbance);
  // On the linear plant the noise explains what estimates do; on the nonlinear one
  // friction does, too.
  for (Index i = 0; i < design.faults() && !linear; ++i) {
    VectorXd values(static_cast<Index>(repeated.size()));
    for (Index k = 0; k < values.size(); ++k) {
      values[k] = repeated[static_cast<std::size_t>(k)].estimate[i];
    }
    limits.estimates.push_back(PredictionInterval(values));
  }
  limits.known = true;
  return limits;
}

}  // namespace

SynthesisOptions SynthesisOf(const Machine& machine) {
  const Setup& setup = machine.setup();
  SynthesisOptions options;
  options.timing = {setup.rates.step(), setup.rates.substeps};
  options.residual = setup.diagnosis.residual;
  options.sensor_noise.resize(static_cast<Index>(setup.channels.sensors.size()));
  for (std::size_t i = 0; i < setup.channels.sensors.size(); ++i) {
    options.sensor_noise[static_cast<Index>(i)] = setup.channels.sensors[i].noise_sd;
  }
  options.unknown_inputs.forces = UnknownForces(setup, machine.linear());
  return options;
}

MatrixXd Signals(const DiagnosisDesign& design, const Record& record) {
  std::vector<std::string> names = design.outputs;
  names.insert(names.end(), design.inputs.begin(), design.inputs.end());
  MatrixXd signals = SamplesOf(record, names);
  signals.topRows(design.offset.size()).colwise() -= design.offset;
  return signals;
}

Record LinearRun(const Machine& machine) {
  return LinearRun(machine, DefaultExcitation(machine.setup()));
}

Record LinearRun(const Machine& machine, const Excitation& motion) {
  RunOptions options;
  options.noise_scale = 0.0;
  options.linear_part = true;
  return SimulateLinear(machine, motion, options);
}

DiagnosisDesign DesignFilters(const Machine& machine,
                              const ResidualSettings& settings) {
  const MechanicalModel& healthy = machine.linear();
  const FaultFamily family = MakeFaultFamily(machine);
  const std::vector<PerturbedModels> perturbed = family.Perturbed();
  SynthesisOptions options = SynthesisOf(machine);
  options.residual = settings.residual;
  DiagnosisDesign design;
  design.setup = machine.setup().name;
  design.outputs = healthy.outputs;
  design.inputs = healthy.inputs;
  design.offset = SensorReadings(machine.channels(), machine.plant(), machine.rest());
  design.sensor_noise = options.sensor_noise;
  design.options = machine.setup().diagnosis;
  design.options.residual = settings.residual;
  design.options.estimation_residuals = settings.count;
  design.decimation = Decimation(machine.setup());
  design.disturbances = family.disturbances;
  design.disturbance = DesignDisturbanceFilter(machine, perturbed, family.disturbances);

  const ResidualSpace space = MakeResidualSpace(healthy, options);
  const Index size = space.relations.front().rows();
  design.bank =
      SynthesiseBank(space, MatrixXd::Identity(size, size), perturbed, options);
  const MatrixXd signals = Signals(design, LinearRun(machine));
  RequireBlindness(design, signals);
  std::vector<MatrixXd> energies = FaultEnergies(design.bank, signals);
  if (energies.empty()) {
    energies.push_back(CommandEnergy(design.bank.filters, healthy.b.cols()));
  }
  design.bank =
      Mix(design.bank, CompleteBasis(MostSensitiveRelation(energies), settings.count));
  return design;
}

DiagnosisDesign DesignFilters(const Machine& machine) {
  const DiagnosisOptions& wanted = machine.setup().diagnosis;
  return DesignFilters(machine, {wanted.residual, wanted.estimation_residuals});
}

DiagnosisLimits CalibrateLimits(const DiagnosisDesign& design, const Machine& machine,
                                const NominalRuns& options) {
  std::vector<NominalLog> others;
  for (const std::string& name : machine.setup().diagnosis.trajectories) {
    NominalRuns single = options;
    single.runs = 1;
    single.progress = nullptr;
    const Excitation excitation =
        FollowTrajectory(machine.setup(), machine.setup().trajectories.Find(name));
    others.push_back(RunMany(design, machine, excitation, {}, single).front());
  }
  const auto repeated =
      RunMany(design, machine, DefaultExcitation(machine.setup()), {}, options);
  return LimitsOf(design, repeated, others, options.linear);
}

DiagnosisLimits CalibrateLimits(const DiagnosisDesign& design, const Machine& machine,
                                const Excitation& excitation, const MatrixXd& baseline,
                                const NominalRuns& options) {
  return LimitsOf(design, RunMany(design, machine, excitation, baseline, options), {},
                  options.linear);
}

DiagnosisLimits LimitsOfRecords(const DiagnosisDesign& design, const Machine& machine,
                                const std::vector<Record>& records,
                                const NominalRuns& options) {
  std::vector<NominalLog> logs(static_cast<std::size_t>(options.runs));
  ParallelFor(
      options.runs,
      [&](int i) {
        const auto seed = options.seed + static_cast<std::uint64_t>(i);
        const Record& of = records[static_cast<std::size_t>(i) % records.size()];
        logs[static_cast<std::size_t>(i)] =
            RunNominal(design, DrawnPlant(machine, seed), Replay(machine.setup(), of),
                       {}, seed, options.linear);
      },
      options.progress);
  for (const Record& record : records) {
    const DiagnosisRecording measured = RecordDiagnosis(design, record);
    logs.push_back({measured.recorder.Log(), measured.monitor.estimate(),
                    measured.recorder.Residuals()});
  }
  return LimitsOf(design, logs, {}, options.linear);
}

MatrixXd ResidualBaseline(const DiagnosisDesign& design, const Machine& machine,
                          const Excitation& excitation, const NominalRuns& options) {
  MatrixXd mean;
  for (const NominalLog& nominal : RunMany(design, machine, excitation, {}, options)) {
    mean = mean.size() == 0 ? nominal.residuals : (mean + nominal.residuals).eval();
  }
  return mean / static_cast<double>(options.runs);
}

}  // namespace mjdiag
