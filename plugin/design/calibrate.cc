#include "mjdiag/plugin/design/calibrate.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mjdiag/diagnosis/twin/prediction_error.h"
#include "mjdiag/plugin/design/machine_twin.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// By chance the misfit, a mean of about a hundred squares, is not above it.
constexpr double kExplainedBy = 1.7;
/// A number is not that far from where it was known to be, in standard deviations.
constexpr double kDoubtful = 4.0;

struct Samples {
  MatrixXd outputs;
  MatrixXd inputs;
};

Samples SamplesOf(const Machine& machine, const Record& record) {
  if (std::abs(record.sample_time() / machine.rates().tick() - 1.0) > 1e-6) {
    throw InputError(
        "record", "sampled every " + std::to_string(record.sample_time()) + " s",
        "the control tick, " + std::to_string(machine.rates().tick()) + " s");
  }
  return {mjdiag::SamplesOf(record, ChannelsOf(machine.channels().sensors)),
          mjdiag::SamplesOf(record, ChannelsOf(machine.channels().actuators))};
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Of a signal whose n-th difference is noise, of which the squared weights sum up to
/// `squares`.
double NoiseOf(VectorXd signal, int differences, double squares) {
  constexpr double kNormal = 1.4826;  // sd of a normal distribution over its median |.|
  for (int i = 0; i < differences; ++i) {
    signal = (signal.tail(signal.size() - 1) - signal.head(signal.size() - 1)).eval();
  }
  const VectorXd size = signal.cwiseAbs();
  return kNormal * Median({size.begin(), size.end()}) / std::sqrt(squares);
}

/// Of sensors that the setup gives none: from readings alone, which move little from
/// one to the next.
VectorXd FirstNoise(const Machine& machine, const std::vector<Samples>& runs) {
  const auto& sensors = machine.channels().sensors;
  VectorXd noise(static_cast<Index>(sensors.size()));
  for (Index i = 0; i < noise.size(); ++i) {
    const SensorSetup& sensor = sensors[static_cast<std::size_t>(i)];
    noise[i] = sensor.noise_sd;
    if (noise[i] > 0.0) continue;
    for (const Samples& run : runs) {
      noise[i] = std::max(noise[i], NoiseOf(run.outputs.row(i), 3, 20.0));
    }
    // A coarse reading does not show noise below its step.
    noise[i] = std::max(noise[i], sensor.resolution / std::sqrt(12.0));
    if (!(noise[i] > 0.0)) {
      const double range =
          (runs.front().outputs.row(i).array() - runs.front().outputs(i, 0))
              .abs()
              .maxCoeff();
      noise[i] = std::max(1e-6 * range, 1e-12);
    }
  }
  return noise;
}

/// Of the innovations of a twin that follows the run.
VectorXd InnovationNoise(Twin& twin, const VectorXd& theta, const Samples& run) {
  const Index ticks = run.outputs.cols();
  MatrixXd innovations(run.outputs.rows(), ticks);
  VectorXd reading(run.outputs.rows());
  VectorXd state(twin.states());
  twin.StateAt(run.outputs.col(0), state);
  twin.UseGain(0);
  twin.Start(theta, state);
  for (Index k = 0; k < ticks; ++k) {
    twin.Predict(reading);
    innovations.col(k) = run.outputs.col(k) - reading;
    twin.Step({run.inputs.col(k).data(), static_cast<std::size_t>(run.inputs.rows())},
              innovations.col(k));
    if ((k + 1) % twin.block() == 0) twin.EndBlock();
  }
  VectorXd noise(innovations.rows());
  for (Index i = 0; i < noise.size(); ++i) {
    noise[i] = NoiseOf(innovations.row(i), 1, 2.0);
  }
  return noise;
}

/// What a whole run says of the numbers about theta, wherever it began: H and g, with
/// the state at the start, on which a linear twin depends linearly, eliminated.
void AddRun(Twin& twin, const VectorXd& theta, const Samples& run, MatrixXd& H,
            VectorXd& g) {
  const Index n = theta.size();
  const Index p = twin.unknowns();
  const Index started = twin.start_unknowns();
  VectorXd all = VectorXd::Zero(p);
  all.head(n) = theta;
  const MatrixXd weight =
      Inverse(twin.gains().front().covariance) * static_cast<double>(twin.block());
  MatrixXd of_all = MatrixXd::Zero(p, p);
  of_all.bottomRightCorner(started, started).setIdentity();
  VectorXd gradient = VectorXd::Zero(p);
  VectorXd reading(run.outputs.rows());
  VectorXd sum = VectorXd::Zero(run.outputs.rows());
  VectorXd state(twin.states());
  twin.StateAt(run.outputs.col(0), state);
  twin.UseGain(0);
  twin.Start(all, state);
  for (Index k = 0; k < run.outputs.cols(); ++k) {
    twin.Predict(reading);
    const VectorXd innovation = run.outputs.col(k) - reading;
    sum += innovation;
    twin.Step({run.inputs.col(k).data(), static_cast<std::size_t>(run.inputs.rows())},
              innovation);
    if ((k + 1) % twin.block() != 0) continue;
    const MatrixXd& psi = twin.EndBlock();
    sum /= static_cast<double>(twin.block());
    of_all += psi.transpose() * weight * psi;
    gradient += psi.transpose() * weight * sum;
    sum.setZero();
  }
  const MatrixXd by_start = Solve(of_all.bottomRightCorner(started, started),
                                  of_all.bottomLeftCorner(started, n))
                                .transpose();
  H += of_all.topLeftCorner(n, n) - by_start * of_all.bottomLeftCorner(started, n);
  g += gradient.head(n) - by_start * gradient.tail(started);
}

struct Learned {
  std::vector<Unknown> unknowns;
  VectorXd theta;       ///< of the numbers
  MatrixXd covariance;  ///< of them
  std::vector<double> misfits;
  VectorXd noise;
};

Learned Learn(const Machine& machine, const std::vector<Samples>& runs,
              const CalibrateOptions& options, double& done, double share) {
  Learned learned;
  learned.noise = VectorXd::Zero(runs.front().outputs.rows());
  for (const Samples& run : runs) {
    MachineTwin twin =
        MakeTwin(machine, options.linear, {.faults = false, .doubt = true});
    const Index n =
        static_cast<Index>(twin.unknowns.size()) - twin.twin->start_unknowns();
    if (learned.theta.size() == 0) {
      learned.theta = VectorXd::Zero(n);
      learned.covariance = twin.prior.topLeftCorner(n, n);
      learned.unknowns.assign(twin.unknowns.begin(), twin.unknowns.begin() + n);
    }
    for (Index i = 0; i < n; ++i) {
      twin.unknowns[static_cast<std::size_t>(i)].nominal = std::exp(learned.theta[i]);
      twin.unknowns[static_cast<std::size_t>(i)].wears = false;
    }
    twin.prior.topLeftCorner(n, n) = learned.covariance;
    Twin& inner = *twin.twin;
    PredictionErrorOptions estimation;
    estimation.kept = std::max(estimation.kept, run.outputs.cols());
    PredictionErrorEstimator estimator(std::move(twin.twin), twin.unknowns, twin.prior,
                                       twin.sample_time, estimation);
    for (Index k = 0; k < run.outputs.cols(); ++k) {
      estimator.Add(
          {run.outputs.col(k).data(), static_cast<std::size_t>(run.outputs.rows())},
          {run.inputs.col(k).data(), static_cast<std::size_t>(run.inputs.rows())});
    }
    estimator.CatchUp();
    const Index active = estimator.active();
    if (active > 0) {
      const MatrixXd H = estimator.H().topLeftCorner(active, active);
      learned.covariance = CovarianceOf(H).topLeftCorner(n, n);
      learned.theta = estimator.theta().head(n);
    }
    learned.misfits.push_back(estimator.surprise());
    VectorXd theta = estimator.theta();
    theta.tail(inner.start_unknowns()).setZero();
    learned.noise +=
        InnovationNoise(inner, theta, run) / static_cast<double>(runs.size());
    done += share / static_cast<double>(runs.size());
    if (options.progress) options.progress(done);
  }
  return learned;
}

/// All runs about one and the same theta: one after the other, each about a point of its
/// own, they would contradict each other along directions that are hardly known. The
/// machine is linearised anew about where it rests with these numbers.
void Refine(const Machine& machine, const std::vector<Samples>& runs,
            Learned& learned) {
  constexpr int kPasses = 4;
  const Index n = learned.theta.size();
  MatrixXd known = MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    known(i, i) = std::pow(learned.unknowns[static_cast<std::size_t>(i)].prior_sd, -2);
  }
  for (int pass = 0; pass < kPasses; ++pass) {
    std::vector<std::pair<PlantNumber, double>> factors;
    for (Index i = 0; i < n; ++i) {
      const Unknown& unknown = learned.unknowns[static_cast<std::size_t>(i)];
      factors.emplace_back(FindPlantNumber(machine.plant(), unknown.name),
                           std::exp(learned.theta[i]));
    }
    const MachineTwin twin =
        MakeTwin(machine.WithNumbers(factors), true, {.faults = false, .doubt = true});
    MatrixXd H = known;
    VectorXd g = -known * learned.theta;
    for (const Samples& run : runs) AddRun(*twin.twin, VectorXd::Zero(n), run, H, g);
    learned.covariance = CovarianceOf(H);
    learned.theta += learned.covariance * g;
  }
}

