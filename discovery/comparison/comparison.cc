#include "mjdiag/discovery/comparison/comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "mjdiag/discovery/comparison/noise_floor.h"
#include "mjdiag/plugin/plant/start_state.h"
#include "mjdiag/plugin/replay/force_smoother.h"
#include "mjdiag/plugin/replay/linear_pass.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/plugin/replay/tracking.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

// Below this the noise of a record cannot be told from its motion.
constexpr Eigen::Index kShortestComparison = 64;

/// The channels to compare, sensors first. In open loop the actuators are the input,
/// not an answer.
std::vector<std::string> ComparedChannels(const Setup& setup) {
  std::vector<std::string> names;
  for (const SensorSetup& sensor : setup.channels.sensors)
    names.push_back(sensor.channel);
  if (setup.control.axes.empty()) return names;
  for (const ActuatorSetup& actuator : setup.channels.actuators) {
    names.push_back(actuator.channel);
  }
  return names;
}

/// Position sensors among the compared channels.
std::vector<std::string> Positions(const Record& compared, const Setup& setup) {
  std::vector<std::string> names;
  for (const SensorSetup& sensor : setup.channels.sensors) {
    const bool position = sensor.unit == "m" || sensor.unit == "rad";
    if (position && compared.Find(sensor.channel)) names.push_back(sensor.channel);
  }
  return names;
}

Record Select(const Record& record, const std::vector<std::string>& names,
              double start_time) {
  Record selected(record.sample_time(), start_time);
  for (const std::string& name : names) selected.Add(record.At(name));
  return selected;
}

double Ratio(const ChannelMismatch& channel) {
  // 0 / 0 of a noise-free channel without mismatch ranks last.
  return channel.rms == 0.0 ? 0.0 : channel.rms / channel.noise_floor.rms;
}

void CheckUnits(const Record& measured, const Record& simulated) {
  for (const Channel& channel : measured.channels()) {
    const std::string& expected = simulated.At(channel.name).unit;
    if (channel.unit != expected) {
      throw InputError("record channel '" + channel.name + "'", "unit " + channel.unit,
                       "unit " + expected + " as in the setup");
    }
  }
}

/// The frame of a comparison: what is compared, and from where on.
Comparison Begin(const Machine& machine, const Record& measured,
                 std::vector<std::string>& names) {
  Comparison result;
  result.setup = machine.setup().name;
  result.closed_loop = !machine.setup().control.axes.empty();
  result.options.skip_samples = machine.setup().compare.skip_samples;
  for (const std::string& name : ComparedChannels(machine.setup())) {
    (measured.Find(name) ? names : result.not_measured).push_back(name);
  }
  if (names.empty()) {
    throw InputError("record", "none of the setup's sensors",
                     "a channel '" + result.not_measured.front() + "'");
  }
  const Eigen::Index samples = measured.samples() - result.options.skip_samples;
  if (samples < kShortestComparison) {
    throw InputError("record",
                     std::to_string(measured.samples()) + " samples, of which " +
                         std::to_string(result.options.skip_samples) + " are left out",
                     "at least " + std::to_string(kShortestComparison) + " to compare");
  }
  return result;
}

/// Whether a sensor is somewhere further from its measurement than that spans.
bool Leaves(const Record& measured, const Record& simulated,
            const std::vector<std::string>& names) {
  return std::ranges::any_of(names, [&](const std::string& name) {
    const Channel& channel = measured.At(name);
    const Eigen::VectorXd& y = channel.samples;
    const double off = MismatchOf(channel, simulated.At(name), 0).cwiseAbs().maxCoeff();
    return off > y.maxCoeff() - y.minCoeff();
  });
}

/// Noise of the sensors, none without any: of one that rests only rounding is left.
Eigen::VectorXd NoiseOf(const Machine& machine, const Record& measured) {
  Eigen::VectorXd sd = MeasuredNoise(machine.channels(), measured);
  for (Eigen::Index i = 0; i < sd.size(); ++i) {
    const Channel& channel =
        measured.At(machine.channels().sensors[static_cast<std::size_t>(i)].channel);
    sd[i] = std::max({sd[i], 1e-12 * channel.samples.cwiseAbs().maxCoeff(), 1e-15});
  }
  return sd;
}

/// Whether the record has all that the filter needs.
bool CanBeFollowed(const Setup& setup, const Record& measured) {
  const auto has = [&](const auto& channel) {
    return measured.Find(channel.channel) != nullptr;
  };
  return std::ranges::all_of(setup.channels.sensors, has) &&
         std::ranges::all_of(setup.channels.actuators, has);
}

