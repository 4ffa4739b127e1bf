#include "mjdiag/controllers/setpoint.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

void Require(bool holds, const char* what, const char* expected) {
  if (!holds) throw InputError("move", what, expected);
}

/// The smallest whole number of ticks that is not below `ticks`, but for rounding
/// errors of the planning itself.
long WholeTicks(double ticks) {
  constexpr double kRounding = 1e-9;
  constexpr double kLongest = 1e12;
  Require(ticks < kLongest, "takes longer than 1e12 control ticks",
          "higher limits or a shorter distance");
  return std::max(0L, static_cast<long>(std::ceil(ticks - kRounding)));
}

/// The root x >= 0 of (x + p)(x + q) = product, or below 0 if p q > product already.
double ProductRoot(double p, double q, double product) {
  const double half_gap = 0.5 * (q - p);
  return std::sqrt(half_gap * half_gap + product) - 0.5 * (p + q);
}

/// The root x of 2 (x + t)(x + 2 t)^2 = ratio, found by Newton's method from above,
/// where the cubic is convex and increasing; below 0 if 8 t^3 > ratio already.
double JerkPhaseForDistance(double t, double ratio) {
  double x = std::cbrt(0.5 * ratio);
  for (int i = 0; i < 100; ++i) {
    const double value = 2.0 * (x + t) * (x + 2.0 * t) * (x + 2.0 * t) - ratio;
    const double slope = 2.0 * (x + 2.0 * t) * (3.0 * x + 4.0 * t);
    const double step = value / slope;
    x -= step;
    if (std::abs(step) <= 1e-14 * (x + t)) break;
  }
  return x;
}

/// `limits` and `distance` in units of ticks.
PhaseTicks PlanPhases(double distance, const MoveLimits& limits) {
  PhaseTicks n;
  n.snap =
      std::max(1L, WholeTicks(std::min({std::pow(distance / (8 * limits.snap), 0.25),
                                        std::cbrt(limits.velocity / (2 * limits.snap)),
                                        std::sqrt(limits.acceleration / limits.snap),
                                        limits.jerk / limits.snap})));
  const auto t_s = static_cast<double>(n.snap);

  const double jerk = std::min(limits.jerk, limits.snap * t_s);
  n.jerk = WholeTicks(std::min({limits.acceleration / jerk - t_s,
                                ProductRoot(t_s, 2 * t_s, limits.velocity / jerk),
                                JerkPhaseForDistance(t_s, distance / jerk)}));
  const double rise = t_s + static_cast<double>(n.jerk);  // of the acceleration

  const double acceleration = std::min(limits.acceleration, jerk * rise);
  const double ramp = rise + t_s;  // up to constant acceleration
  n.acceleration =
      WholeTicks(std::min(limits.velocity / acceleration - ramp,
                          ProductRoot(ramp, 2 * ramp, distance / acceleration)));
  const double acceleration_time = ramp + static_cast<double>(n.acceleration);

  const double velocity = std::min(limits.velocity, acceleration * acceleration_time);
  n.velocity = WholeTicks(distance / velocity - (acceleration_time + ramp));
  return n;
}

/// The snap [per tick^4] with which the phases cover exactly `distance`.
double SnapForDistance(double distance, const PhaseTicks& n) {
  const auto rise = static_cast<double>(n.snap + n.jerk);
  const double ramp = rise + static_cast<double>(n.snap);
  const double acceleration_time = ramp + static_cast<double>(n.acceleration);
  const double velocity_time =
      ramp + acceleration_time + static_cast<double>(n.velocity);
  return distance /
         (static_cast<double>(n.snap) * rise * acceleration_time * velocity_time);
}

/// `t` later under constant snap.
Motion Advance(const Motion& m, double t) {
  return {
      m.position + t * (m.velocity +
                        t / 2 * (m.acceleration + t / 3 * (m.jerk + t / 4 * m.snap))),
      m.velocity + t * (m.acceleration + t / 2 * (m.jerk + t / 3 * m.snap)),
      m.acceleration + t * (m.jerk + t / 2 * m.snap), m.jerk + t * m.snap, m.snap};
}

}  // namespace

Setpoint::Setpoint(double distance, const MoveLimits& limits, double sample_time)
    : distance_(distance), sample_time_(sample_time) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  Require(std::isfinite(distance), "distance is not finite", "a number");
  Require(positive(sample_time), "sample time is not positive", "seconds > 0");
  Require(positive(limits.velocity), "velocity limit is not positive", "a number > 0");
  Require(positive(limits.acceleration), "acceleration limit is not positive",
          "a number > 0");
  Require(positive(limits.jerk), "jerk limit is not positive", "a number > 0");
  Require(positive(limits.snap), "snap limit is not positive", "a number > 0");
  if (distance == 0.0) return;

  const double t = sample_time;
  phases_ = PlanPhases(std::abs(distance),
                       {limits.velocity * t, limits.acceleration * t * t,
                        limits.jerk * t * t * t, limits.snap * t * t * t * t});
  const double snap = SnapForDistance(distance, phases_);
  const PhaseTicks& n = phases_;
  const std::array<std::pair<long, double>, 15> sequence = {{{n.snap, snap},
                                                             {n.jerk, 0},
                                                             {n.snap, -snap},
                                                             {n.acceleration, 0},
                                                             {n.snap, -snap},
                                                             {n.jerk, 0},
                                                             {n.snap, snap},
                                                             {n.velocity, 0},
                                                             {n.snap, -snap},
                                                             {n.jerk, 0},
                                                             {n.snap, snap},
                                                             {n.acceleration, 0},
                                                             {n.snap, snap},
                                                             {n.jerk, 0},
                                                             {n.snap, -snap}}};
  double start = 0.0;
  Motion motion;
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    const auto duration = static_cast<double>(sequence[i].first);
    motion.snap = sequence[i].second;
    profile_[i] = {start, motion};
    motion = Advance(motion, duration);
    start += duration;
  }
}

Motion Setpoint::At(double ticks) const {
  if (ticks < 0.0) return {};
  if (ticks >= static_cast<double>(phases_.Total())) return {.position = distance_};
  const auto next = std::upper_bound(
      profile_.begin(), profile_.end(), ticks,
      [](double time, const Phase& phase) { return time < phase.start; });
  const Phase& phase = *std::prev(next);
  const Motion m = Advance(phase.motion, ticks - phase.start);
  const double rate = 1.0 / sample_time_;
  const double rate2 = rate * rate;
  return {m.position, m.velocity * rate, m.acceleration * rate2, m.jerk * rate2 * rate,
          m.snap * rate2 * rate2};
}

}  // namespace mjdiag
