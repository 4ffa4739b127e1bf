#include "mjdiag/signals/bridging.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mjdiag/signals/median.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kSlow = 1.5;  // ticks, from which on a channel is slower than the grid
constexpr double kOneMissing = 1.5;  // usual intervals, from which on a sample is
constexpr double kSameTime = 0.01;   // tick

VectorXd IntervalsOf(const VectorXd& times) {
  const Index last = times.size() - 1;
  return times.tail(last) - times.head(last);
}

/// What is measured, beside the grid that it has to be on.
class Bridging {
 public:
  Bridging(VectorXd times, VectorXd samples, const SampleGrid& grid, Course course)
      : times_(std::move(times)),
        samples_(std::move(samples)),
        grid_(grid),
        course_(course),
        usual_(Median(IntervalsOf(times_))) {}

  Bridged OnGrid() const {
    const double tick = grid_.time.sample_time;
    Bridged bridged{Resample(times_, samples_, grid_, course_),
                    SampleMask::Constant(grid_.samples, true)};
    Index next = 0;
    for (Index k = 0; k < grid_.samples; ++k) {
      const double time = grid_.time.start + static_cast<double>(k) * tick;
      while (next < times_.size() && times_[next] < time - kSameTime * tick) ++next;
      const Index before = next - 1;
      const double to_next =
          next < times_.size() ? times_[next] - time : 2.0 * kGap * usual_;
      const double to_before =
          before >= 0 ? time - times_[before] : 2.0 * kGap * usual_;
      if (std::abs(to_next) <= kSameTime * tick) continue;
      const bool between = IsBetween(next);
      const bool nearest =
          usual_ <= kSlow * tick || std::min(to_before, to_next) <= 0.5 * tick;
      bridged.measured[k] = between && nearest;
      const bool held =
          course_ == Course::kHeld && to_before + to_next > kOneMissing * usual_;
      if (!between || held) bridged.samples[k] = Across(before, next, time);
    }
    if (bridged.measured.all()) bridged.measured.resize(0);
    return bridged;
  }

  /// All samples of the file, those between the measured ones filled in.
  VectorXd BesideOwn(const VectorXd& times, const VectorXd& own,
                     const SampleMask& valid) const {
    VectorXd filled = Resample(times_, samples_, grid_, course_);
    Index next = 0;
    for (Index k = 0; k < own.size(); ++k) {
      if (valid[k]) {
        filled[k] = own[k];
        ++next;
      } else if (course_ != Course::kSmooth || !IsBetween(next)) {
        filled[k] = Across(next - 1, next, times[k]);
      }
    }
    return filled;
  }

 private:
  /// Whether the sample before `next` is near it.
  bool IsBetween(Index next) const {
    return next > 0 && next < times_.size() &&
           times_[next] - times_[next - 1] <= kGap * usual_;
  }
  /// In a gap, or outside of all samples.
  double Across(Index before, Index next, double time) const {
    if (before < 0) return samples_[0];
    if (next >= samples_.size()) return samples_[samples_.size() - 1];
    if (course_ == Course::kSwitched) return samples_[before];
    const double share = (time - times_[before]) / (times_[next] - times_[before]);
    return samples_[before] + share * (samples_[next] - samples_[before]);
  }

  VectorXd times_;
  VectorXd samples_;
  const SampleGrid& grid_;
  Course course_;
  double usual_;  // interval [s]
};

}  // namespace

Bridged Bridge(const VectorXd& times, const VectorXd& samples, const SampleMask& valid,
               const SampleGrid& grid, Course course) {
  const Bridging bridging(Kept(times, valid), Kept(samples, valid), grid, course);
  if (!grid.IsOfFile()) return bridging.OnGrid();
  if (valid.size() == 0) return {samples, {}};
  return {bridging.BesideOwn(times, samples, valid), valid};
}

SampleMask InGaps(const SampleMask& measured) {
  const Index n = measured.size();
  SampleMask in_gaps = SampleMask::Constant(n, false);
  const VectorXd at =
      Kept(VectorXd::LinSpaced(n, 0.0, static_cast<double>(n - 1)), measured);
  if (at.size() < 2) return !measured;
  const double usual = Median(IntervalsOf(at));
  const auto first = static_cast<Index>(std::lround(at[0]));
  const auto last = static_cast<Index>(std::lround(at[at.size() - 1]));
  in_gaps.head(first) = true;
  in_gaps.tail(n - 1 - last) = true;
  for (Index i = 0; i + 1 < at.size(); ++i) {
    if (at[i + 1] - at[i] <= kGap * usual) continue;
    const auto from = static_cast<Index>(std::lround(at[i])) + 1;
    in_gaps.segment(from, static_cast<Index>(std::lround(at[i + 1])) - from) = true;
  }
  return in_gaps;
}

Gaps FindGaps(const VectorXd& times) {
  Gaps gaps;
  const VectorXd intervals = IntervalsOf(times);
  const double usual = Median(intervals);
  for (Index k = 0; k < intervals.size(); ++k) {
    if (intervals[k] <= kGap * usual) continue;
    if (gaps.count++ == 0) gaps.first = times[k];
    gaps.longest = std::max(gaps.longest, intervals[k]);
    gaps.total += intervals[k];
  }
  return gaps;
}

}  // namespace mjdiag
