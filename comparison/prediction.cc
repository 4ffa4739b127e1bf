#include "mjdiag/comparison/prediction.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "mjdiag/plugin/machine/input_course.h"
#include "mjdiag/plugin/machine/stepper.h"
#include "mjdiag/plugin/replay/motion_noise.h"
#include "mjdiag/plugin/replay/motion_path.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kHorizons[] = {0.01, 0.1, 1.0};  // [s]
constexpr Index kStarts = 200;

/// -2 ln L over n, but for a constant.
double Deviance(const FollowedRun& followed) {
  const MatrixXd& S = followed.observer.innovation_covariance;
  const VectorXd r = followed.observer.noise_sd;
  // In units of the noise: determinants of small numbers vanish.
  const MatrixXd scaled =
      r.cwiseInverse().asDiagonal() * S * r.cwiseInverse().asDiagonal();
  const MatrixXd e = r.cwiseInverse().asDiagonal() * followed.track.innovations;
  const MatrixXd weighed = Solve(scaled, e);
  const Eigen::LLT<MatrixXd> factor(scaled);
  const auto values = static_cast<double>(e.rows());
  const double square =
      weighed.cwiseProduct(e).sum() / static_cast<double>(e.cols()) / values;
  return values * std::log(square) +
         2.0 * factor.matrixLLT().diagonal().array().log().sum();
}

/// Gives what was recorded from a sample on, and keeps what the machine reads.
class InputsFrom final : public TickControl {
 public:
  InputsFrom(const MeasuredRun& run, const std::vector<InputCourse>& courses)
      : run_(run), courses_(courses), reading_(run.outputs.rows()) {}

  void Begin(Index sample) { tick_ = sample; }
  void Tick(std::span<const double> outputs,
            std::span<double> inputs) noexcept override {
    std::copy(outputs.begin(), outputs.end(), reading_.begin());
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      inputs[i] = run_.inputs(static_cast<Index>(i), tick_);
    }
    ++tick_;
  }
  double Above(std::size_t actuator, int substep) const noexcept override {
    return courses_[actuator].Above(tick_ - 1, substep);
  }
  bool IsOn(std::size_t actuator) const noexcept override {
    return run_.on.size() == 0 ||
           run_.on(static_cast<Index>(actuator), tick_ - 1) != 0.0;
  }
  const VectorXd& reading() const { return reading_; }

 private:
  const MeasuredRun& run_;
  const std::vector<InputCourse>& courses_;
  VectorXd reading_;
  Index tick_ = 0;
};

/// Horizons in ticks.
std::vector<Index> Horizons(const MeasuredRun& run) {
  Index shortest = run.samples();
  for (std::size_t i = 0; i < run.records.size(); ++i) {
    shortest = std::min(shortest, run.SamplesOf(i));
  }
  std::vector<Index> horizons = {1};
  for (const double seconds : kHorizons) {
    const auto ticks = static_cast<Index>(std::lround(seconds / run.sample_time));
    if (ticks > horizons.back() && ticks <= shortest / 4) horizons.push_back(ticks);
  }
  return horizons;
}

/// Moments from which the longest horizon is in the same record.
std::vector<Index> Starts(const MeasuredRun& run, Index longest, Index skip) {
  std::vector<Index> starts;
  const Index every = std::max<Index>(1, run.samples() / kStarts);
  for (std::size_t i = 0; i < run.records.size(); ++i) {
    const Index first = run.records[i].sample;
    for (Index k = skip; k + longest <= run.SamplesOf(i); k += every) {
      starts.push_back(first + k);
    }
  }
  return starts;
}

}  // namespace

