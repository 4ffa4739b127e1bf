#include "mjdiag/signals/uniform_time.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/median.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Largest distance from the grid, in samples.
constexpr double kTolerance = 0.01;
constexpr int kMaxDigits = 17;

std::string Print(double seconds) {
  char text[32];
  const auto end =
      std::to_chars(text, text + sizeof text, seconds, std::chars_format::general, 6);
  return std::string(text, end.ptr) + " s";
}

double RoundToDigits(double value, int digits) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value,
                                 std::chars_format::scientific, digits - 1);
  double rounded = value;
  std::from_chars(text, end.ptr, rounded);
  return rounded;
}

void RequireIncreasing(const VectorXd& times,
                       const std::function<std::string(Index)>& place) {
  for (Index k = 1; k < times.size(); ++k) {
    if (times[k] > times[k - 1]) continue;
    throw InputError(place(k),
                     "time does not increase (" + Print(times[k]) + " after " +
                         Print(times[k - 1]) + ")",
                     "a later time in every sample");
  }
}

double SimplestSampleTime(const VectorXd& times) {
  const Index last = times.size() - 1;
  const double mean = (times[last] - times[0]) / static_cast<double>(last);
  const double epsilon = std::numeric_limits<double>::epsilon();
  const double rounding =
      2.0 * epsilon * (times.cwiseAbs().maxCoeff() / static_cast<double>(last) + mean);
  for (int digits = 1; digits < kMaxDigits; ++digits) {
    for (const double candidate :
         {RoundToDigits(mean, digits), 1.0 / RoundToDigits(1.0 / mean, digits)}) {
      if (std::abs(candidate - mean) <= rounding) return candidate;
    }
  }
  return mean;
}

[[noreturn]] void ThrowNotUniform(const VectorXd& times, Index worst_on_grid,
                                  const std::function<std::string(Index)>& place) {
  const Index last = times.size() - 1;
  const VectorXd intervals = times.tail(last) - times.head(last);
  const double usual = Median(intervals);
  Index worst = 0;
  const double off = (intervals.array() - usual).abs().maxCoeff(&worst);
  // A single odd interval is the reason; a slow drift has none to point at.
  const bool jump = off > kTolerance * usual;
  const Index sample = jump ? worst + 1 : worst_on_grid;
  throw InputError(place(sample),
                   "time is not uniform (interval " +
                       Print(intervals[std::max<Index>(sample, 1) - 1]) +
                       ", elsewhere " + Print(usual) + ")",
                   "every time within 1 % of a sample of the uniform grid");
}

struct Fit {
  UniformTime grid;
  Index worst = 0;  ///< sample, by its distance from the grid
  bool fits = true;
};

Fit FitGrid(const VectorXd& times, const std::function<std::string(Index)>& place) {
  if (times.size() < 2) {
    throw InputError(place(0), "has " + std::to_string(times.size()) + " samples",
                     "at least two");
  }
  RequireIncreasing(times, place);
  Fit fit{{times[0], SimplestSampleTime(times)}};
  double largest = 0.0;
  for (Index k = 0; k < times.size(); ++k) {
    const double off = std::abs(
        times[k] - (fit.grid.start + static_cast<double>(k) * fit.grid.sample_time));
    if (off > largest) {
      largest = off;
      fit.worst = k;
    }
  }
  fit.fits = largest <= kTolerance * fit.grid.sample_time;
  return fit;
}

}  // namespace

UniformTime FitUniformTime(const VectorXd& times,
                           const std::function<std::string(Index)>& place) {
  const Fit fit = FitGrid(times, place);
  if (!fit.fits) ThrowNotUniform(times, fit.worst, place);
  return fit.grid;
}

std::optional<UniformTime> FindUniformTime(
    const VectorXd& times, const std::function<std::string(Index)>& place) {
  const Fit fit = FitGrid(times, place);
  if (!fit.fits) return std::nullopt;
  return fit.grid;
}

}  // namespace mjdiag
