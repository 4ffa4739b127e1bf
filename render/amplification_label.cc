#include "mjdiag/render/amplification_label.h"

#include <array>

#include "mjdiag/render/engineering.h"

namespace mjdiag {
namespace {

struct Group {
  JointRole role;
  JointMotion motion;
  const char* name;
};
constexpr std::array kGroups{
    Group{JointRole::kCompliant, JointMotion::kTranslation, "flexing"},
    Group{JointRole::kCompliant, JointMotion::kRotation, "twisting"},
    Group{JointRole::kDriven, JointMotion::kTranslation, "off course"},
    Group{JointRole::kDriven, JointMotion::kRotation, "off angle"}};

std::string Times(double factor) { return " \u00d7" + GroupedNumber(factor); }

// The group's factor, or one entry a joint where the user split the group.
void AddGroup(const Amplification& amplification, const Group& group,
              std::vector<std::string>& parts) {
  const auto shared = amplification.GroupFactor(group.role, group.motion);
  if (shared) {
    if (*shared != 1.0) parts.push_back(group.name + Times(*shared));
    return;
  }
  const std::vector<DrawnJoint>& joints = amplification.joints();
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const double factor = amplification.factors()[j];
    const bool in_group =
        joints[j].role == group.role && joints[j].motion == group.motion;
    if (in_group && factor != 1.0) parts.push_back(joints[j].name + Times(factor));
  }
}

}  // namespace

std::vector<std::string> AmplificationLabels(const Amplification& amplification) {
  std::vector<std::string> parts;
  for (const Group& group : kGroups) AddGroup(amplification, group, parts);
  if (parts.empty()) return {""};
  std::string list;
  for (const std::string& part : parts) {
    list += (list.empty() ? "" : " \u00b7 ") + part;
  }
  return {"motion enlarged: " + list, "enlarged: " + list, list};
}

}  // namespace mjdiag
