#include "mjdiag/studies/seen_size.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/studies/growing_table.h"

namespace mjdiag {
namespace {

/// One size after the other, hardest seeds first.
class SizesOfAFault {
 public:
  SizesOfAFault(const SeedsOfASize& seeds, const SeesFault& sees)
      : seeds_(seeds), sees_(sees), asked_(static_cast<std::size_t>(seeds.count)) {}

  /// How many see that size, if they are enough; ends as soon as they cannot be.
  std::optional<int> SurelySeen(double deviation) {
    const double size = std::abs(deviation);
    std::vector<std::size_t> order(asked_.size());
    std::iota(order.begin(), order.end(), 0);
    // Those that have seen less will hardly miss it.
    std::ranges::stable_sort(order, {}, [&](std::size_t i) {
      return std::pair(asked_[i].seen <= size, -asked_[i].missed);
    });
    constexpr double kSlack = 1e-9;
    const int most =
        static_cast<int>(std::floor((1.0 - kSurelySeen) * seeds_.count + kSlack));
    std::atomic<int> missed = 0;
    ParallelInOrder(seeds_.count, [&](int i) {
      if (missed > most) return;
      const std::size_t seed = order[static_cast<std::size_t>(i)];
      auto& asked = asked_[seed];
      if (sees_(deviation, seeds_.first + seed)) {
        asked.seen = std::min(asked.seen, size);
      } else {
        asked.missed = std::max(asked.missed, size);
        ++missed;
      }
    });
    if (missed > most) return std::nullopt;
    return seeds_.count - missed;
  }

 private:
  /// Of one seed: the smallest size that it saw, the largest that it missed.
  struct Asked {
    double seen = std::numeric_limits<double>::infinity();
    double missed = 0.0;
  };
  const SeedsOfASize seeds_;
  const SeesFault& sees_;
  std::vector<Asked> asked_;
};

/// The smallest size at which the first seed sees it, by bisection; 0 if it sees none.
int WhereFirstSees(const SizeGrid& grid, const SeedsOfASize& seeds,
                   const SeesFault& sees) {
  int seen = 0;
  int unseen = grid.last() + 1;
  while (unseen - seen > 1) {
    const int middle = (seen + unseen) / 2;
    (sees(grid.At(middle), seeds.first) ? seen : unseen) = middle;
  }
  return seen;
}

}  // namespace

SizeGrid::SizeGrid(double largest, double resolution)
    : largest_(largest),
      steps_(static_cast<int>(std::ceil(std::log(2.0) / std::log(resolution)))) {}

double SizeGrid::At(int size) const {
  return std::ldexp(largest_ * std::exp2(-static_cast<double>(size % steps_) / steps_),
                    -(size / steps_));
}

int SizeGrid::AtMost(double deviation) const {
  const double below = steps_ * std::log2(largest_ / deviation);
  return static_cast<int>(std::ceil(std::clamp<double>(below, 0, last())));
}

int SizeGrid::last() const {
  constexpr int kHalvings = 40;
  return kHalvings * steps_;
}

int CountSeen(double deviation, const SeedsOfASize& seeds, const SeesFault& sees) {
  std::atomic<int> seen = 0;
  ParallelFor(seeds.count, [&](int i) {
    if (sees(deviation, seeds.first + static_cast<std::uint64_t>(i))) ++seen;
  });
  return seen;
}

std::optional<SeenSize> SurelySeenSize(const SizeGrid& grid,
                                       std::optional<double> guess,
                                       const SeedsOfASize& seeds,
                                       const SeesFault& sees) {
  SizesOfAFault sizes(seeds, sees);
  int seen = -1;
  int unseen = grid.last() + 1;
  SeenSize smallest;
  const auto is_seen = [&](int size) {
    const std::optional<int> count = sizes.SurelySeen(grid.At(size));
    (count ? seen : unseen) = size;
    if (count) smallest = {grid.At(size), *count};
    return count.has_value();
  };
  // Strides grow slowly: what is left between is looked through one by one.
  constexpr int kOfAStride = 4;
  int tried = kOfAStride;
  int size = guess ? grid.AtMost(*guess) : WhereFirstSees(grid, seeds, sees);
  if (is_seen(size)) {
    do {
      if (size == grid.last()) return smallest;
      size = std::min(grid.last(), size + tried++ / kOfAStride);
    } while (is_seen(size));
  } else {
    do {
      if (size == 0) return std::nullopt;
      size = std::max(0, size - tried++ / kOfAStride);
    } while (!is_seen(size));
  }
  while (unseen - seen > 1) is_seen(unseen - 1);
  return smallest;
}

}  // namespace mjdiag
