#include "mjdiag/signals/fresh_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kSteps = 3.0;  // of the reading, from which on it moves
constexpr double kOneStep = 1.5;

/// Samples of one and the same value, up to the next one's first.
struct Level {
  Index first = 0;
  Index end = 0;
  double value = 0.0;
  bool Repeats() const { return end - first > 1; }
};

std::vector<Level> LevelsOf(const VectorXd& x) {
  std::vector<Level> levels;
  for (Index k = 0; k < x.size();) {
    Index end = k + 1;
    while (end < x.size() && x[end] == x[k]) ++end;
    levels.push_back({k, end, x[k]});
    k = end;
  }
  return levels;
}

/// What the reading's smallest steps are where it is: digits that are written, or a float's,
/// make steps that go with the size of the value.
class Quanta {
 public:
  Quanta(const std::vector<Level>& levels, double resolution)
      : resolution_(std::max(resolution, StepBetweenRepeats(levels))) {
    for (std::size_t i = 1; i < levels.size(); ++i) {
      const double step = std::abs(levels[i].value - levels[i - 1].value);
      const int decade = DecadeOf(levels[i].value);
      const auto [at, is_new] = smallest_.try_emplace(decade, step);
      if (!is_new) at->second = std::min(at->second, step);
    }
    // Where larger values have small steps, smaller ones do, that only pass by.
    double smallest = std::numeric_limits<double>::infinity();
    for (auto at = smallest_.rbegin(); at != smallest_.rend(); ++at) {
      at->second = smallest = std::min(smallest, at->second);
    }
  }
  double At(double value) const {
    const auto found = smallest_.find(DecadeOf(value));
    return std::max(resolution_, found == smallest_.end() ? 0.0 : found->second);
  }

 private:
  /// An encoder behind a filter has values between its steps, but rests on them: the
  /// smallest step from one value that repeats to the next that does, where enough do to
  /// tell; else 0.
  static double StepBetweenRepeats(const std::vector<Level>& levels) {
    constexpr std::size_t kLeast = 20;
    double smallest = std::numeric_limits<double>::infinity();
    const Level* last = nullptr;
    std::size_t count = 0;
    for (const Level& level : levels) {
      if (!level.Repeats()) continue;
      if (last != nullptr && last->value != level.value) {
        smallest = std::min(smallest, std::abs(level.value - last->value));
      }
      last = &level;
      ++count;
    }
    return count >= kLeast && std::isfinite(smallest) ? smallest : 0.0;
  }

  static int DecadeOf(double value) {
    return value == 0.0 ? -400
                        : static_cast<int>(std::floor(std::log10(std::abs(value))));
  }
  double resolution_;
  std::map<int, double> smallest_;
};

class Reading {
 public:
  Reading(const VectorXd& times, const VectorXd& x, const ReadingScale& scale)
      : times_(times),
        x_(x),
        scale_(scale),
        levels_(LevelsOf(x)),
        quanta_(levels_, scale.resolution) {}

  FreshSamples Find() const {
    if (static_cast<Index>(levels_.size()) == x_.size()) return {};
    if (const Index period = Beat(); period > 1) return InBeat(period);
    return {Without(Held()), 1};
  }

 private:
  double Step(std::size_t i) const { return levels_[i].value - levels_[i - 1].value; }
  double Quantum(std::size_t i) const { return quanta_.At(levels_[i].value); }
  double Begin(std::size_t i) const { return times_[levels_[i].first]; }

  Index Beat() const;
  FreshSamples InBeat(Index period) const;
  std::vector<std::size_t> Held() const;
  bool MovesOn(std::size_t i, std::size_t next) const;
  bool Jumps(std::size_t i) const;
  SampleMask Without(const std::vector<std::size_t>& held) const;

  const VectorXd& times_;
  const VectorXd& x_;
  ReadingScale scale_;
  std::vector<Level> levels_;
  Quanta quanta_;
};

/// The longest period at whose samples nearly all changes are; 1: none.
Index Reading::Beat() const {
  constexpr std::size_t kLeast = 20;
  constexpr double kNearlyAll = 0.95;
  constexpr Index kLongest = 256;
  const std::size_t changes = levels_.size() - 1;
  if (changes < kLeast) return 1;
  std::size_t large = 0;
  for (std::size_t i = 1; i <= changes; ++i) {
    if (std::abs(Step(i)) >= kSteps * Quantum(i)) ++large;
  }
  if (2 * large < changes) return 1;
  const Index most = std::min(kLongest, x_.size() / static_cast<Index>(kLeast));
  for (Index period = most; period > 1; --period) {
    std::vector<std::size_t> at(static_cast<std::size_t>(period), 0);
    for (std::size_t i = 1; i <= changes; ++i) {
      ++at[static_cast<std::size_t>(levels_[i].first % period)];
    }
    if (static_cast<double>(std::ranges::max(at)) >=
        kNearlyAll * static_cast<double>(changes)) {
      return period;
    }
  }
  return 1;
}

