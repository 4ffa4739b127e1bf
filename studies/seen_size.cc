#include "mjdiag/studies/seen_size.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/studies/growing_table.h"
#include "mjdiag/studies/machine_study.h"

namespace mjdiag {
namespace {

/// Seeds that may miss it.
int MostMissed(int count) {
  constexpr double kSlack = 1e-9;
  return static_cast<int>(
      std::floor((1.0 - kSurelySeen) * static_cast<double>(count) + kSlack));
}

}  // namespace

int CountSeen(double deviation, const SeedsOfASize& seeds, const SeesFault& sees) {
  std::atomic<int> seen = 0;
  ParallelFor(seeds.count, [&](int i) {
    if (sees(deviation, seeds.first + static_cast<std::uint64_t>(i))) ++seen;
  });
  return seen;
}

std::optional<int> SurelySeen(double deviation, const SeedsOfASize& seeds,
                              const SeesFault& sees) {
  const int most = MostMissed(seeds.count);
  std::atomic<int> missed = 0;
  ParallelInOrder(seeds.count, [&](int i) {
    if (missed > most) return;
    if (!sees(deviation, seeds.first + static_cast<std::uint64_t>(i))) ++missed;
  });
  if (missed > most) return std::nullopt;
  return seeds.count - missed;
}

std::optional<SeenSize> SurelySeenSize(double largest, std::optional<double> guess,
                                       double resolution, const SeedsOfASize& seeds,
                                       const SeesFault& sees) {
  constexpr double kStride = 2.0;
  constexpr double kNothing = 1e-12;
  const double sign = std::copysign(1.0, largest);
  const double most = std::abs(largest);
  if (!guess) {
    guess = SmallestDeviation(largest, kStride, [&](double deviation) {
      return sees(deviation, seeds.first);
    });
  }
  std::optional<SeenSize> seen;
  double unseen = 0.0;
  const auto is_seen = [&](double size) {
    const std::optional<int> count = SurelySeen(sign * size, seeds, sees);
    if (count) {
      seen = {sign * size, *count};
    } else {
      unseen = size;
    }
    return count.has_value();
  };
  double size = std::min(most, guess ? std::abs(*guess) : most);
  if (is_seen(size)) {
    do {
      size /= kStride;
    } while (size > kNothing * most && is_seen(size));
    unseen = size;
  } else {
    do {
      if (size == most) return std::nullopt;
      size = std::min(most, size * kStride);
    } while (!is_seen(size));
  }
  while (std::abs(seen->deviation) > resolution * unseen) {
    is_seen(std::sqrt(std::abs(seen->deviation) * unseen));
  }
  return seen;
}

}  // namespace mjdiag
