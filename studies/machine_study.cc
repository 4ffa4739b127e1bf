#include "mjdiag/studies/machine_study.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/mujoco_model.h"

namespace mjdiag {
namespace {

bool IsDisturbance(const Setup& setup, const std::string& name) {
  return std::any_of(setup.disturbances.begin(), setup.disturbances.end(),
                     [&](const MultisineSetup& source) { return source.name == name; });
}

}  // namespace

RunOptions WithFaults(const Setup& setup, const mjModel& plant,
                      const std::vector<SizedFault>& faults, std::uint64_t seed) {
  RunOptions options;
  options.seed = seed;
  const ModelPtr trial = CopyModel(plant);
  for (const SizedFault& fault : faults) {
    if (IsDisturbance(setup, fault.name)) {
      options.disturbances[fault.name] = fault.value;
    } else {
      ApplyFault(*trial, {fault.name, fault.value});
      options.faults.push_back({fault.name, fault.value});
    }
  }
  return options;
}

double HealthyValue(const Setup& setup, const std::string& fault) {
  return IsDisturbance(setup, fault) ? 0.0 : 1.0;
}

Excitation DefaultMotion(const Setup& setup) {
  return FollowTrajectory(setup, setup.FindTrajectory(setup.default_trajectory));
}

PreparedDiagnosis LinearDiagnosis(const Setup& setup, const mjModel& plant) {
  DiagnosisSource source;
  source.nominal.linear = true;
  return PrepareDiagnosis(setup, plant, source);
}

Detection Look(const PreparedDiagnosis& prepared, const Record& record,
               const std::string& fault) {
  const DiagnosisResult result =
      Conclude(RecordDiagnosis(prepared.design, record, prepared.baseline));
  Detection detection{result.first_detection, result.disturbance.disturbed, false, 0.0};
  for (const FaultVerdict& verdict : result.faults) {
    if (verdict.name != fault) continue;
    detection.estimate = verdict.detected;
    detection.value = verdict.value;
  }
  return detection;
}

std::optional<double> SmallestDeviation(double seen, double resolution,
                                        const std::function<bool(double)>& detected) {
  if (!detected(seen)) return std::nullopt;
  // No sensor of these machines sees a part in 1e12.
  constexpr double kNothing = 1e-12;
  double low = std::log(kNothing * std::abs(seen));
  double high = std::log(std::abs(seen));
  while (high - low > std::log(resolution)) {
    const double middle = 0.5 * (low + high);
    (detected(std::copysign(std::exp(middle), seen)) ? high : low) = middle;
  }
  return std::copysign(std::exp(high), seen);
}

std::pair<int, int> BinomialBand(int runs, double probability, double confidence) {
  const double tail = 0.5 * (1.0 - confidence);
  std::vector<double> cumulative;
  double sum = 0.0;
  for (int k = 0; k <= runs; ++k) {
    const double log_choose =
        std::lgamma(runs + 1.0) - std::lgamma(k + 1.0) - std::lgamma(runs - k + 1.0);
    sum += std::exp(log_choose + k * std::log(probability) +
                    (runs - k) * std::log1p(-probability));
    cumulative.push_back(sum);
  }
  const auto first = [&](double level) {
    return static_cast<int>(
        std::lower_bound(cumulative.begin(), cumulative.end(), level) -
        cumulative.begin());
  };
  return {first(tail), std::min(runs, first(1.0 - tail))};
}

}  // namespace mjdiag
