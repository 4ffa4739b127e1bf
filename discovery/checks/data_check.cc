#include "mjdiag/discovery/checks/data_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>
#include <optional>
#include <set>

#include "mjdiag/discovery/checks/clock_drift.h"
#include "mjdiag/discovery/checks/nominal_run.h"
#include "mjdiag/discovery/checks/unit_check.h"
#include "mjdiag/plugin/effects/regressor_signals.h"
#include "mjdiag/plugin/replay/tracking.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/noise_level.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::string Digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string Quoted(const std::string& name) { return "'" + name + "'"; }

/// Equal values from `first`, as many as `count`.
struct Repeats {
  Index first = 0;
  Index count = 0;
  Index end() const { return first + count; }
};

std::vector<Repeats> RepeatsIn(const VectorXd& x, Index least) {
  std::vector<Repeats> runs;
  for (Index k = 0; k < x.size();) {
    Index end = k + 1;
    while (end < x.size() && x[end] == x[k]) ++end;
    if (end - k >= least) runs.push_back({k, end - k});
    k = end;
  }
  return runs;
}

/// The smallest step between neighbours that is one: the quantum of a quantised sensor.
double SmallestStep(const VectorXd& x) {
  double smallest = std::numeric_limits<double>::infinity();
  for (Index k = 1; k < x.size(); ++k) {
    const double step = std::abs(x[k] - x[k - 1]);
    if (step > 0.0) smallest = std::min(smallest, step);
  }
  return smallest;
}

class RecordCheck {
 public:
  RecordCheck(const Machine& machine, const Record& measured)
      : machine_(machine),
        measured_(measured),
        skip_(machine.setup().compare.skip_samples) {}

  std::vector<std::string> Check() {
    CheckLength();
    CheckFinite();
    ToMeasuredRun(setup(), measured_);  // names what the replay lacks
    const bool from_readings =
        CheckAgainstReferences(setup(), measured_) && closed_loop();
    SimulateNominal(from_readings);
    if (simulated_) CheckAgainstPlant(machine_, measured_, *simulated_);
    if (simulated_ && !from_readings) SimulateNominal(true);
    for (const SensorSetup& sensor : setup().channels.sensors) CheckSaturation(sensor);
    if (simulated_) {
      std::ranges::copy(CheckClocks(machine_, measured_, *simulated_),
                        std::back_inserter(notes_));
    }
    return notes_;
  }

 private:
  VectorXd Reading(const std::string& channel) const {
    return CountedSamples(setup(), measured_, channel);
  }
  std::string Place(Index counted) const {
    const double time = measured_.start_time() +
                        static_cast<double>(counted + skip_) * measured_.sample_time();
    return "sample " + std::to_string(counted + skip_) + " (" + Digits(time) + " s)";
  }
  const Setup& setup() const { return machine_.setup(); }
  bool closed_loop() const { return !setup().control.axes.empty(); }

  void CheckLength() const;
  void CheckFinite() const;
  void CheckSaturation(const SensorSetup& sensor) const;
  void SimulateNominal(bool from_readings);
  const VectorXd* Expected(const SensorSetup& sensor) const;

  const Machine& machine_;
  const Record& measured_;
  Index skip_;
  std::optional<Record> simulated_;  ///< of the nominal plant, without noise
  std::vector<std::string> notes_;
};

void RecordCheck::CheckLength() const {
  constexpr Index kLeast = 64;  // as a comparison asks for
  for (const SensorSetup& sensor : setup().channels.sensors) {
    const Channel* channel = measured_.Find(sensor.channel);
    if (channel == nullptr || channel->measured.size() <= skip_) continue;
    const Index n = channel->measured.tail(channel->measured.size() - skip_).count();
    if (n >= kLeast) continue;
    throw InputError(
        "record",
        "too short: " + std::to_string(n) + " values of " + Quoted(sensor.channel),
        "at least " + std::to_string(kLeast) + " that count");
  }
  if (measured_.samples() - skip_ >= kLeast) return;
  std::string what = std::to_string(measured_.samples()) + " samples";
  if (skip_ > 0)
    what += " of which the first " + std::to_string(skip_) + " are skipped";
  throw InputError("record", "too short: " + what,
                   "at least " + std::to_string(kLeast) + " that count");
}

