#include "mjdiag/studies/random_fault.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "mjdiag/plugin/effects/draw.h"

namespace mjdiag {
namespace {

/// So that draws are not the numbers that the noise is made of.
constexpr std::uint64_t kOwnStream = 0x9e3779b97f4a7c15ULL;

/// Deviations that are drawn of a fault: from `least` to the farthest on either side; 0:
/// it has none on that side.
struct Sides {
  double least = 0.0;
  double below = 0.0;
  double above = 0.0;
};

Sides SidesOf(const PlanAxis& axis) {
  Sides sides;
  for (const auto& [from, to] : axis.ranges) {
    (to < axis.healthy ? sides.below : sides.above) = std::abs(to - axis.healthy);
  }
  sides.least = std::abs(axis.ranges.front().from - axis.healthy);
  return sides;
}

}  // namespace

RandomDraw DrawFaults(const AskNames& ask, const std::vector<PlanAxis>& axes,
                      Eigen::Index samples, std::uint64_t seed) {
  Random random(seed ^ kOwnStream);
  RandomDraw draw;
  draw.seed = seed;
  const bool healthy = random.Uniform(0.0, 1.0) < ask.healthy;
  const auto most = std::min(static_cast<std::size_t>(ask.most), axes.size());
  const std::size_t count = healthy ? 0 : 1 + random.Index(most);
  std::vector<std::size_t> places(axes.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  for (std::size_t i = 0; i < count; ++i) {
    std::swap(places[i], places[i + random.Index(axes.size() - i)]);
  }
  std::sort(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const PlanAxis& axis = axes[places[i]];
    const auto [least, below, above] = SidesOf(axis);
    const bool either = below > 0.0 && above > 0.0;
    const double sign = either ? random.Sign() : above > 0.0 ? 1.0 : -1.0;
    const double size = random.Log(least, sign > 0.0 ? above : below);
    draw.faults.push_back({&axis, axis.healthy + sign * size});
  }
  if (random.Uniform(0.0, 1.0) >= ask.from_rest) {
    const Eigen::Index half = samples / 2;
    draw.from = static_cast<Eigen::Index>(
        random.Index(static_cast<std::size_t>(std::max<Eigen::Index>(1, half))));
  }
  return draw;
}

std::string ListFaults(const std::vector<DrawnAxis>& faults) {
  std::string text;
  for (const DrawnAxis& fault : faults) {
    std::array<char, 32> size{};
    std::snprintf(size.data(), size.size(), " %+.3g",
                  fault.value - fault.axis->healthy);
    text += (text.empty() ? "" : ", ") + fault.axis->name + size.data();
  }
  return text.empty() ? "none" : text;
}

}  // namespace mjdiag