FollowedRun FollowLikeliest(const Machine& machine, MeasuredRun run,
                            const VectorXd& noise_sd) {
  constexpr double kStep = 3.0;
  constexpr double kPeriods = 25.0;
  const std::shared_ptr<const MotionPath> path = PathAlong(machine, run);
  const VectorXd noise = NoiseInMotion(machine, run, noise_sd, path);
  std::vector<double> bandwidths;
  const double slowest = kPeriods / run.Time().maxCoeff();
  const double fastest = FastestBandwidth(machine, run);
  for (double hertz = fastest; hertz > slowest; hertz /= kStep) {
    bandwidths.push_back(hertz);
  }
  if (bandwidths.empty()) bandwidths.push_back(fastest);
  std::vector<std::optional<FollowedRun>> followed(bandwidths.size());
  ParallelFor(static_cast<int>(bandwidths.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    try {
      Observer observer = DesignObserver(machine, run, noise, bandwidths[i], path);
      Track track = FollowRun(machine, {}, run, observer, true);
      followed[i] = {run, std::move(observer), std::move(track)};
    } catch (const NumericalError&) {
      // It does not stay beside the run.
    }
  });
  std::optional<FollowedRun> best;
  double least = std::numeric_limits<double>::infinity();
  for (auto& one : followed) {
    if (!one || !one->observer.following) continue;
    const double deviance = Deviance(*one);
    if (!(deviance < least)) continue;
    least = deviance;
    best = std::move(one);
  }
  if (!best) {
    throw NumericalError(
        "replay: the plant stays beside the record at no bandwidth of "
        "the observer");
  }
  return std::move(*best);
}

FollowedRun FollowAt(const Machine& machine, const Changes& changes, MeasuredRun run,
                     const VectorXd& noise_sd, double bandwidth) {
  const std::shared_ptr<const MotionPath> path = PathAlong(machine, run);
  const VectorXd noise = NoiseInMotion(machine, run, noise_sd, path);
  Observer observer = DesignObserver(machine, run, noise, bandwidth, path);
  Track track = FollowRun(machine, changes, run, observer, true);
  return {std::move(run), std::move(observer), std::move(track)};
}

Prediction Predict(const Machine& machine, const FollowedRun& followed, Index skip) {
  const MeasuredRun& run = followed.run;
  const std::vector<Index> horizons = Horizons(run);
  const std::vector<Index> starts = Starts(run, horizons.back(), skip);
  std::vector<InputCourse> courses;
  for (std::size_t i = 0; i < machine.channels().actuators.size(); ++i) {
    courses.emplace_back(machine.channels().actuators[i].hold,
                         run.inputs.row(static_cast<Index>(i)).transpose(),
                         machine.rates().substeps);
  }
  const Index ny = run.outputs.rows();
  const auto n = std::ssize(horizons);
  // Squares and how many were measured, of every start.
  std::vector<MatrixXd> squares(starts.size(), MatrixXd::Zero(ny, n));
  std::vector<MatrixXd> counts(starts.size(), MatrixXd::Zero(ny, n));
  ParallelFor(static_cast<int>(starts.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    const Index start = starts[i];
    const StartedPlant plant = StartPlant(machine, {});
    ChooseSolver(*plant.model);
    VectorXd::Map(plant.data->qpos, plant.model->nq) =
        followed.track.position.col(start);
    VectorXd::Map(plant.data->qvel, plant.model->nv) =
        followed.track.velocity.col(start);
    Stepper stepper(machine);
    InputsFrom control(run, courses);
    control.Begin(start);
    Index at = 0;
    for (Index k = 0; k < horizons.back(); ++k) {
      stepper.Advance(*plant.model, *plant.data, control);
      const bool diverged = HasDiverged(*plant.data);
      for (; at < n && (diverged || horizons[static_cast<std::size_t>(at)] == k + 1);
           ++at) {
        const Index sample = start + horizons[static_cast<std::size_t>(at)] - 1;
        for (Index c = 0; c < ny; ++c) {
          if (run.measured.size() > 0 && !run.measured(c, sample)) continue;
          counts[i](c, at) = 1.0;
          const double error = run.outputs(c, sample) - control.reading()[c];
          squares[i](c, at) =
              diverged ? std::numeric_limits<double>::infinity() : error * error;
        }
      }
      if (diverged) break;
    }
  });
  MatrixXd square = MatrixXd::Zero(ny, n);
  MatrixXd count = MatrixXd::Zero(ny, n);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    square += squares[i];
    count += counts[i];
  }
  Prediction prediction;
  for (const Index ticks : horizons) {
    prediction.horizons.push_back(static_cast<double>(ticks) * run.sample_time);
  }
  for (Index c = 0; c < ny; ++c) {
    const SensorSetup& sensor = machine.channels().sensors[static_cast<std::size_t>(c)];
    prediction.sensors.push_back(
        {sensor.channel, sensor.unit,
         (square.row(c).array() / count.row(c).array().max(1.0)).sqrt().transpose()});
  }
  return prediction;
}

}  // namespace mjdiag