Machine WithForceNoise(const Machine& machine, const VectorXd& sensor_noise,
                       double force_noise) {
  Setup setup = machine.setup();
  Calibration only;
  only.force_noise = force_noise;
  only.sensor_noise = sensor_noise;
  setup.calibration = only;
  return machine.WithSetup(setup).WithSensorNoise(sensor_noise);
}

}  // namespace

CalibrationReport Calibrate(const Machine& machine, const std::vector<Record>& records,
                            const CalibrateOptions& options) {
  std::vector<Samples> runs;
  for (const Record& record : records) runs.push_back(SamplesOf(machine, record));
  if (runs.empty()) throw InputError("calibration", "no record", "one or more");
  const UncertaintyOptions doubted{
      .faults = false, .doubt = true, .friction = !options.linear};
  const UncertainMachine uncertain = MakeUncertainMachine(machine, doubted);
  if (uncertain.known == 0) {
    throw InputError("calibration of '" + machine.setup().name + "'",
                     "its plant has no number that may be unknown",
                     "masses, springs, dampers, friction or motors");
  }
  VectorXd noise = FirstNoise(machine, runs);
  double done = 0.0;
  Learned learned;
  double force_noise = 0.0;
  std::vector<double> force_noises = {0.0};
  for (const double part : kTwinBandwidths) {
    force_noises.push_back(part * machine.rates().control);
  }
  for (const double tried : force_noises) {
    force_noise = tried;
    // Noise first as it is given, then as it was seen.
    for (int pass = 0; pass < 2; ++pass) {
      learned = Learn(WithForceNoise(machine, noise, force_noise), runs, options, done,
                      0.5 / static_cast<double>(force_noises.size()));
      const bool as_seen =
          ((learned.noise - noise).cwiseAbs().array() < 0.05 * noise.array()).all();
      if (as_seen) break;
      noise = learned.noise.cwiseMax(1e-3 * noise);
    }
    const double worst =
        *std::max_element(learned.misfits.begin(), learned.misfits.end());
    if (worst < kExplainedBy) break;
  }
  if (options.linear) {
    Refine(WithForceNoise(machine, noise, force_noise), runs, learned);
  }
  CalibrationReport report;
  Calibration& calibration = report.calibration;
  calibration.factors = learned.theta.array().exp();
  calibration.covariance = learned.covariance;
  calibration.sensor_noise = noise;
  calibration.force_noise = force_noise;
  calibration.records = static_cast<int>(records.size());
  report.prior_sd.resize(learned.theta.size());
  for (Index i = 0; i < learned.theta.size(); ++i) {
    const Unknown& unknown = learned.unknowns[static_cast<std::size_t>(i)];
    calibration.numbers.push_back(unknown.name);
    report.prior_sd[i] = unknown.prior_sd;
    if (std::abs(learned.theta[i]) > kDoubtful * unknown.prior_sd) {
      report.doubts.push_back(unknown.name);
    }
  }
  for (const double misfit : learned.misfits) {
    report.records.push_back({misfit});
  }
  return report;
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
