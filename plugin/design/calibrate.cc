#include "mjdiag/plugin/design/calibrate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/diagnosis/twin/information.h"
#include "mjdiag/diagnosis/twin/model_uncertainty.h"
#include "mjdiag/diagnosis/twin/run_pass.h"
#include "mjdiag/plugin/design/machine_twin.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/noise_level.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Of the largest information of a direction, what rounding leaves of another.
constexpr double kRounding = 1e-15;
/// A step of logarithms that is large compared with rounding.
constexpr double kLeastStep = 1e-4;
/// Of a noise that is given: less is none.
constexpr double kLeastNoise = 1e-3;
/// Of squares of innovations: twice what healthy runs have shown.
constexpr double kMargin = 4.0;
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
      noise[i] = std::max(noise[i], NoiseLevel(run.outputs.row(i), 3));
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

/// The plant with these logarithms of factors in it.
Machine WithNumbers(const Machine& machine, UncertaintyOptions options, bool linear,
                    const VectorXd& theta) {
  options.friction = !linear;
  const UncertainMachine uncertain = MakeUncertainMachine(machine, options);
  NumberFactors factors;
  for (Index i = 0; i < theta.size(); ++i) {
    factors.emplace_back(
        FindPlantNumber(machine.plant(),
                        uncertain.unknowns[static_cast<std::size_t>(i)].name),
        std::exp(theta[i]));
  }
  return machine.WithNumbers(factors);
}

/// One calibration in the making: all runs about one and the same theta. One after the
/// other, each about a point of its own, they would contradict each other along
/// directions that are hardly known.
class Learner {
 public:
  /// @param before  theta that the machine gets to begin with
  Learner(const Machine& machine, const VectorXd& noise,
          const std::vector<Samples>& runs, bool linear, const VectorXd& before)
      : before_(before), own_(VectorXd::Zero(before.size())) {
    const UncertaintyOptions options{.faults = false, .doubt = true};
    const Machine with =
        WithNumbers(machine, options, linear, before).WithSensorNoise(noise);
    for (const Samples& run : runs) {
      MachineTwin twin = MakeTwin(with, linear, options);
      const Index n = before.size();
      unknowns_.assign(twin.unknowns.begin(), twin.unknowns.begin() + n);
      known_ = CovarianceOf(PriorOf(unknowns_));
      gains_ = twin.twin->gains();
      passes_.push_back(std::make_shared<RunPass>(std::move(twin.twin), run.outputs,
                                                  run.inputs, PriorOf(twin.unknowns)));
    }
    H_ = known_;
  }

  VectorXd theta() const { return before_ + own_; }
  /// A root of their covariance.
  MatrixXd Root() const {
    // By its modes in units of its diagonal: those that hardly anything is known of are
    // as well found as the others.
    const ScaledEigenPairs modes = ScaledEigenDecomposition(H_);
    const VectorXd information =
        modes.values.cwiseMax(kRounding * modes.values.maxCoeff());
    return modes.scale.cwiseInverse().asDiagonal() * modes.vectors *
           information.cwiseSqrt().cwiseInverse().asDiagonal();
  }
  const std::vector<Unknown>& unknowns() const { return unknowns_; }
  const std::vector<RunInformation>& said() const { return said_; }
  std::size_t stiffest() const { return gains_.size() - 1; }

  /// The method of Gauss and Newton with that gain, from where it is.
  /// @param rough  it is followed by another one
  void Learn(std::size_t gain, bool rough) {
    constexpr int kMostPasses = 12;
    // Squared, in standard deviations of the estimate.
    const double near = rough ? 100.0 : 0.1;
    double before = std::numeric_limits<double>::infinity();
    // A logarithm moves no farther at once.
    constexpr double kLongest = 0.5;
    for (int pass = 0; pass < kMostPasses; ++pass) {
      said_.resize(passes_.size());
      ParallelFor(static_cast<int>(passes_.size()), [&](int i) {
        const auto at = static_cast<std::size_t>(i);
        said_[at] = passes_[at]->About(own_, gain);
      });
      MatrixXd H = known_;
      VectorXd g = -known_ * theta();
      // Errors that are left count as noise: far from the solution, what is hardly known
      // must not be bent to explain them.
      for (const RunInformation& said : said_) {
        H += said.H / std::max(1.0, said.misfit);
        g += said.g / std::max(1.0, said.misfit);
      }
      H_ = H;
      VectorXd change = CovarianceOf(H) * g;
      diverged_ = !change.allFinite();
      if (diverged_) return;
      const double squared = change.dot(g);
      const double farthest = change.cwiseAbs().maxCoeff();
      if (farthest > kLongest) change *= kLongest / farthest;
      // Nor does it help to go on where only rounding is left.
      if (squared < near || (farthest < kLeastStep && squared > 0.5 * before)) break;
      before = squared;
      own_ += change;
    }
  }

