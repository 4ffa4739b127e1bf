#include "mjdiag/controllers/trajectory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>

#include "mjdiag/controllers/setpoint.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

/// A planned move of one axis on the control grid.
struct ScheduledMove {
  long start = 0;  ///< [ticks]
  Setpoint setpoint;
};

long ToTicks(double time, double sample_time) {
  return std::lround(time / sample_time);
}

/// "trajectory 'multi', move 3 at 0.25 s, axis 'x'"
std::string Where(const Trajectory& trajectory, std::size_t move,
                  const std::string& axis) {
  std::ostringstream where;
  where << "trajectory '" << trajectory.name << "', move " << move + 1 << " at "
        << trajectory.moves[move].at << " s, axis '" << axis << "'";
  return where.str();
}

std::string Seconds(long ticks, double sample_time) {
  std::ostringstream text;
  text << static_cast<double>(ticks) * sample_time << " s";
  return text.str();
}

Setpoint PlanMove(const Trajectory& trajectory, std::size_t move,
                  const std::string& axis, double sample_time) {
  const auto limits = trajectory.limits.find(axis);
  if (limits == trajectory.limits.end()) {
    throw InputError(Where(trajectory, move, axis), "the axis has no limits",
                     "velocity, acceleration, jerk and snap");
  }
  try {
    return {trajectory.moves[move].by.at(axis), limits->second, sample_time};
  } catch (const InputError& error) {
    throw InputError(Where(trajectory, move, axis) + ": " + error.what());
  }
}

/// The moves of one period of `axis`, checked against each other and the period.
std::vector<ScheduledMove> SchedulePeriod(const Trajectory& trajectory,
                                          const std::string& axis, double sample_time) {
  std::vector<ScheduledMove> schedule;
  std::size_t last_move = 0;
  for (std::size_t i = 0; i < trajectory.moves.size(); ++i) {
    const Move& move = trajectory.moves[i];
    if (!move.by.contains(axis)) continue;
    const std::string where = Where(trajectory, i, axis);
    if (!(move.at >= 0.0) ||
        (trajectory.period > 0.0 && move.at >= trajectory.period)) {
      throw InputError(where, "starts outside the period",
                       "a start from 0 s to before the period's end");
    }
    const long start = ToTicks(move.at, sample_time);
    if (!schedule.empty()) {
      const long rest = schedule.back().start + schedule.back().setpoint.ticks();
      if (start < rest) {
        throw InputError(where, "starts before the previous move has ended",
                         "a start at " + Seconds(rest, sample_time) + " or later");
      }
    }
    schedule.push_back({start, PlanMove(trajectory, i, axis, sample_time)});
    last_move = i;
  }
  if (trajectory.period > 0.0 && !schedule.empty()) {
    const long period = ToTicks(trajectory.period, sample_time);
    const long rest = schedule.back().start + schedule.back().setpoint.ticks();
    if (rest > schedule.front().start + period) {
      throw InputError(
          Where(trajectory, last_move, axis), "has not ended when the period repeats",
          "a period of " + Seconds(rest - schedule.front().start, sample_time) +
              " or longer");
    }
  }
  return schedule;
}

AxisReference SampleAxis(const Trajectory& trajectory, const std::string& axis,
                         double sample_time) {
  const long samples = ToTicks(trajectory.duration, sample_time);
  const long period = ToTicks(trajectory.period, sample_time);
  const std::vector<ScheduledMove> schedule =
      SchedulePeriod(trajectory, axis, sample_time);
  AxisReference reference{
      axis, Eigen::VectorXd::Zero(samples), Eigen::VectorXd::Zero(samples),
      Eigen::VectorXd::Zero(samples), Eigen::VectorXd::Zero(samples)};

  double rest_position = 0.0;
  long sampled = 0;  // samples that are already set
  const auto rest_until = [&](long end) {
    for (; sampled < std::min(end, samples); ++sampled) {
      reference.position[sampled] = rest_position;
    }
  };
  const auto follow = [&](long start, const Setpoint& setpoint) {
    rest_until(start);
    for (; sampled < std::min(start + setpoint.ticks(), samples); ++sampled) {
      const Motion motion = setpoint.At(static_cast<double>(sampled - start));
      reference.position[sampled] = rest_position + motion.position;
      reference.velocity[sampled] = motion.velocity;
      reference.acceleration[sampled] = motion.acceleration;
      reference.snap[sampled] = motion.snap;
    }
    rest_position += setpoint.distance();
  };
  for (long offset = 0; offset < samples; offset += period) {
    for (const ScheduledMove& move : schedule) {
      follow(offset + move.start, move.setpoint);
    }
    if (period == 0) break;
  }
  rest_until(samples);
  return reference;
}

/// A value and its first four derivatives.
using Jet = std::array<double, 5>;

