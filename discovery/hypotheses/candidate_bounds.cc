#include "mjdiag/discovery/hypotheses/candidate_bounds.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/plugin/effects/regressor_signals.h"
#include "mjdiag/plugin/plant/tangent_coordinates.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

void Narrow(FitParameter& parameter, double lower, double upper) {
  if (!(upper > lower)) return;  // no motion
  parameter.lower = std::max(parameter.lower, lower);
  parameter.upper = std::min(parameter.upper, upper);
}

/// The step in which a reading is written, 0 where it has none: distances from a value to the
/// next are one of it, or a few.
double StepOf(VectorXd values) {
  std::ranges::sort(values);
  const double least = 1e-9 * (values[values.size() - 1] - values[0]);
  std::vector<double> gaps;
  for (Index k = 1; k < values.size(); ++k) {
    if (values[k] - values[k - 1] > least) gaps.push_back(values[k] - values[k - 1]);
  }
  if (gaps.empty()) return 0.0;
  const double step = *std::ranges::min_element(gaps);
  constexpr double kFew = 5.5;
  std::erase_if(gaps, [&](double gap) { return gap > kFew * step; });
  const auto whole = std::ranges::count_if(gaps, [&](double gap) {
    return std::abs(gap / step - std::round(gap / step)) < 0.05;
  });
  // Of a reading without steps a tenth is so by chance.
  constexpr double kNearlyAll = 0.9;
  const auto few = static_cast<double>(gaps.size());
  return few > 1.0 && static_cast<double>(whole) > kNearlyAll * few ? step : 0.0;
}

/// The longest way that records go through, and the largest gap between what they have seen.
struct Ways {
  double longest = 0.0;
  double gap = 0.0;
};

Ways WaysOf(VectorXd values, const VectorXd& time) {
  Ways ways;
  for (Index first = 0, k = 1; k <= values.size(); ++k) {
    if (k < values.size() && time[k] > time[k - 1]) continue;
    ways.longest = std::max(ways.longest, Range(values.segment(first, k - first)));
    first = k;
  }
  std::ranges::sort(values);
  for (Index k = 1; k < values.size(); ++k) {
    ways.gap = std::max(ways.gap, values[k] - values[k - 1]);
  }
  return ways;
}

}  // namespace

void BoundByReadings(std::vector<Candidate>& candidates, const Machine& machine,
                     const MeasuredRun& run) {
  for (Candidate& candidate : candidates) {
    if (candidate.effect->site() != SiteKind::kSensor) continue;
    const SensorSetup& sensor =
        machine.channels().sensors[static_cast<std::size_t>(candidate.channel)];
    const double step = sensor.resolution > 0.0
                            ? sensor.resolution
                            : StepOf(run.ReadingsOf(candidate.channel));
    for (std::size_t i = 0; i < candidate.parameters.size(); ++i) {
      FitParameter& parameter = candidate.parameters[i];
      if (parameter.role == Role::kAmplitude &&
          candidate.effect->parameters()[i].unit == "m") {
        parameter.least_size = 0.5 * step;
      }
      if (parameter.role != Role::kPeriod) continue;
      // What repeats with the step is the step, and an encoder is the same after a turn.
      constexpr double kSteps = 4.0;
      parameter.lower = std::max(parameter.lower, kSteps * step);
      if (machine.plant().jnt_type[machine.plant().dof_jntid[candidate.joint]] ==
          mjJNT_HINGE) {
        parameter.upper = std::min(parameter.upper, 1.001 * 2.0 * std::numbers::pi);
      }
    }
  }
}

void BoundPlays(std::vector<Candidate>& candidates, const Machine& machine,
                const VectorXd& reading_sd) {
  std::map<std::string, double> finest;  // by unit
  for (Index i = 0; i < reading_sd.size(); ++i) {
    const auto place = static_cast<std::size_t>(i);
    const std::string& unit = machine.channels().sensors[place].unit;
    const auto [one, is_first] = finest.try_emplace(unit, reading_sd[i]);
    if (!is_first) one->second = std::min(one->second, reading_sd[i]);
  }
  // The least that is seen; 0 of what has no play.
  const auto least_of = [&](const Candidate& candidate) {
    if (PlaceOf(candidate, Role::kGap) >= std::ssize(candidate.parameters)) return 0.0;
    const auto least = finest.find(
        IsLength(machine.plant(), static_cast<int>(candidate.joint)) ? "m" : "rad");
    return least == finest.end() ? 0.0 : least->second;
  };
  const auto gap_of = [](auto& candidate) -> auto& {
    return candidate
        .parameters[static_cast<std::size_t>(PlaceOf(candidate, Role::kGap))];
  };
  std::erase_if(candidates, [&](const Candidate& candidate) {
    const double least = least_of(candidate);
    return least > 0.0 && gap_of(candidate).upper <= least;
  });
  for (Candidate& candidate : candidates) {
    const double least = least_of(candidate);
    if (least > 0.0) gap_of(candidate).lower = std::max(gap_of(candidate).lower, least);
  }
}

