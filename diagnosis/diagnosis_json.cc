#include "mjdiag/diagnosis/diagnosis_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace mjdiag {
namespace {

nlohmann::json OrNull(const std::optional<double>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

nlohmann::json OrNull(double value) {
  return std::isnan(value) ? nlohmann::json() : nlohmann::json(value);
}

nlohmann::json Faults(const std::vector<FaultVerdict>& verdicts) {
  nlohmann::json faults = nlohmann::json::array();
  for (const FaultVerdict& fault : verdicts) {
    faults.push_back({
        {"name", fault.name},
        {"value", fault.value},
        {"deviation", fault.deviation},
        {"sd", fault.sd},
        {"ci95", {fault.ci95.min, fault.ci95.max}},
        {"detected", fault.detected},
        {"alarm", OrNull(fault.alarm)},
        {"alarm_with_more_records", OrNull(fault.best_alarm)},
    });
  }
  return faults;
}

nlohmann::json Disturbance(const DisturbanceReport& report) {
  nlohmann::json peaks = nlohmann::json::array();
  for (const DisturbanceTone& tone : report.tones) {
    peaks.push_back({{"frequency", tone.frequency},
                     {"frequency_sd", tone.frequency_sd},
                     {"psd", tone.psd},
                     {"threshold", tone.threshold},
                     {"amplitude", tone.amplitude},
                     {"amplitude_sd", tone.amplitude_sd}});
  }
  return {{"peaks", peaks},
          {"total", report.total},
          {"total_threshold", report.total_threshold},
          {"noise_ratio", report.noise_ratio},
          {"noise_raised", report.noise_raised}};
}

}  // namespace

std::string DiagnosisJson(const DiagnosisResult& result) {
  const nlohmann::json document{
      {"schema", "mjdiag.diagnosis/1"},
      {"setup", result.setup},
      {"samples", result.samples},
      {"sample_time", result.sample_time},
      {"detected", result.detected},
      {"first_detection", OrNull(result.first_detection)},
      {"lasting_since", OrNull(result.lasting)},
      {"residual",
       {{"min", result.residual.min},
        {"max", result.residual.max},
        {"threshold_min", result.limits.min},
        {"threshold_max", result.limits.max}}},
      {"faults", Faults(result.faults)},
      {"misfit", result.by_twin ? nlohmann::json(result.nis) : nlohmann::json()},
      {"model_records", result.model_records},
      {"disturbance", Disturbance(result.disturbance)}};
  return document.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace mjdiag
