#include "mjdiag/report/excitation_json.h"

namespace mjdiag {

nlohmann::json ToJson(const AxisLimits& limits) {
  nlohmann::json document;
  for (const auto& [name, limit] : kAxisLimits) document[name] = limits.*limit;
  return document;
}

nlohmann::json ToJson(const Machine& machine, const MotionDesign& design) {
  nlohmann::json document = {
      {"schema", "mjdiag.excitation/1"},
      {"setup", machine.setup().name},
      {"trajectory", design.trajectory.name},
      {"duration", design.trajectory.duration},
      {"gain", design.Gain()},
      {"stopped", design.stopped},
      {"moves", {{"of", nullptr}, {"times", design.share_of_moves}}},
      {"tones", nlohmann::json::array()},
      {"unknowns", nlohmann::json::array()},
      {"limits", nlohmann::json::object()},
      {"peaks", nlohmann::json::object()}};
  if (!design.moves_of.empty()) document["moves"]["of"] = design.moves_of;
  for (const ReferenceTone& tone : design.trajectory.tones) {
    document["tones"].push_back({{"axis", tone.axis},
                                 {"frequency", tone.frequency},
                                 {"amplitude", tone.amplitude},
                                 {"phase", tone.phase}});
  }
  for (std::size_t i = 0; i < design.unknowns.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    document["unknowns"].push_back({{"name", design.unknowns[i]},
                                    {"wanted", static_cast<bool>(design.wanted[i])},
                                    {"sd_before", design.before[at]},
                                    {"sd_after", design.after[at]}});
  }
  for (std::size_t i = 0; i < design.limits.size(); ++i) {
    const std::string& axis = machine.setup().control.axes[i].name;
    document["limits"][axis] = ToJson(design.limits[i]);
    document["peaks"][axis] = ToJson(design.peaks[i]);
  }
  return document;
}

}  // namespace mjdiag
