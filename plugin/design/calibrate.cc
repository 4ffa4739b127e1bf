#include "mjdiag/plugin/design/calibrate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mjdiag/diagnosis/twin/information.h"
#include "mjdiag/diagnosis/twin/model_uncertainty.h"
#include "mjdiag/diagnosis/twin/run_pass.h"
#include "mjdiag/plugin/design/machine_twin.h"
#include "mjdiag/plugin/design/number_learner.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/noise_level.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Of a noise that is given: less is none.
constexpr double kLeastNoise = 1e-3;
/// Of squares of innovations: twice what healthy runs have shown.
constexpr double kMargin = 4.0;
/// A number is not that far from where it was known to be, in standard deviations.
constexpr double kDoubtful = 4.0;

RunSamples SamplesOf(const Machine& machine, const Record& record) {
  if (std::abs(record.sample_time() / machine.rates().tick() - 1.0) > 1e-6) {
    throw InputError(
        "record", "sampled every " + std::to_string(record.sample_time()) + " s",
        "the control tick, " + std::to_string(machine.rates().tick()) + " s");
  }
  const std::vector<std::string> sensors = ChannelsOf(machine.channels().sensors);
  RunSamples samples{
      mjdiag::SamplesOf(record, sensors),
      mjdiag::SamplesOf(record, ChannelsOf(machine.channels().actuators))};
  const Eigen::ArrayXX<bool> measured = MeasuredOf(record, sensors);
  if (measured.size() > 0) {
    samples.outputs = measured.select(samples.outputs.array(),
                                      std::numeric_limits<double>::quiet_NaN());
  }
  return samples;
}

/// Of sensors that the setup gives none: from readings alone, which move little from
/// one to the next.
VectorXd FirstNoise(const Machine& machine, const std::vector<RunSamples>& runs) {
  const auto& sensors = machine.channels().sensors;
  VectorXd noise(static_cast<Index>(sensors.size()));
  for (Index i = 0; i < noise.size(); ++i) {
    const SensorSetup& sensor = sensors[static_cast<std::size_t>(i)];
    noise[i] = sensor.noise_sd;
    if (noise[i] > 0.0) continue;
    for (const RunSamples& run : runs) {
      noise[i] = std::max(noise[i], NoiseLevel(MeasuredReadings(run.outputs, i), 3));
    }
    // A coarse reading does not show noise below its step.
    noise[i] = std::max(noise[i], sensor.resolution / std::sqrt(12.0));
    if (!(noise[i] > 0.0)) {
      const VectorXd readings = MeasuredReadings(runs.front().outputs, i);
      const double range = (readings.array() - readings[0]).abs().maxCoeff();
      noise[i] = std::max(1e-6 * range, 1e-12);
    }
  }
  return noise;
}

/// By what a diagnosis would say of parts of the runs.
/// @param certain  whether the model is certainly not the machine
ModelUncertainty ModelUncertaintyOf(const Machine& calibrated,
                                    const std::vector<RunSamples>& runs, bool linear,
                                    bool certain) {
  std::vector<std::vector<PartInformation>> parts(runs.size());
  const MachineTwin like = MakeTwin(calibrated, linear);
  const Index n = like.twin->unknowns() - like.twin->start_unknowns();
  std::vector<Unknown> unknowns(like.unknowns.begin(), like.unknowns.begin() + n);
  std::vector<Index> faults;
  ModelUncertainty uncertainty;
  std::vector<std::string> names;
  for (const TwinFault& fault : like.faults) {
    for (Index i = 0; i < std::max<Index>(1, 2 * fault.tones()); ++i) {
      faults.push_back(fault.first + i);
      names.push_back(unknowns[static_cast<std::size_t>(fault.first + i)].name);
    }
  }
  if (faults.empty()) return uncertainty;
  double duration = 0.0;
  for (const RunSamples& run : runs) {
    duration += static_cast<double>(run.outputs.cols()) * like.sample_time;
  }
  ParallelFor(static_cast<int>(runs.size()), [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    MachineTwin twin = MakeTwin(calibrated, linear);
    RunPass pass(std::move(twin.twin), runs[at].outputs, runs[at].inputs,
                 PriorOf(twin.unknowns));
    // The first says where the run began.
    pass.About(VectorXd::Zero(n), 0);
    parts[at] = pass.About(VectorXd::Zero(n), 0).parts;
  });
  uncertainty = ScatterOfParts(parts, CovarianceOf(PriorOf(unknowns)), faults, certain);
  uncertainty.unknowns = std::move(names);
  uncertainty.duration = duration;
  uncertainty.runs = static_cast<int>(runs.size());
  return uncertainty;
}

}  // namespace

