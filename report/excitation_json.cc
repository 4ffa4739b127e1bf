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

nlohmann::json ToJson(const Machine& machine, const JointMotionDesign& design) {
  nlohmann::json document = {
      {"schema", "mjdiag.joint_excitation/1"},
      {"setup", machine.setup().name},
      {"duration",
       design.sample_time * static_cast<double>(design.position.cols() - 1)},
      {"highest_frequency", design.highest_frequency},
      {"condition_before", design.condition_before},
      {"condition_after", design.condition_after},
      {"bandwidth", design.bandwidth},
      {"stopped", design.stopped},
      {"numbers", nlohmann::json::array()},
      {"untold", design.untold},
      {"joints", nlohmann::json::object()}};
  for (std::size_t i = 0; i < design.numbers.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    document["numbers"].push_back({{"name", design.numbers[i]},
                                   {"unit", design.units[i]},
                                   {"sd_before", design.before[at]},
                                   {"sd_after", design.after[at]}});
  }
  for (std::size_t j = 0; j < design.joints.size(); ++j) {
    nlohmann::json& joint = document["joints"][design.joints[j]];
    joint["noise"] = design.noise[static_cast<Eigen::Index>(j)];
    joint["limits"] = ToJson(design.limits[j]);
    joint["peaks"] = ToJson(design.peaks[j]);
  }
  return document;
}

}  // namespace mjdiag