void RecordCheck::CheckFinite() const {
  std::set<std::string> needed;
  for (const SensorSetup& sensor : setup().channels.sensors)
    needed.insert(sensor.channel);
  for (const ActuatorSetup& actuator : setup().channels.actuators) {
    needed.insert(actuator.channel);
  }
  for (const AxisSetup& axis : setup().control.axes) {
    for (const char* suffix : {"_ref", "_ref_velocity", "_ref_acceleration"}) {
      needed.insert(axis.name + suffix);
    }
    needed.insert(axis.name + "_ref_snap");
    needed.insert(axis.known_disturbance);
  }
  for (const std::string& name : needed) {
    const Channel* channel = measured_.Find(name);
    if (channel == nullptr) continue;
    Index bad = 0;
    Index first = 0;
    for (Index k = channel->samples.size() - 1; k >= 0; --k) {
      if (std::isfinite(channel->samples[k])) continue;
      first = k;
      ++bad;
    }
    if (bad == 0) continue;
    throw InputError("record",
                     std::to_string(bad) + " missing samples of " + Quoted(name) +
                         ", the first at " + Place(first - skip_),
                     "finite numbers");
  }
}

/// What the sensor should read as far as the record tells: its reference, or the
/// simulated plant; null if nothing tells.
const VectorXd* RecordCheck::Expected(const SensorSetup& sensor) const {
  for (const AxisSetup& axis : setup().control.axes) {
    if (axis.sensor == sensor.channel) {
      return &measured_.At(axis.name + "_ref").samples;
    }
  }
  return simulated_ ? &simulated_->At(sensor.channel).samples : nullptr;
}

/// Whether the signal has white noise of a quantum or more outside the runs. That of
/// quantising alone is smaller, and the differences of a smooth signal do not
/// alternate.
bool IsNoisy(const VectorXd& x, double quantum) {
  constexpr Index kOrder = 6;
  constexpr Index kLeast = 100;
  constexpr double kAlternates = -0.5;  // white noise: -m / (m + 1)
  constexpr Index kRepeats = 3;         // a quantised signal at rest
  double power = 0.0;
  double product = 0.0;
  Index count = 0;
  VectorXd free(x.size());
  Index used = 0;
  Index from = 0;
  std::vector<Repeats> runs = RepeatsIn(x, kRepeats);
  runs.push_back({x.size(), 0});
  for (const Repeats& run : runs) {
    VectorXd d = x.segment(from, run.first - from);
    free.segment(used, d.size()) = d;
    used += d.size();
    from = run.end();
    if (d.size() <= kOrder + 1) continue;
    for (Index m = 0; m < kOrder; ++m) {
      d = (d.tail(d.size() - 1) - d.head(d.size() - 1)).eval();
    }
    power += d.head(d.size() - 1).squaredNorm();
    product += d.head(d.size() - 1).dot(d.tail(d.size() - 1));
    count += d.size();
  }
  if (count < kLeast) return false;
  const double level = NoiseLevel(free.head(used), kOrder);
  return product < kAlternates * power && level >= quantum && level > 1e-9 * Range(x);
}

/// Samples that x needs to get so far away from sample k, forwards (direction 1) or
/// backwards (-1); nothing if the record ends before.
std::optional<Index> Leaves(const VectorXd& x, Index k, Index direction, double away) {
  for (Index n = 1; k + direction * n >= 0 && k + direction * n < x.size(); ++n) {
    if (std::abs(x[k + direction * n] - x[k]) >= away) return n;
  }
  return std::nullopt;
}

/// Whether a coarse signal comes to a rest and leaves it at a steady speed, which no
/// machine with inertia does: four times the way takes it four times as long then, from
/// a turning point or out of friction twice as long.
/// @param step  the smallest of the signal
bool IsCutOff(const VectorXd& x, const Repeats& run, double step) {
  constexpr double kNear = 4.0;  // steps
  constexpr Index kLeast = 4;    // samples
  constexpr double kSteady = 0.35;
  const auto steady = [&](Index k, Index direction) {
    auto near = Leaves(x, k, direction, kNear * step);
    if (!near) return false;
    near = std::max(*near, kLeast);
    const Index end = k + direction * *near;
    if (end < 0 || end >= x.size()) return false;
    const auto far = Leaves(x, k, direction, 4.0 * std::abs(x[end] - x[k]));
    return far && static_cast<double>(*near) < kSteady * static_cast<double>(*far);
  };
  return steady(run.first, -1) && steady(run.end() - 1, 1);
}

