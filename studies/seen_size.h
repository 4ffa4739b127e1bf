#pragma once
// How small a fault is seen, and how surely: over many seeds, each of which is another
// run with other noise.

#include <cstdint>
#include <functional>
#include <optional>

namespace mjdiag {

/// Whether a fault of that deviation from healthy is seen in the run of that seed.
using SeesFault = std::function<bool(double deviation, std::uint64_t seed)>;

struct SeedsOfASize {
  int count = 40;
  std::uint64_t first = 1;
};

/// The share of seeds with which a fault has to be seen to count as seen.
inline constexpr double kSurelySeen = 0.95;

/// How many of the seeds see it.
int CountSeen(double deviation, const SeedsOfASize& seeds, const SeesFault& sees);

/// How many of them do if they are at least kSurelySeen of all; ends as soon as they
/// cannot be.
std::optional<int> SurelySeen(double deviation, const SeedsOfASize& seeds,
                              const SeesFault& sees);

struct SeenSize {
  double deviation = 0.0;
  int seeds = 0;  ///< that see it
};

/// The smallest deviation that is surely seen, by doubling or halving and then bisection
/// of its logarithm, accurate to a factor of `resolution`; nullopt if `largest` is not
/// surely seen and nothing below it that was tried.
/// @param largest  deviation, of the sign that is looked for
/// @param guess    where to begin, of that sign; none: where the first seed sees it
std::optional<SeenSize> SurelySeenSize(double largest, std::optional<double> guess,
                                       double resolution, const SeedsOfASize& seeds,
                                       const SeesFault& sees);

}  // namespace mjdiag