CalibrationReport Calibrate(const Machine& machine, const std::vector<Record>& records,
                            const CalibrateOptions& options) {
  std::vector<RunSamples> runs;
  for (const Record& record : records) runs.push_back(SamplesOf(machine, record));
  if (runs.empty()) throw InputError("calibration", "no record", "one or more");
  const UncertaintyOptions uncertain_numbers{
      .faults = false, .doubt = true, .friction = !options.linear};
  const UncertainMachine uncertain = MakeUncertainMachine(machine, uncertain_numbers);
  if (uncertain.known == 0) {
    throw InputError("calibration of '" + machine.setup().name + "'",
                     "its plant has no number that may be unknown",
                     "masses, springs, dampers, friction or motors");
  }
  const auto progress = [&](double part) {
    if (options.progress) options.progress(part);
  };
  VectorXd noise = FirstNoise(machine, runs);
  // The machine is linearised anew about where it rests with what is learned.
  const auto about = [&](const VectorXd& theta) {
    return NumberLearner(machine, noise, runs, options.linear, uncertain_numbers,
                         theta);
  };
  // Noise first, with the stiffest gain, which explains nearly anything: slow errors of
  // the model leave changes from tick to tick as they are.
  NumberLearner learner = about(VectorXd::Zero(uncertain.known));
  learner.Learn(learner.stiffest(), true);
  noise = learner.Noise().cwiseMax(kLeastNoise * noise);
  progress(0.2);
  learner = about(learner.theta());
  learner.Learn(learner.stiffest(), true);
  if (!std::isfinite(learner.Excess())) {
    throw NumericalError("calibration: the twin of the machine diverges");
  }
  const bool inflated = !learner.Explains();
  if (inflated) {
    // What not even that explains counts as noise.
    noise *= std::sqrt(learner.Nis());
    learner = about(learner.theta());
    learner.Learn(learner.stiffest(), true);
  }
  double excess = std::max(1.0, learner.Excess());
  progress(0.4);
  const auto stiffest = static_cast<double>(learner.stiffest());
  SoftestLearner softest =
      LearnSoftest(std::move(learner), about, excess, [&](std::size_t gain, int) {
        constexpr double kLeft = 0.4;  // of the work, when it begins
        progress(0.8 - kLeft * static_cast<double>(gain) / stiffest);
        return true;
      });
  learner = std::move(softest.learner);
  const std::size_t gain = softest.gain;
  if (!inflated) noise = noise.cwiseMin(learner.Noise());
  learner = about(learner.theta());
  learner.Learn(gain, false);
  if (inflated) {
    noise *= std::sqrt(learner.Nis());
    learner = about(learner.theta());
    learner.Learn(gain, false);
  }
  const bool exact = !inflated && gain == 0;
  excess = learner.Excess();

  CalibrationReport report;
  Calibration& calibration = report.calibration;
  const VectorXd theta = learner.theta();
  calibration.factors = theta.array().exp();
  calibration.root = learner.Root();
  calibration.sensor_noise = noise;
  calibration.force_noise =
      gain == 0 ? 0.0 : kTwinBandwidths[gain - 1] * machine.rates().control;
  calibration.tolerated = exact ? 1.0 : std::max(1.0, kMargin * excess);
  calibration.records = static_cast<int>(records.size());
  report.prior_sd.resize(theta.size());
  for (Index i = 0; i < theta.size(); ++i) {
    const Unknown& unknown = learner.unknowns()[static_cast<std::size_t>(i)];
    calibration.numbers.push_back(unknown.name);
    report.prior_sd[i] = unknown.prior_sd;
    if (std::abs(theta[i]) > kDoubtful * unknown.prior_sd) {
      report.doubts.push_back(unknown.name);
    }
  }
  for (const RunInformation& said : learner.said()) {
    report.records.push_back({said.nis});
  }
  progress(0.9);
  calibration.model = ModelUncertaintyOf(CalibratedMachine(machine, calibration), runs,
                                         options.linear, !exact);
  progress(1.0);
  return report;
}

Machine CalibratedMachine(const Machine& machine, const Calibration& calibration) {
  NumberFactors factors;
  for (std::size_t i = 0; i < calibration.numbers.size(); ++i) {
    factors.emplace_back(FindModelParameter(machine.plant(), calibration.numbers[i]),
                         calibration.factors[static_cast<Index>(i)]);
  }
  const Machine with =
      machine.WithNumbers(factors).WithSensorNoise(calibration.sensor_noise);
  Setup setup = with.setup();
  setup.calibration = calibration;
  return with.WithSetup(std::move(setup));
}

DiagnosisDesign CalibratedFilters(const Machine& calibrated,
                                  const std::vector<Record>& records,
                                  const NominalRuns& runs) {
  DiagnosisDesign design = DesignFilters(calibrated);
  design.linear = runs.linear;
  design.limits = LimitsOfRecords(design, calibrated, records, runs);
  return design;
}

}  // namespace mjdiag