/// Whether the reading never leaves the noise or the steps that it has at rest.
bool StandsStill(const VectorXd& x) {
  constexpr double kSteps = 8.0;
  std::vector<double> steps;
  for (Index k = 1; k < x.size(); ++k) {
    if (x[k] != x[k - 1]) steps.push_back(std::abs(x[k] - x[k - 1]));
  }
  if (steps.empty()) return true;
  const auto middle = steps.begin() + std::ssize(steps) / 2;
  std::nth_element(steps.begin(), middle, steps.end());
  return Range(x) <= kSteps * *middle;
}

/// Samples in runs of five equal ones and more at other values than its extremes: of a
/// sensor that repeats wherever it rests.
Index RepeatsInside(const VectorXd& x) {
  constexpr Index kLeast = 5;
  Index total = 0;
  for (const Repeats& run : RepeatsIn(x, kLeast)) {
    if (x[run.first] == x.minCoeff() || x[run.first] == x.maxCoeff()) continue;
    total += run.count;
  }
  return total;
}

/// Whether a reading turns around within one of its steps: a parabola whose top is in a step
/// for 2 h samples is two steps off another h away, what is cut off in motion at least h.
bool TurnsAround(const VectorXd& x, const Repeats& run) {
  constexpr double kSteps = 4.0;
  const Index side = std::max<Index>(5, run.count / 2);
  if (run.first < side || run.end() + side > x.size()) return false;
  double step = 0.0;
  for (Index k = run.first - side + 1; k < run.end() + side; ++k) {
    step = std::max(step, std::abs(x[k] - x[k - 1]));
  }
  const double top = x[run.first];
  return std::max(std::abs(top - x[run.first - side]),
                  std::abs(top - x[run.end() - 1 + side])) <= kSteps * step;
}

void RecordCheck::CheckSaturation(const SensorSetup& sensor) const {
  constexpr Index kLeast = 10;
  constexpr double kShare = 0.005;
  constexpr double kShouldMove = 0.05;  // of the expected range, in one run
  // What was not measured is not judged: of a slow sensor every value would be held.
  if (measured_.At(sensor.channel).measured.size() > 0) return;
  const VectorXd x = Reading(sensor.channel);
  if (StandsStill(x)) return;
  const Index inside = RepeatsInside(x);
  const VectorXd* expected = Expected(sensor);
  const double step = std::max(SmallestStep(x), sensor.resolution);
  const std::vector<Repeats> runs = RepeatsIn(x, kLeast);
  for (const double extreme : {x.maxCoeff(), x.minCoeff()}) {
    Index total = 0;
    Index first = -1;
    bool should_move = false;
    bool cut_off = false;
    for (const Repeats& run : runs) {
      if (x[run.first] != extreme || TurnsAround(x, run)) continue;
      if (first < 0) first = run.first;
      total += run.count;
      should_move |= expected != nullptr &&
                     Range(expected->segment(run.first + skip_, run.count)) >
                         kShouldMove * Range(*expected);
      cut_off |= IsCutOff(x, run, step);
    }
    if (static_cast<double>(total) <= kShare * static_cast<double>(x.size())) continue;
    // An arm that friction holds rests where its reference moves on.
    const bool loses_noise = inside < total && IsNoisy(x, step);
    if (!(should_move && cut_off) && !loses_noise) continue;
    throw InputError("record",
                     "saturated: " + Quoted(sensor.channel) + " sits at exactly " +
                         Digits(extreme) + " " + sensor.unit + " for " +
                         std::to_string(total) + " samples, first at " + Place(first),
                     "a sensor that sees the whole motion");
  }
}

void RecordCheck::SimulateNominal(bool from_readings) {
  try {
    simulated_ = NominalRun(machine_, measured_, from_readings);
  } catch (const NumericalError& error) {
    simulated_.reset();
    notes_.push_back("units and clocks of the record are not checked: the plant as " +
                     std::string("given does not run along it (") + error.what() + ")");
  }
}

}  // namespace

std::vector<std::string> CheckRecord(const Machine& machine, const Record& measured) {
  return RecordCheck(machine, measured).Check();
}

}  // namespace mjdiag
