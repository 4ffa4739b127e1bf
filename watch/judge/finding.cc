#include "mjdiag/watch/judge/finding.h"

#include <algorithm>
#include <array>
#include <utility>

#include "mjdiag/diagnosis/twin/twin_estimator.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr std::array<std::pair<VerdictKind, const char*>, 7> kKindNames = {{
    {VerdictKind::kSettling, "settling"},
    {VerdictKind::kHealthy, "healthy"},
    {VerdictKind::kFault, "fault"},
    {VerdictKind::kUnexplained, "unexplained"},
    {VerdictKind::kDisturbance, "disturbance"},
    {VerdictKind::kNoise, "noise"},
    {VerdictKind::kResidual, "residual"},
}};

}  // namespace

const char* NameOf(VerdictKind kind) {
  return kKindNames[static_cast<std::size_t>(kind)].second;
}

VerdictKind VerdictKindOf(const std::string& name) {
  for (const auto& [kind, text] : kKindNames) {
    if (name == text) return kind;
  }
  throw InputError("verdict", "no kind '" + name + "'", "healthy, fault, ...");
}

VerdictKind KindOf(const DiagnosisResult& result) {
  if (result.by_twin && !(result.nis < kLargestNis)) {
    return VerdictKind::kUnexplained;
  }
  if (!result.detected) return VerdictKind::kHealthy;
  if (std::ranges::any_of(result.faults, &FaultVerdict::detected)) {
    return VerdictKind::kFault;
  }
  if (!result.disturbance.tones.empty()) return VerdictKind::kDisturbance;
  if (result.disturbance.noise_raised) return VerdictKind::kNoise;
  return VerdictKind::kResidual;
}

void Stretch::Add(double value) {
  least = count == 0 ? value : std::min(least, value);
  most = count == 0 ? value : std::max(most, value);
  sum += value;
  ++count;
}

}  // namespace mjdiag
