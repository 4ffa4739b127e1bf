#include "mjdiag/plugin/plant/mujoco_model.h"

#include <mujoco/mjxmacro.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <mutex>
#include <regex>
#include <string>
#include <system_error>
#include <vector>

#include "mjdiag/plugin/plant/newer_mjcf.h"
#include "mjdiag/plugin/plant/scenery.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/listed.h"

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

/// Whether a copy of `model` fits into the memory of `spare`, out of which scenery may
/// have been dropped since (DropScenery).
bool Fits(const mjModel& model, const mjModel& spare) {
  mjModel sizes = spare;
  sizes.ngeom = model.ngeom;
  sizes.ncam = model.ncam;
  sizes.nlight = model.nlight;
#define X(name) \
  if (sizes.name != model.name) return false;
  MJMODEL_INTS
#undef X
  return true;
}

/// Models that nobody needs any more, for copies to be written into. Faults and causes are
/// copies of a machine, made and dropped by the thousand; with textures or meshes most of
/// the time of one is fresh memory, which the system clears and MuJoCo clears again.
class SpareModels {
 public:
  /// One with the sizes of `like`, or nullptr.
  mjModel* Take(const mjModel& like) {
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(spares_.rbegin(), spares_.rend(),
                                    [&](mjModel* spare) { return Fits(like, *spare); });
    if (found == spares_.rend()) return nullptr;
    mjModel* model = *found;
    spares_.erase(std::next(found).base());
    bytes_ -= Bytes(*model);
    return model;
  }

  /// Takes it over. The oldest make room.
  void Keep(mjModel* model) {
    const std::lock_guard lock(mutex_);
    spares_.push_back(model);
    bytes_ += Bytes(*model);
    while (bytes_ > kMostBytes || spares_.size() > kMostModels) {
      bytes_ -= Bytes(*spares_.front());
      mj_deleteModel(spares_.front());
      spares_.erase(spares_.begin());
    }
  }

 private:
  static constexpr std::size_t kMostBytes = 64u << 20;
  static constexpr std::size_t kMostModels = 16;

  static std::size_t Bytes(const mjModel& model) {
    return static_cast<std::size_t>(model.nbuffer);
  }

  std::mutex mutex_;
  std::vector<mjModel*> spares_;
  std::size_t bytes_ = 0;
};

/// Never destroyed: static machines give their models back after it would be.
SpareModels& Spares() {
  static SpareModels& spares = *new SpareModels;
  return spares;
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

/// What a model is to have of a kind of which it has none.
std::string ExpectedOf(const mjModel& model, mjtObj kind) {
  if (model.nu > 0 || model.nsensor > 0) {
    return std::string("one <") + mju_type2Str(kind) + "> in its MJCF";
  }
  return "an MJCF with <actuator> and <sensor>, of which a URDF has none: `mjdiag "
         "init` "
         "writes one";
}

/// Elements that a setup can name, and what to do about those that it cannot.
std::string NamedOnes(const mjModel& model, mjtObj kind) {
  std::vector<std::string> named;
  std::vector<std::string> nameless;
  for (int id = 0; id < Count(model, kind); ++id) {
    const char* name = mj_id2name(&model, kind, id);
    (name != nullptr && name[0] != '\0' ? named : nameless)
        .push_back(ElementName(model, kind, id));
  }
  std::string words = named.empty() ? "" : "one of " + Listed(named);
  if (nameless.empty()) return words;
  return words + (words.empty() ? "" : ", or ") + "a name in the MJCF for " +
         Listed(nameless) + ": `mjdiag init` writes a copy with names";
}

}  // namespace

ModelPtr LoadModel(const std::filesystem::path& mjcf) {
  InstallHandlers();
  // Which MuJoCo says as an error of its parser.
  std::error_code error;
  const auto status = std::filesystem::status(mjcf, error);
  if (!std::filesystem::exists(status)) {
    throw InputError(mjcf.string(), "cannot be opened (" + error.message() + ")",
                     "an MJCF or URDF file");
  }
  if (std::filesystem::is_directory(status)) {
    throw InputError(mjcf.string(), "is a folder", "an MJCF or URDF file");
  }
  std::array<char, 1024> report{};
  ModelPtr model(mj_loadXML(mjcf.c_str(), nullptr, report.data(), report.size()));
  if (!model) {
    if (const std::string words = DescribeNewer(NewerThanThisMujoco(mjcf));
        !words.empty()) {
      throw InputError(mjcf.string(), words,
                       "a model for it, with what stands behind the colons");
    }
    throw MjcfError(mjcf, report.data());
  }
  DropUnusedRows(*model);
  return model;
}

void ModelDeleter::operator()(mjModel* model) const { Spares().Keep(model); }

ModelPtr CopyModel(const mjModel& model) {
  return ModelPtr(mj_copyModel(Spares().Take(model), &model));
}

DataPtr MakeData(const mjModel& model) { return DataPtr(mj_makeData(&model)); }

int FindElement(const mjModel& model, mjtObj kind, const std::string& name) {
  const int id = mj_name2id(&model, kind, name.c_str());
  if (id >= 0) return id;
  const std::string sort = mju_type2Str(kind);
  const std::string missing = "no " + sort + " named \"" + name + "\"";
  if (Count(model, kind) == 0) {
    throw InputError(model.names, missing + ", and no " + sort + " at all",
                     ExpectedOf(model, kind));
  }
  throw InputError(model.names, missing, NamedOnes(model, kind));
}

std::string ElementName(const mjModel& model, mjtObj kind, int id) {
  const char* name = mj_id2name(&model, kind, id);
  if (name != nullptr && name[0] != '\0') return name;
  return std::string(mju_type2Str(kind)) + " " + std::to_string(id);
}

}  // namespace mjdiag
