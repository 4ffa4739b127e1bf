#include "mjdiag/render/diagnosis_overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

void Require(bool good, const std::string& what, const std::string& expected) {
  if (!good) throw InputError("diagnosis", what, expected);
}

}  // namespace

void CheckOverlay(const DiagnosisOverlay& overlay, std::size_t runs) {
  Require(overlay.run < runs, "of run " + std::to_string(overlay.run),
          "the index of one of the " + std::to_string(runs) + " runs");
  Require(overlay.residual.channels().size() == 1 && overlay.residual.samples() > 0,
          "no residual", "a record with one channel");
  Require(overlay.limit_low < overlay.limit_high,
          "limits " + std::to_string(overlay.limit_low) + " to " +
              std::to_string(overlay.limit_high),
          "two finite limits, the lower one first");
  for (const EstimateHistory& history : overlay.estimates) {
    const Eigen::Index samples = overlay.estimate_time.size();
    Require(history.value.size() == samples && history.half_width.size() == samples,
            "estimates of \"" + history.name + "\"",
            "one at each of the " + std::to_string(samples) + " times");
  }
}

std::optional<Eigen::Index> EstimateAt(const DiagnosisOverlay& overlay, double time) {
  const auto& times = overlay.estimate_time;
  // The slack lets a picture at an estimate's own time show it.
  const double slack = 1e-6 * overlay.residual.sample_time();
  const auto after = std::upper_bound(times.begin(), times.end(), time + slack);
  if (after == times.begin()) return std::nullopt;
  return after - times.begin() - 1;
}

std::string DetectionText(const DiagnosisOverlay& overlay) {
  if (!overlay.detection) return "";
  const double tick = overlay.residual.sample_time();
  const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(tick))), 0, 9);
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f s", decimals, *overlay.detection);
  return text.data();
}

}  // namespace mjdiag
