#include "mjdiag/discovery/comparison/prediction.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mjdiag/plugin/machine/tick_map.h"
#include "mjdiag/plugin/replay/recorded_inputs.h"
#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kHorizons[] = {0.01, 0.1, 1.0};  // [s]
constexpr Index kStarts = 200;
constexpr Index kLengths = 10;

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
std::vector<Index> Starts(const MeasuredRun& run, Index longest,
                          const std::vector<Index>& skip) {
  std::vector<Index> starts;
  const Index most = std::clamp<Index>(kLengths * run.samples() / longest, 1, kStarts);
  const Index every = std::max<Index>(1, run.samples() / most);
  for (std::size_t i = 0; i < run.records.size(); ++i) {
    const Index first = run.records[i].sample;
    for (Index k = skip[i]; k + longest < run.SamplesOf(i); k += every) {
      starts.push_back(first + k);
    }
  }
  return starts;
}

/// Squares of errors and how many there are, sensors x horizons.
struct Errors {
  MatrixXd squares;
  MatrixXd counts;
};

/// From one moment.
class Forecast {
 public:
  Forecast(const Machine& machine, const MeasuredRun& run, Index start)
      : run_(run),
        start_(start),
        tick_(run.TickOf(start)),
        map_(machine),
        inputs_(machine, run),
        none_(VectorXd::Zero(machine.plant().nv)) {}

  Errors Run(PlantState state, const std::vector<Index>& horizons) {
    const Index ny = map_.sensors();
    const auto n = std::ssize(horizons);
    Errors errors{MatrixXd::Zero(ny, n), MatrixXd::Zero(ny, n)};
    bool diverged = false;
    for (Index k = 0; k <= horizons.back(); ++k) {
      inputs_.StayAt(start_ + k);
      if (!diverged) {
        const TickMap::Result& tick = map_.Run(state, none_, tick_ + k, inputs_);
        diverged = tick.diverged;
        state = tick.state;
      }
      for (Index h = 0; h < n; ++h) {
        const Index ahead = horizons[static_cast<std::size_t>(h)];
        for (Index i = 0; i < ny; ++i) {
          // What is read at the end of a tick belongs to the next one.
          if (ahead != (map_.ReadsAtEnd(i) ? k + 1 : k)) continue;
          const Index sample = start_ + ahead;
          if (run_.measured.size() > 0 && !run_.measured(i, sample)) continue;
          const double error = run_.outputs(i, sample) - map_.last().reading[i];
          errors.counts(i, h) = 1.0;
          errors.squares(i, h) =
              diverged ? std::numeric_limits<double>::infinity() : error * error;
        }
      }
    }
    return errors;
  }

 private:
  const MeasuredRun& run_;
  Index start_;
  Index tick_;
  TickMap map_;
  RecordedInputs inputs_;
  VectorXd none_;
};

}  // namespace

Prediction Predict(const Machine& machine, const MeasuredRun& run,
                   const FilterPath& path, Index skip) {
  return Predict(machine, run, path, std::vector<Index>(run.records.size(), skip));
}

Prediction Predict(const Machine& machine, const MeasuredRun& run,
                   const FilterPath& path, const std::vector<Index>& skip) {
  const std::vector<Index> horizons = Horizons(run);
  const std::vector<Index> starts = Starts(run, horizons.back(), skip);
  std::vector<Errors> errors(starts.size());
  ParallelFor(static_cast<int>(starts.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    errors[i] = Forecast(machine, run, starts[i])
                    .Run(path.states[static_cast<std::size_t>(starts[i])], horizons);
  });
  const Index ny = run.outputs.rows();
  const auto n = std::ssize(horizons);
  Errors sum{MatrixXd::Zero(ny, n), MatrixXd::Zero(ny, n)};
  for (const Errors& one : errors) {
    sum.squares += one.squares;
    sum.counts += one.counts;
  }
  Prediction prediction;
  for (const Index ticks : horizons) {
    prediction.horizons.push_back(static_cast<double>(ticks) * run.sample_time);
  }
  for (Index c = 0; c < ny; ++c) {
    const SensorSetup& sensor = machine.channels().sensors[static_cast<std::size_t>(c)];
    prediction.sensors.push_back(
        {sensor.channel, sensor.unit,
         (sum.squares.row(c).array() / sum.counts.row(c).array().max(1.0))
             .sqrt()
             .transpose()});
  }
  return prediction;
}

}  // namespace mjdiag