/// The polynomial of degree 9 from 0 to 1 over 0 <= x <= 1 with four derivatives 0 at both
/// ends: w(x) = x^5 (126 - 420 x + 540 x^2 - 315 x^3 + 70 x^4).
Jet SmoothStep(double x) {
  if (x <= 0.0) return {0.0, 0.0, 0.0, 0.0, 0.0};
  if (x >= 1.0) return {1.0, 0.0, 0.0, 0.0, 0.0};
  constexpr std::array<double, 5> kCoefficients{126.0, -420.0, 540.0, -315.0, 70.0};
  Jet jet{};
  for (std::size_t i = 0; i < kCoefficients.size(); ++i) {
    double factor = kCoefficients[i];
    double power = 5.0 + static_cast<double>(i);
    for (double& value : jet) {
      value += factor * std::pow(x, power);
      factor *= power;
      power -= 1.0;
    }
  }
  return jet;
}

/// w of a trajectory at a time, and its derivatives by time. Of one that was cut short the
/// ramps meet in the middle.
Jet EnvelopeAt(double time, double duration, double ramp) {
  ramp = std::min(ramp, 0.5 * duration);
  const bool rises = time < 0.5 * duration;
  Jet jet = SmoothStep((rises ? time : duration - time) / ramp);
  double scale = 1.0;
  for (double& value : jet) {
    value *= scale;
    scale *= (rises ? 1.0 : -1.0) / ramp;
  }
  return jet;
}

/// Derivatives of a product, by Leibniz.
Jet Product(const Jet& a, const Jet& b) {
  constexpr std::array<std::array<double, 5>, 5> kBinomials{{{1, 0, 0, 0, 0},
                                                             {1, 1, 0, 0, 0},
                                                             {1, 2, 1, 0, 0},
                                                             {1, 3, 3, 1, 0},
                                                             {1, 4, 6, 4, 1}}};
  Jet product{};
  for (std::size_t n = 0; n < product.size(); ++n) {
    for (std::size_t k = 0; k <= n; ++k) {
      product[n] += kBinomials[n][k] * a[k] * b[n - k];
    }
  }
  return product;
}

void AddTones(const Trajectory& trajectory, double sample_time,
              AxisReference& reference) {
  for (const ReferenceTone& tone : trajectory.tones) {
    if (tone.axis != reference.axis) continue;
    const double omega = 2.0 * std::numbers::pi * tone.frequency;
    for (Eigen::Index k = 0; k < reference.position.size(); ++k) {
      const double time = static_cast<double>(k) * sample_time;
      const double sine = tone.amplitude * std::sin(omega * time + tone.phase);
      const double cosine = tone.amplitude * std::cos(omega * time + tone.phase);
      const Jet wave{sine, omega * cosine, -std::pow(omega, 2) * sine,
                     -std::pow(omega, 3) * cosine, std::pow(omega, 4) * sine};
      const Jet motion =
          Product(EnvelopeAt(time, trajectory.duration, trajectory.ramp), wave);
      reference.position[k] += motion[0];
      reference.velocity[k] += motion[1];
      reference.acceleration[k] += motion[2];
      reference.snap[k] += motion[4];
    }
  }
}

void CheckTones(const Trajectory& trajectory, const std::vector<std::string>& axes,
                double sample_time) {
  const std::string where = "trajectory '" + trajectory.name + "', tones";
  for (const ReferenceTone& tone : trajectory.tones) {
    if (std::find(axes.begin(), axes.end(), tone.axis) == axes.end()) {
      throw InputError(where, "there is no axis '" + tone.axis + "'",
                       "an axis of the setup");
    }
    if (!(tone.frequency > 0.0 && tone.frequency * sample_time < 0.5)) {
      throw InputError(where, "a frequency that the control rate cannot follow",
                       "more than 0 and less than half of it");
    }
  }
  if (!trajectory.tones.empty() && !(trajectory.ramp > 0.0)) {
    throw InputError(where, "have no ramp", "one of more than 0 s");
  }
}

void CheckTrajectory(const Trajectory& trajectory, const std::vector<std::string>& axes,
                     double sample_time) {
  const std::string where = "trajectory '" + trajectory.name + "'";
  if (!(sample_time > 0.0)) {
    throw InputError(where, "sample time is not positive", "seconds > 0");
  }
  if (!(trajectory.duration >= sample_time)) {
    throw InputError(where, "lasts less than a control tick", "a longer duration");
  }
  if (trajectory.period != 0.0 && !(trajectory.period >= sample_time)) {
    throw InputError(where, "repeats within a control tick", "a longer period, or 0");
  }
  for (std::size_t i = 0; i < trajectory.moves.size(); ++i) {
    for (const auto& [axis, distance] : trajectory.moves[i].by) {
      if (std::find(axes.begin(), axes.end(), axis) == axes.end()) {
        throw InputError(Where(trajectory, i, axis), "there is no such axis",
                         "an axis of the setup");
      }
    }
  }
  CheckTones(trajectory, axes, sample_time);
}

}  // namespace

Reference SampleTrajectory(const Trajectory& trajectory,
                           const std::vector<std::string>& axes, double sample_time) {
  CheckTrajectory(trajectory, axes, sample_time);
  Reference reference{sample_time, {}};
  for (const std::string& axis : axes) {
    reference.axes.push_back(SampleAxis(trajectory, axis, sample_time));
    AddTones(trajectory, sample_time, reference.axes.back());
  }
  return reference;
}

}  // namespace mjdiag
