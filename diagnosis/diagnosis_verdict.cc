#include "mjdiag/diagnosis/diagnosis_verdict.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "mjdiag/diagnosis/twin/twin_estimator.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

double Significance(const FaultVerdict& fault) {
  return fault.deviation == 0.0 ? 0.0 : std::abs(fault.deviation) / fault.sd;
}

/// Of a deviation: "2.1 %".
std::string Percent(double deviation) {
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%.2g %%", 100.0 * deviation);
  return digits.data();
}

std::string HealthyText(const FaultVerdict& fault) {
  return ParameterText(fault.value - fault.deviation);
}

bool ReadsAsHealthy(const FaultVerdict& fault) {
  return ParameterText(fault.value) == HealthyText(fault);
}

std::string WithDeviation(const FaultVerdict& fault) {
  return fault.name + " = " + HealthyText(fault) +
         (fault.deviation < 0.0 ? " - " : " + ") +
         FormatNumber(std::abs(fault.deviation));
}

/// "zeta_x = 1.2, eta_y = 0.98"; empty without a detected fault.
std::string NamedFaults(const std::vector<FaultVerdict>& ranked, bool by_twin) {
  if (ranked.empty() || !ranked.front().detected) return "";
  const double least =
      by_twin ? 0.0 : kNamedSignificance * Significance(ranked.front());
  std::string names;
  for (const FaultVerdict& fault : ranked) {
    if (!fault.detected || Significance(fault) < least) break;
    if (ReadsAsHealthy(fault)) continue;
    names +=
        (names.empty() ? "" : ", ") + fault.name + " = " + ParameterText(fault.value);
  }
  return names.empty() ? WithDeviation(ranked.front()) : names;
}

}  // namespace

std::vector<FaultVerdict> RankedFaults(const DiagnosisResult& result) {
  std::vector<FaultVerdict> faults = result.faults;
  const auto end_of_detected =
      std::stable_partition(faults.begin(), faults.end(),
                            [](const FaultVerdict& fault) { return fault.detected; });
  std::stable_sort(faults.begin(), end_of_detected,
                   [](const FaultVerdict& a, const FaultVerdict& b) {
                     return Significance(a) > Significance(b);
                   });
  return faults;
}

std::string ParameterText(double value) {
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%.5g", value);
  return digits.data();
}

std::string DetectionText(const FaultVerdict& fault) {
  return fault.detected ? "yes" : "no";
}

std::string ModelText(const DiagnosisResult& result) {
  if (result.model_records == 0) return "";
  std::string now;
  std::string best;
  for (const FaultVerdict& fault : result.faults) {
    if (std::isnan(fault.alarm)) continue;
    const std::string comma = now.empty() ? "" : ", ";
    now += comma + fault.name + " " + Percent(fault.alarm);
    best += comma + fault.name + " " + Percent(fault.best_alarm);
  }
  const bool one = result.model_records == 1;
  return "The model is not quite the machine: parts of the healthy record" +
         std::string(one ? "" : "s") +
         " contradict each other. A fault is named from " + now +
         " on; with more healthy records, of other motions, from " + best +
         " on. How motions differ that no healthy record has shown is not known.";
}

std::string DiagnosisVerdict(const DiagnosisResult& result) {
  if (result.by_twin && !(result.nis < kLargestNis)) {
    return "Neither the healthy machine nor its faults explain this run: what is left "
           "has " +
           FormatNumber(std::sqrt(result.nis)) + " times the noise.";
  }
  if (!result.detected) return "Nothing is wrong that this run shows.";
  const std::string faults = NamedFaults(RankedFaults(result), result.by_twin);
  if (!faults.empty()) return "Detected: " + faults + ".";
  if (!result.disturbance.tones.empty()) return "A periodic disturbance is there.";
  if (result.disturbance.noise_raised) return "The sensors are noisier than usual.";
  return "The residual has left its thresholds.";
}

}  // namespace mjdiag
