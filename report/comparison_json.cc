#include "mjdiag/report/comparison_json.h"

#include <cmath>

namespace mjdiag {
namespace {

nlohmann::json FiniteOrNull(double value) {
  if (!std::isfinite(value)) return nullptr;
  return value;
}

nlohmann::json ToJson(const ChannelMismatch& channel) {
  return {{"rms", channel.rms},
          {"unit", channel.unit},
          {"mae", channel.mae},
          {"fit_percent", FiniteOrNull(channel.fit_percent)},
          {"relative_error_percent", FiniteOrNull(channel.relative_error_percent)},
          {"noise_floor", channel.noise_floor.rms},
          {"exceeds_noise", channel.exceeds_noise},
          {"peak", channel.peak},
          {"p_value", channel.p_value},
          {"worst_window",
           {{"start", channel.worst.start},
            {"duration", channel.worst.duration},
            {"rms", channel.worst.rms}}}};
}

/// What the filter says that follows the motion.
void AddFollowed(const Comparison& comparison, nlohmann::json& document) {
  document["deviance"] = FiniteOrNull(*comparison.deviance);
  document["prediction"]["horizons"] = comparison.prediction.horizons;
  document["prediction"]["rms"] = nlohmann::json::object();
  for (const Prediction::Sensor& sensor : comparison.prediction.sensors) {
    auto& rms = document["prediction"]["rms"][sensor.channel];
    rms = nlohmann::json::array();
    for (const double value : sensor.rms) rms.push_back(FiniteOrNull(value));
  }
  document["missing_force"] = nlohmann::json::object();
  for (const DisturbanceEstimate& force : comparison.missing_force) {
    document["missing_force"][force.joint] = force.rms;
  }
}

}  // namespace

nlohmann::json ToJson(const Comparison& comparison) {
  nlohmann::json json;
  json["schema"] = "mjdiag.compare/1";
  json["setup"] = comparison.setup;
  json["closed_loop"] = comparison.closed_loop;
  json["samples"] = comparison.measured.samples();
  json["sample_time"] = comparison.measured.sample_time();
  json["skip_samples"] = comparison.options.skip_samples;
  json["level"] = comparison.options.level;
  json["exceeds_noise"] = comparison.exceeds_noise();
  json["falls"] = comparison.falls;
  json["channels"] = nlohmann::json::object();
  if (comparison.deviance) AddFollowed(comparison, json);
  for (const ChannelMismatch& channel : comparison.channels) {
    json["channels"][channel.name] = ToJson(channel);
  }
  json["derived"] = nlohmann::json::object();
  for (const DerivedMismatch& derived : comparison.derived) {
    json["derived"][derived.name] = FiniteOrNull(derived.relative_error_percent);
  }
  json["not_measured"] = comparison.not_measured;
  return json;
}

}  // namespace mjdiag