/// What is predicted over one tick.
void PredictATick(const Machine& machine, const Record& measured,
                  const FilterPath& path, Comparison& result) {
  result.falls = true;
  result.measured =
      Select(measured, ChannelsOf(machine.channels().sensors), measured.start_time());
  result.simulated = Record(measured.sample_time(), measured.start_time());
  // Beside a model that lacks nothing.
  FilterNoise noise = path.noise;
  noise.size *= 1e-9;
  noise.white *= 1e-9;
  // Whatever was read: what is cut leaves more that is not known, without end where a machine
  // falls.
  const Eigen::MatrixXd uncut = Eigen::MatrixXd::Ones(path.sensors(), path.samples());
  const VectorXd floors =
      Score(path, noise, 0, path.samples(), &uncut).variance.cwiseSqrt();
  const auto samples = static_cast<double>(measured.samples());
  Eigen::Index row = 0;
  for (const SensorSetup& sensor : machine.channels().sensors) {
    Channel predicted = measured.At(sensor.channel);
    predicted.samples -= path.innovations.row(row).transpose();
    result.simulated.Add(std::move(predicted));
    const NoiseFloor floor{
        .rms = floors[row++], .mismatch_freedom = samples, .floor_freedom = samples};
    result.channels.push_back(MeasureMismatch(result.measured, result.simulated,
                                              sensor.channel, floor, result.options));
  }
}

std::map<std::string, NoiseFloor> FloorsOf(const Comparison& like) {
  std::map<std::string, NoiseFloor> floors;
  for (const ChannelMismatch& channel : like.channels) {
    floors[channel.name] = channel.noise_floor;
  }
  return floors;
}

/// Measured beside a free simulation.
/// @param like  has the noise floors; null: from draws of the noise
void CompareChannels(const Machine& noisy, const Record& measured,
                     const Record& simulated, const Excitation& excitation,
                     const std::vector<std::string>& names, const RunOptions& options,
                     const Comparison* like, Comparison& result) {
  const auto floors = like != nullptr
                          ? FloorsOf(*like)
                          : EstimateNoiseFloor(noisy, excitation, simulated, options,
                                               result.options.skip_samples);
  const double start = measured.start_time();
  result.measured = Select(measured, names, start);
  result.simulated = Select(simulated, names, start);
  CheckUnits(result.measured, result.simulated);
  for (const std::string& name : names) {
    result.channels.push_back(MeasureMismatch(result.measured, result.simulated, name,
                                              floors.at(name), result.options));
  }
  const std::vector<std::string> positions = Positions(result.measured, noisy.setup());
  result.measured_derived =
      DeriveChannels(result.measured, positions, noisy.setup().compare);
  result.simulated_derived =
      DeriveChannels(result.simulated, positions, noisy.setup().compare);
  result.derived = MeasureDerived(result.measured_derived, result.simulated_derived,
                                  result.options.skip_samples);
}

}  // namespace

bool Comparison::exceeds_noise() const {
  return std::any_of(channels.begin(), channels.end(),
                     [](const ChannelMismatch& c) { return c.exceeds_noise; });
}

const ChannelMismatch* Comparison::Worst() const {
  const auto rank = [](const ChannelMismatch& c) {
    return std::pair(c.exceeds_noise, Ratio(c));
  };
  const auto worst =
      std::max_element(channels.begin(), channels.end(),
                       [&](const ChannelMismatch& a, const ChannelMismatch& b) {
                         return rank(a) < rank(b);
                       });
  return worst == channels.end() ? nullptr : &*worst;
}