FreshSamples Reading::InBeat(Index period) const {
  FreshSamples found{SampleMask::Constant(x_.size(), false), period};
  std::vector<Index> at(static_cast<std::size_t>(period), 0);
  for (std::size_t i = 1; i < levels_.size(); ++i) ++at[levels_[i].first % period];
  const Index phase = std::ranges::max_element(at) - at.begin();
  for (Index k = phase; k < x_.size(); k += period) found.fresh[k] = true;
  return found;
}

/// Whether the reading moved on behind level i, that lasts until level `next` begins.
bool Reading::MovesOn(std::size_t i, std::size_t next) const {
  constexpr std::size_t kAround = 3;  // levels
  constexpr double kNoLess = 0.6;
  const std::size_t from = i - std::min(kAround, i);
  const std::size_t to = std::min(next + kAround, levels_.size() - 1);
  if (from == i || to == next) return false;
  const auto rate = [&](std::size_t a, std::size_t b) {
    return (levels_[b].value - levels_[a].value) / (Begin(b) - Begin(a));
  };
  const double before = rate(from, i);
  const double after = rate(next, to);
  const double step = levels_[next].value - levels_[i].value;
  if (before * step <= 0.0 || after * step <= 0.0) return false;
  // Noise about a rest goes up and down.
  for (std::size_t k = from + 1; k <= to; ++k) {
    if (Step(k) * step < 0.0) return false;
  }
  const double slower = std::min(std::abs(before), std::abs(after));
  const double way = slower * (times_[levels_[next].first - 1] - Begin(i));
  return way >= kSteps * Quantum(i) && std::abs(step) >= kNoLess * way;
}

bool Reading::Jumps(std::size_t i) const {
  constexpr Index kLeast = 5;
  constexpr Index kAround = 5;
  constexpr double kJump = 3.0;
  constexpr double kSigmas = 6.0;
  const Level& held = levels_[i];
  if (held.end - held.first < kLeast || held.end + kAround >= x_.size()) return false;
  const double jump = x_[held.end] - held.value;
  double around = 0.0;
  for (Index k = 1; k <= kAround; ++k) {
    around = std::max(around, std::abs(x_[held.end + k] - x_[held.end + k - 1]));
    if (held.first < k) continue;
    around = std::max(around, std::abs(x_[held.first - k + 1] - x_[held.first - k]));
  }
  const double moves = kSteps * Quantum(i);
  const double after = x_[held.end + kAround] - x_[held.end];
  const double before = held.value - x_[std::max<Index>(held.first - kAround, 0)];
  const double size = std::abs(jump);
  const double sign = jump > 0.0 ? 1.0 : -1.0;
  return size > kJump * around && size > std::max(moves, kSigmas * scale_.noise_sd) &&
         (sign * after > moves || sign * before > moves);
}

/// Levels that are held.
std::vector<std::size_t> Reading::Held() const {
  std::vector<std::size_t> held;
  std::size_t steps = 0;  // single ones where repeats would be
  for (std::size_t i = 1; i + 1 < levels_.size(); ++i) {
    if (levels_[i].Repeats()) {
      if (MovesOn(i, i + 1)) held.push_back(i);
    } else if (i + 2 < levels_.size() && !levels_[i + 1].Repeats() &&
               std::abs(Step(i + 1)) < kOneStep * Quantum(i) && MovesOn(i, i + 2)) {
      ++steps;
    }
  }
  // As many by chance, and their scatter.
  const double by_chance = static_cast<double>(steps);
  if (static_cast<double>(held.size()) <=
      by_chance + 2.0 * std::sqrt(by_chance + 1.0)) {
    held.clear();
  }
  for (std::size_t i = 0; i + 1 < levels_.size(); ++i) {
    if (Jumps(i)) held.push_back(i);
  }
  return held;
}

SampleMask Reading::Without(const std::vector<std::size_t>& held) const {
  if (held.empty()) return {};
  SampleMask fresh = SampleMask::Constant(x_.size(), true);
  for (const std::size_t i : held) {
    fresh.segment(levels_[i].first + 1, levels_[i].end - levels_[i].first - 1) = false;
  }
  return fresh;
}

}  // namespace

FreshSamples FindFreshSamples(const VectorXd& times, const VectorXd& reading,
                              const ReadingScale& scale) {
  if (reading.size() < 3) return {};
  return Reading(times, reading, scale).Find();
}

}  // namespace mjdiag
