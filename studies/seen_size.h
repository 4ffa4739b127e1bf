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

/// The sizes that are tried, largest * 2^(-k / steps): half of one is another, and what
/// one way of seeing has looked at serves the others.
class SizeGrid {
 public:
  /// @param largest     deviation, of the sign that is looked for
  /// @param resolution  factor between sizes, at most
  SizeGrid(double largest, double resolution);

  double At(int size) const;
  /// The largest that is not above that.
  int AtMost(double deviation) const;
  /// No sensor of these machines sees a part in 1e12.
  int last() const;

 private:
  double largest_;
  int steps_;
};

/// How many of the seeds see it.
int CountSeen(double deviation, const SeedsOfASize& seeds, const SeesFault& sees);

struct SeenSize {
  double deviation = 0.0;
  int seeds = 0;  ///< that see it
};

/// The smallest size of the grid that is seen by kSurelySeen of the seeds; nullopt if its
/// largest is not and nothing below it that was tried. A size that is seen asks all seeds,
/// one that is not only few, as those that missed larger ones are asked first: so it is
/// looked for from below.
/// @param guess  where to begin, of the sign of the grid; none: where the first seed sees it
std::optional<SeenSize> SurelySeenSize(const SizeGrid& grid,
                                       std::optional<double> guess,
                                       const SeedsOfASize& seeds,
                                       const SeesFault& sees);

}  // namespace mjdiag