namespace {

/// Where a free simulation may begin: at rest where the first sample is; in open loop also
/// at rest and in motion where all readings say that the machine was, for the first sample is
/// as noisy as any other, and a record may begin in mid-motion.
std::vector<Excitation> StartsOf(const Machine& noisy, const Record& measured,
                                 const std::optional<PlantState>& smoothed) {
  std::vector<Excitation> starts{Replay(noisy.setup(), measured)};
  if (!smoothed) return starts;
  Excitation still = starts.front();
  const VectorXd readings =
      SensorReadings(noisy.channels(), noisy.plant(), smoothed->position);
  for (std::size_t i = 0; i < noisy.channels().sensors.size(); ++i) {
    const auto start = still.start.find(noisy.channels().sensors[i].channel);
    if (start == still.start.end()) continue;
    start->second = readings[static_cast<Eigen::Index>(i)];
  }
  Excitation moving = starts.front();
  moving.state = smoothed;
  starts.push_back(std::move(still));
  starts.push_back(std::move(moving));
  return starts;
}

/// Mean squares of what the sensors miss, each in its noise.
double Missed(const Record& measured, const Record& simulated, const Machine& noisy) {
  double sum = 0.0;
  for (const SensorSetup& sensor : noisy.channels().sensors) {
    const Channel* channel = measured.Find(sensor.channel);
    if (channel == nullptr) continue;
    const VectorXd off = MismatchOf(*channel, simulated.At(sensor.channel), 0);
    sum += off.squaredNorm() / std::max(1e-300, std::pow(sensor.noise_sd, 2));
  }
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

/// The free simulation from where it stays nearest, without its channels if the machine falls
/// in it; the error that it ended with, if any.
/// @param smoothed  where all readings say that the machine was; none: not asked
std::optional<NumericalError> SimulateFreely(
    const Machine& machine, const Record& measured, const RunOptions& options,
    const std::vector<std::string>& names, bool may_leave,
    const std::optional<PlantState>& smoothed, const Comparison* like,
    Comparison& result) {
  const Machine noisy =
      machine.WithSensorNoise(MeasuredNoise(machine.channels(), measured));
  RunOptions without_noise = options;
  without_noise.noise_scale = 0.0;
  std::optional<NumericalError> error;
  std::optional<Excitation> excitation;
  Record simulated;
  double least = 0.0;
  for (Excitation& start : StartsOf(noisy, measured, smoothed)) {
    try {
      Record run = Simulate(noisy, start, without_noise);
      const double missed = smoothed ? Missed(measured, run, noisy) : 0.0;
      if (excitation && missed >= least) continue;
      least = missed;
      simulated = std::move(run);
      excitation = std::move(start);
    } catch (const NumericalError& diverged) {
      error = diverged;
    }
  }
  if (!excitation) {
    result.falls = true;
    return error;
  }
  if (!may_leave && !result.closed_loop && Leaves(measured, simulated, names)) {
    result.falls = true;
    return std::nullopt;
  }
  CompareChannels(noisy, measured, simulated, *excitation, names, options, like,
                  result);
  return std::nullopt;
}

}  // namespace

Comparison Compare(const Machine& machine, const Record& measured,
                   const RunOptions& options) {
  std::vector<std::string> names;
  Comparison result = Begin(machine, measured, names);
  if (!CanBeFollowed(machine.setup(), measured)) {
    const auto error = SimulateFreely(machine, measured, options, names, true,
                                      std::nullopt, nullptr, result);
    if (error) throw *error;
    return result;
  }
  const MeasuredRun run = ToMeasuredRun(machine.setup(), measured);
  const FilterPath path = FilterLikeliest(machine, run, NoiseOf(machine, measured));
  const SmoothedForces smoothed = SmoothForces(path);
  std::optional<PlantState> start;
  if (!result.closed_loop && smoothed.start.allFinite()) {
    start = Moved(machine.plant(), path.starts.front().state, smoothed.start.col(0));
  }
  SimulateFreely(machine, measured, options, names, false, start, nullptr, result);
  result.deviance = path.deviance;
  result.prediction = Predict(machine, run, path, result.options.skip_samples);
  result.missing_force = DisturbanceEstimates(machine, path, smoothed);
  if (result.falls) PredictATick(machine, measured, path, result);
  return result;
}

Comparison CompareFree(const Machine& machine, const Record& measured,
                       const RunOptions& options, const Comparison* like) {
  std::vector<std::string> names;
  Comparison result = Begin(machine, measured, names);
  const auto error = SimulateFreely(machine, measured, options, names, true,
                                    std::nullopt, like, result);
  if (error) throw *error;
  return result;
}

bool DivergesOpenLoop(const Machine& machine, const Record& measured) {
  if (!machine.setup().control.axes.empty() ||
      !CanBeFollowed(machine.setup(), measured)) {
    return false;
  }
  RunOptions quiet;
  quiet.noise_scale = 0.0;
  try {
    return Leaves(measured, Simulate(machine, Replay(machine.setup(), measured), quiet),
                  ChannelsOf(machine.channels().sensors));
  } catch (const NumericalError&) {
    return true;
  }
}

namespace {

FilterPath LikeliestPath(const Machine& machine, const MeasuredRun& run,
                         const VectorXd& reading_sd, const FilterNoise* near) {
  if (near != nullptr) {
    const std::vector<Index> dofs = LatentDofs(machine, run);
    try {
      if (near->size.size() == std::ssize(dofs)) {
        return FilterLikeliestNear(machine, run, reading_sd, dofs, *near, {});
      }
    } catch (const NumericalError&) {  // too far
    }
  }
  return FilterLikeliest(machine, run, reading_sd);
}

}  // namespace

FollowedPair CompareFollowed(const Machine& machine, const Machine& changed,
                             const Record& measured, const FilterNoise* near) {
  std::vector<std::string> names;
  const Comparison frame = Begin(machine, measured, names);
  const MeasuredRun run = ToMeasuredRun(machine.setup(), measured);
  const FilterPath path = LikeliestPath(machine, run, NoiseOf(machine, measured), near);
  FollowedPair pair{frame, frame};
  PredictATick(machine, measured, path, pair.before);
  PredictATick(changed, measured,
               RunForceFilter(changed, run, path.dofs, path.starts, path.noise),
               pair.after);
  return pair;
}

}  // namespace mjdiag
