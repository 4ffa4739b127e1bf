#include "mjdiag/plugin/plant/mujoco_model.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <regex>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

void ThrowMujocoError(const char* message) {
  throw NumericalError(std::string("MuJoCo: ") + message);
}

// Warnings are counted in mjData.warning, where Simulate looks for them. MuJoCo's own
// way is to print them and to write a log into the working folder.
void IgnoreMujocoWarning(const char*) {}

void InstallHandlers() {
  static std::once_flag once;
  std::call_once(once, [] {
    mju_user_error = ThrowMujocoError;
    mju_user_warning = IgnoreMujocoWarning;
  });
}

std::string OneLine(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\0')) text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// MuJoCo writes the place behind the message, as "..., line 12, column 3",
/// "line = 12" or "(Line 12)"; here it goes in front, as "file:12".
InputError MjcfError(const std::filesystem::path& mjcf, const std::string& report) {
  static const std::regex kLine("line[:= ]+([0-9]+)", std::regex::icase);
  std::string where = mjcf.string();
  std::smatch match;
  if (std::regex_search(report, match, kLine)) where += ":" + match[1].str();
  return {where, OneLine(report), "a valid MJCF model"};
}

/// Number of elements of a kind.
int Count(const mjModel& model, mjtObj kind) {
  switch (kind) {
    case mjOBJ_BODY:
      return model.nbody;
    case mjOBJ_JOINT:
      return model.njnt;
    case mjOBJ_GEOM:
      return model.ngeom;
    case mjOBJ_SITE:
      return model.nsite;
    case mjOBJ_CAMERA:
      return model.ncam;
    case mjOBJ_TENDON:
      return model.ntendon;
    case mjOBJ_ACTUATOR:
      return model.nu;
    case mjOBJ_SENSOR:
      return model.nsensor;
    case mjOBJ_NUMERIC:
      return model.nnumeric;
    case mjOBJ_TEXT:
      return model.ntext;
    default:
      return 0;
  }
}

std::string NamesOf(const mjModel& model, mjtObj kind) {
  std::string names;
  for (int id = 0; id < Count(model, kind); ++id) {
    if (!names.empty()) names += ", ";
    names += ElementName(model, kind, id);
  }
  return names.empty() ? "none" : names;
}

}  // namespace

ModelPtr LoadModel(const std::filesystem::path& mjcf) {
  InstallHandlers();
  std::array<char, 1024> report{};
  ModelPtr model(mj_loadXML(mjcf.c_str(), nullptr, report.data(), report.size()));
  if (!model) throw MjcfError(mjcf, report.data());
  return model;
}

ModelPtr CopyModel(const mjModel& model) {
  return ModelPtr(mj_copyModel(nullptr, &model));
}

DataPtr MakeData(const mjModel& model) { return DataPtr(mj_makeData(&model)); }

int FindElement(const mjModel& model, mjtObj kind, const std::string& name) {
  const int id = mj_name2id(&model, kind, name.c_str());
  if (id >= 0) return id;
  throw InputError(model.names,
                   std::string("no ") + mju_type2Str(kind) + " named \"" + name + "\"",
                   "one of " + NamesOf(model, kind));
}

std::string ElementName(const mjModel& model, mjtObj kind, int id) {
  const char* name = mj_id2name(&model, kind, id);
  if (name != nullptr && name[0] != '\0') return name;
  return std::string(mju_type2Str(kind)) + " " + std::to_string(id);
}

}  // namespace mjdiag