void BoundSprings(std::vector<Candidate>& candidates, const Machine& machine,
                  double sample_time) {
  constexpr double kOfNyquist = 0.5;
  const double fastest = kOfNyquist * std::numbers::pi / sample_time;
  for (Candidate& candidate : candidates) {
    const double mass = machine.mechanics().M(candidate.joint, candidate.joint);
    if (candidate.effect.get() == &TransmissionWindup()) {
      candidate.parameters.front().least_size = 0.5 * sample_time * sample_time / mass;
    }
    if (candidate.effect.get() != &PreslidingHysteresis()) continue;
    FitParameter& stiffness = candidate.parameters.back();
    stiffness.upper = std::min(stiffness.upper, mass * fastest * fastest);
  }
}

void WidenFrequencies(Candidate& candidate, double sample_time) {
  std::size_t i = 0;
  for (const EffectParameter& p : candidate.effect->parameters()) {
    FitParameter& parameter = candidate.parameters[i++];
    if (parameter.role != Role::kFrequency) continue;
    parameter.upper = std::min({p.maximum, p.plausible, 0.5 / sample_time});
  }
}

void BoundByRecord(std::vector<Candidate>& candidates, const Machine& machine,
                   const ObservedMotion& motion) {
  // Waves and resonances come round within what is seen, or they are something else.
  constexpr double kOnce = 1.1;    // strokes a period, at most
  constexpr double kSwings = 2.0;  // in the longest record, at least
  std::map<Index, Scales> scales;  // of every joint
  for (Candidate& candidate : candidates) {
    const Site site{candidate.site, candidate.joint, candidate.channel};
    const SiteMotion at{machine.plant(), machine.mechanics(), motion, site};
    if (!scales.contains(candidate.joint)) scales[candidate.joint] = ScalesOf(at);
    const Scales& own = scales[candidate.joint];
    const VectorXd spread = candidate.effect->Spread(own);
    Index place = 0;
    const VectorXd q = at.q();
    const bool reads = candidate.effect->site() == SiteKind::kSensor;
    const double stroke = reads ? Range(at.y()) : own.stroke;
    const Index wave = PeriodPlace(candidate);
    for (FitParameter& parameter : candidate.parameters) {
      const double expected = spread[place++];
      if (expected > 0.0) parameter.spread = expected;
      switch (parameter.role) {
        case Role::kVelocity:
          Narrow(parameter, 1e-3 * own.speed, 2.0 * own.speed);
          break;
        case Role::kLength:
          Narrow(parameter, 1e-5 * own.stroke, 10.0 * own.stroke);
          break;
        case Role::kGap:
          // What never leaves its play has no spring.
          Narrow(parameter, 0.0, own.stroke);
          break;
        case Role::kPosition:
          Narrow(parameter, q.minCoeff(), q.maxCoeff());
          break;
        case Role::kFrequency:
          Narrow(parameter, kSwings / motion.time.maxCoeff(), 0.5 / motion.sample_time);
          break;
        case Role::kPeriod:
          Narrow(parameter, 0.0, kOnce * stroke);
          break;
        case Role::kTime:
          // What is later than that follows nothing any more.
          Narrow(parameter, 0.0, 0.1 * motion.time.maxCoeff());
          break;
        case Role::kLimit:
          Narrow(parameter, 0.0, at.before_gear().cwiseAbs().maxCoeff());
          break;
        default:
          break;
      }
      if (place - 1 != wave) continue;
      parameter.extent = motion.time.maxCoeff();
      if (parameter.role != Role::kPeriod) continue;
      parameter.extent = stroke;
      const Ways ways = WaysOf(reads ? VectorXd(at.y()) : q, motion.time);
      parameter.unseen_from = ways.longest;
      parameter.unseen_to = 2.0 * ways.gap;
    }
  }
}

void BoundDriveLimits(std::vector<Candidate>& candidates, const Machine& machine,
                      const ObservedMotion& motion) {
  for (Candidate& candidate : candidates) {
    const Site site{candidate.site, candidate.joint, candidate.channel};
    const SiteMotion at{machine.plant(), machine.mechanics(), motion, site};
    for (FitParameter& parameter : candidate.parameters) {
      if (parameter.role != Role::kLimit) continue;
      const VectorXd f = at.before_gear();
      const double usual =
          std::sqrt(2.0 * f.squaredNorm() / static_cast<double>(f.size()));
      Narrow(parameter, usual, f.cwiseAbs().maxCoeff());
    }
  }
}

}  // namespace mjdiag
