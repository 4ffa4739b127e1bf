#include "mjdiag/studies/random_fault.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "mjdiag/plugin/effects/draw.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr double kHealthyShare = 0.2;
constexpr double kFromRest = 0.25;
constexpr std::size_t kMostFaults = 3;
/// So that draws are not the numbers that the noise is made of.
constexpr std::uint64_t kOwnStream = 0x9e3779b97f4a7c15ULL;

const std::string& NameOf(const std::pair<std::string, double>& fault) {
  return fault.first;
}

}  // namespace

std::vector<DrawRange> DrawRanges(const Setup& setup) {
  const auto& least = setup.Study("random_least").values;
  std::vector<DrawRange> ranges;
  for (const auto& [name, value] : least) {
    const double healthy = HealthyValue(setup, name);
    ranges.push_back({name, healthy, std::abs(value - healthy), 0.0, 0.0});
  }
  for (const char* side : {"random_low", "random_high"}) {
    const auto& values = setup.Study(side).values;
    for (DrawRange& range : ranges) {
      const auto found = std::ranges::find(values, range.name, NameOf);
      if (found == values.end()) {
        throw InputError(std::string("studies.") + side, "lacks '" + range.name + "'",
                         "the faults of random_least");
      }
      const double away = found->second - range.healthy;
      range.below = std::max(range.below, -away);
      range.above = std::max(range.above, away);
    }
  }
  for (const DrawRange& range : ranges) {
    if (range.least > 0.0 && range.least < std::max(range.below, range.above)) continue;
    throw InputError("studies.random_least." + range.name, "leaves nothing to be drawn",
                     "a value between healthy and random_low or random_high");
  }
  return ranges;
}

RandomDraw DrawFaults(const std::vector<DrawRange>& ranges, Eigen::Index samples,
                      std::uint64_t seed) {
  Random random(seed ^ kOwnStream);
  RandomDraw draw;
  draw.seed = seed;
  const bool healthy = random.Uniform(0.0, 1.0) < kHealthyShare;
  const std::size_t count =
      healthy ? 0 : 1 + random.Index(std::min(kMostFaults, ranges.size()));
  std::vector<std::size_t> places(ranges.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  for (std::size_t i = 0; i < count; ++i) {
    std::swap(places[i], places[i + random.Index(ranges.size() - i)]);
  }
  std::sort(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const DrawRange& range = ranges[places[i]];
    const bool down = range.below > range.least;
    const bool up = range.above > range.least;
    const double sign = down && up ? random.Sign() : up ? 1.0 : -1.0;
    const double size = random.Log(range.least, sign > 0.0 ? range.above : range.below);
    draw.faults.push_back({range.name, range.healthy + sign * size});
  }
  if (random.Uniform(0.0, 1.0) >= kFromRest) {
    const Eigen::Index half = samples / 2;
    draw.from = static_cast<Eigen::Index>(
        random.Index(static_cast<std::size_t>(std::max<Eigen::Index>(1, half))));
  }
  return draw;
}

std::string ListFaults(const Setup& setup, const std::vector<SizedFault>& faults) {
  std::string text;
  for (const SizedFault& fault : faults) {
    std::array<char, 32> size{};
    std::snprintf(size.data(), size.size(), " %+.3g",
                  fault.value - HealthyValue(setup, fault.name));
    text += (text.empty() ? "" : ", ") + fault.name + size.data();
  }
  return text.empty() ? "none" : text;
}

}  // namespace mjdiag