  /// Whether no block of any run is more of a surprise than chance lets expect.
  bool Explains() const { return Excess() <= 1.0; }
  /// How many times more, the worst.
  double Excess() const {
    if (diverged_) return std::numeric_limits<double>::infinity();
    const Surprise limits(gains_.front().covariance.rows());
    double excess = 0.0;
    for (const RunInformation& said : said_) {
      excess = std::max({excess, said.worst_block / limits.BlockLimit(),
                         said.worst_stretch / limits.RecentLimit()});
    }
    return excess;
  }

  /// Mean square of what all runs leave, over what noise lets expect.
  double Misfit() const {
    double sum = 0.0;
    for (const RunInformation& said : said_) sum += said.misfit;
    return sum / static_cast<double>(said_.size());
  }

  /// Of the readings, by what changes from one innovation to the next.
  VectorXd Noise() const {
    VectorXd noise = VectorXd::Zero(gains_.front().covariance.rows());
    for (const RunInformation& said : said_) {
      for (Index i = 0; i < noise.size(); ++i) {
        noise[i] +=
            NoiseLevel(said.innovations.row(i), 1) / static_cast<double>(said_.size());
      }
    }
    return noise;
  }

 private:
  std::vector<std::shared_ptr<RunPass>> passes_;  // their starts go with them
  std::vector<Unknown> unknowns_;
  std::vector<TwinGain> gains_;
  MatrixXd known_;
  VectorXd before_, own_;
  MatrixXd H_;
  std::vector<RunInformation> said_;
  bool diverged_ = false;
};

/// By what a diagnosis would say of parts of the runs.
/// @param certain  whether the model is certainly not the machine
ModelUncertainty ModelUncertaintyOf(const Machine& calibrated,
                                    const std::vector<Samples>& runs, bool linear,
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
  for (const Samples& run : runs) {
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
  const auto progress = [&](double part) {
    if (options.progress) options.progress(part);
  };
  VectorXd noise = FirstNoise(machine, runs);
  // The machine is linearised anew about where it rests with what is learned.
  const auto about = [&](const VectorXd& theta) {
    return Learner(machine, noise, runs, options.linear, theta);
  };
  // Noise first, with the stiffest gain, which explains nearly anything: slow errors of
  // the model leave changes from tick to tick as they are.
  Learner learner = about(VectorXd::Zero(uncertain.known));
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
    noise *= std::sqrt(learner.Misfit());
    learner = about(learner.theta());
    learner.Learn(learner.stiffest(), true);
  }
  double excess = std::max(1.0, learner.Excess());
  progress(0.4);
  // The softest with which nothing is more of a surprise: at once, or step by step.
  std::size_t gain = learner.stiffest();
  for (std::size_t next = 0; gain > 0; next = gain - 1) {
    Learner softer = about(learner.theta());
    softer.Learn(next, true);
    if (softer.Excess() <= excess) {
      learner = std::move(softer);
      gain = next;
    } else if (next + 1 == gain) {
      break;
    }
    progress(0.8 -
             0.4 * static_cast<double>(gain) / static_cast<double>(learner.stiffest()));
  }
  if (!inflated) noise = noise.cwiseMin(learner.Noise());
  learner = about(learner.theta());
  learner.Learn(gain, false);
  if (inflated) {
    noise *= std::sqrt(learner.Misfit());
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
    report.records.push_back({said.misfit});
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
    factors.emplace_back(FindPlantNumber(machine.plant(), calibration.numbers[i]),
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
