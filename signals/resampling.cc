#include "mjdiag/signals/resampling.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/median.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kNearRate = 0.2;
// Between a record of another rate and one whose times are in another unit, 1000 times.
constexpr double kOtherUnit = 30.0;
constexpr double kMissing = 1.5;
constexpr double kRounded = 0.01;  // of an interval: time stamps with few digits

std::string Irregularity(const VectorXd& intervals, double usual) {
  VectorXd around(intervals.size());
  Index count = 0;
  double missing = 0.0;  // an interval may be 1e300 usual ones
  for (const double interval : intervals) {
    if (interval < kMissing * usual) {
      around[count++] = interval / usual - 1.0;
    } else {
      missing += std::round(interval / usual) - 1.0;
    }
  }
  const double sd = std::sqrt(around.head(count).squaredNorm() /
                              static_cast<double>(std::max<Index>(count, 1)));
  constexpr double kCountable = 1e15;
  const std::string fewer =
      std::to_string(std::llround(std::min(missing, kCountable))) +
      " samples are missing";
  if (sd < kRounded && missing > 0.0) return fewer;
  return "time stamps are irregular (their intervals vary by " +
         FormatNumber(100.0 * sd, 2) + " %" + (missing > 0.0 ? ", " + fewer : "") + ")";
}

/// Of a tick after the first sample, where most samples are: a logger's first interval may be
/// one of its own. 0 where they are all over the tick, or next to it.
double PhaseOf(const VectorXd& times, double tick) {
  constexpr double kMost =
      0.5;  // resultant length: within a sixth of a tick of each other
  constexpr double kNear = 0.1;  // is jitter
  std::complex<double> sum = 0.0;
  for (const double time : times) {
    sum += std::polar(1.0, 2.0 * std::numbers::pi * (time - times[0]) / tick);
  }
  if (std::abs(sum) < kMost * static_cast<double>(times.size())) return 0.0;
  const double phase = std::arg(sum) / (2.0 * std::numbers::pi);
  if (std::abs(phase) < kNear) return 0.0;
  return phase < 0.0 ? 1.0 + phase : phase;
}

/// The last sample that is not after the time; the first before all of them.
Index LastBefore(const VectorXd& times, double time) {
  const auto after = std::upper_bound(times.begin(), times.end(), time);
  return std::max<Index>(after - times.begin() - 1, 0);
}

/// Lagrange's cubic through the two samples on either side, fewer at the ends. Relative to
/// the sample before, so that a signal that rests does so exactly.
double SmoothAt(const VectorXd& times, const VectorXd& x, double time) {
  const Index k = std::min(LastBefore(times, time), x.size() - 2);
  const Index first = std::max<Index>(k - 1, 0);
  const Index last = std::min<Index>(k + 2, x.size() - 1);
  double sum = 0.0;
  for (Index i = first; i <= last; ++i) {
    double weight = 1.0;
    for (Index j = first; j <= last; ++j) {
      if (j != i) weight *= (time - times[j]) / (times[i] - times[j]);
    }
    sum += weight * (x[i] - x[k]);
  }
  return x[k] + sum;
}

double StraightAt(const VectorXd& times, const VectorXd& x, double time) {
  const Index k = std::min(LastBefore(times, time), x.size() - 2);
  return x[k] + (time - times[k]) / (times[k + 1] - times[k]) * (x[k + 1] - x[k]);
}

double MeanHeld(const VectorXd& times, const VectorXd& x, double begin, double end) {
  Index k = LastBefore(times, begin);
  const double base = x[k];
  double sum = 0.0;
  for (double from = begin; from < end; ++k) {
    const bool last = k + 1 >= x.size();
    const double until = last ? end : std::min(end, std::max(from, times[k + 1]));
    sum += (until - from) * (x[k] - base);
    from = until;
    if (last) break;
  }
  return base + sum / (end - begin);
}

}  // namespace

SampleGrid ChooseGrid(const VectorXd& times, double sample_time,
                      const std::function<std::string(Index)>& place,
                      double own_clock) {
  const std::optional<UniformTime> uniform = FindUniformTime(times, place);
  const Index last = times.size() - 1;
  const VectorXd intervals = times.tail(last) - times.head(last);
  const double usual = uniform ? uniform->sample_time : Median(intervals);
  const double ratio = usual / sample_time;
  if (uniform && std::abs(ratio - 1.0) <= own_clock) {
    return {*uniform, times.size(), ""};
  }
  constexpr Index kFewest = 10;
  for (Index first = 1; !uniform && first <= 2 && times.size() - first >= kFewest;
       ++first) {
    const auto others = FindUniformTime(times.tail(times.size() - first),
                                        [&](Index k) { return place(k + first); });
    if (!others || std::abs(others->sample_time / sample_time - 1.0) > own_clock) {
      continue;
    }
    return {*others, times.size() - first,
            first == 1
                ? "the first sample, which is out of step with the others, is left out"
                : "the first two samples, which are out of step with the others, "
                  "are left out"};
  }
  if (ratio > kOtherUnit || ratio < 1.0 / kOtherUnit) {
    throw InputError(place(0),
                     "samples are " + FormatQuantity(usual, "s") +
                         " apart, the control tick of the setup is " +
                         FormatQuantity(sample_time, "s"),
                     "the unit of its times under [record.time], or the rate of the "
                     "record as rates.control");
  }
  std::string why = Irregularity(intervals, usual);
  if (uniform) {
    why =
        std::abs(ratio - 1.0) > kNearRate
            ? "samples are " + FormatQuantity(usual, "s") + " apart, not a control tick"
            : "the sample time is " + FormatNumber(100.0 * std::abs(ratio - 1.0), 2) +
                  " % off the control tick";
  }
  const double start = times[0] + sample_time * PhaseOf(times, sample_time);
  const double ticks = (times[last] - start) / sample_time;
  return {{start, sample_time},
          static_cast<Index>(std::floor(ticks + kSameClock)) + 1,
          why + ": resampled to " + FormatQuantity(sample_time, "s")};
}

VectorXd Resample(const VectorXd& times, const VectorXd& samples,
                  const SampleGrid& grid, Course course) {
  const double tick = grid.time.sample_time;
  // What is held changes at a sample, also where rounding puts that before or behind it.
  const double rounding = kSameClock * tick;
  return VectorXd::NullaryExpr(grid.samples, [&](Index k) {
    const double time = grid.time.start + static_cast<double>(k) * tick;
    switch (course) {
      case Course::kSmooth:
        return SmoothAt(times, samples, time);
      case Course::kStraight:
        return StraightAt(times, samples, time);
      case Course::kHeld:
        return MeanHeld(times, samples, time + rounding, time + tick + rounding);
      case Course::kSwitched:
        return samples[LastBefore(times, time + 0.5 * tick)];
    }
    return 0.0;
  });
}

}  // namespace mjdiag
