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

bool SurelySeen(double deviation, const SeedsOfASize& seeds, const SeesFault& sees) {
  const int most = MostMissed(seeds.count);
  std::atomic<int> missed = 0;
  ParallelInOrder(seeds.count, [&](int i) {
    if (missed > most) return;
    if (!sees(deviation, seeds.first + static_cast<std::uint64_t>(i))) ++missed;
  });
  return missed <= most;
}

std::optional<double> SurelySeenSize(double largest, std::optional<double> guess,
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
  double seen = std::min(most, guess ? std::abs(*guess) : most);
  double unseen = seen;
  if (SurelySeen(sign * seen, seeds, sees)) {
    do {
      seen = unseen;
      unseen /= kStride;
    } while (unseen > kNothing * most && SurelySeen(sign * unseen, seeds, sees));
  } else {
    do {
      if (seen == most) return std::nullopt;
      unseen = seen;
      seen = std::min(most, seen * kStride);
    } while (!SurelySeen(sign * seen, seeds, sees));
  }
  while (seen > resolution * unseen) {
    const double middle = std::sqrt(seen * unseen);
    (SurelySeen(sign * middle, seeds, sees) ? seen : unseen) = middle;
  }
  return sign * seen;
}

}  // namespace mjdiag
