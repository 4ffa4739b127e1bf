#include "python/machine_source.h"

#include <mujoco/mujoco.h>

#include <cmath>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"
#include "python/arrays.h"
#include "python/record.h"

namespace mjdiag::python {

namespace fs = std::filesystem;
namespace py = pybind11;

// JSON has the same texts and escapes.
std::string TomlText(const std::string& key, py::handle value) {
  if (py::isinstance<py::bool_>(value)) return py::cast<bool>(value) ? "true" : "false";
  if (py::isinstance<py::int_>(value)) return py::str(value);
  if (py::isinstance<py::float_>(value))
    return py::repr(py::float_(py::cast<double>(value)));
  if (py::isinstance<py::str>(value)) {
    return py::str(py::module_::import("json").attr("dumps")(
        value, py::arg("ensure_ascii") = false));
  }
  if (py::hasattr(value, "tolist")) return TomlText(key, value.attr("tolist")());
  std::string text;
  if (py::isinstance<py::dict>(value)) {
    for (const auto& [name, item] : py::reinterpret_borrow<py::dict>(value)) {
      text += (text.empty() ? "" : ", ") + std::string(py::str(name)) + " = " +
              TomlText(key, item);
    }
    return "{ " + text + " }";
  }
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
    for (const py::handle item : value) {
      text += (text.empty() ? "" : ", ") + TomlText(key, item);
    }
    return "[" + text + "]";
  }
  throw InputError(key, KindOf(value),
                   "a number, a text, a truth value, or a list or dict of such");
}

namespace {

std::vector<std::string> OverridesOf(const py::object& set) {
  std::vector<std::string> overrides;
  if (set.is_none()) return overrides;
  if (!py::isinstance<py::dict>(set)) {
    throw InputError("set", KindOf(set),
                     "a dict of keys of the setup, {\"physics.gravity\": False}");
  }
  for (const auto& [key, value] : py::reinterpret_borrow<py::dict>(set)) {
    const std::string name = py::str(key);
    overrides.push_back(name + "=" + TomlText("set: " + name, value));
  }
  return overrides;
}

bool IsMjcfText(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != text.npos && text[first] == '<';
}

std::string NameOf(const mjModel& model, mjtObj kind, int id) {
  const char* name = mj_id2name(&model, kind, id);
  return name == nullptr ? "" : name;
}

/// Of a sensor of one number; empty for others.
std::string SensorUnit(const mjModel& model, int sensor) {
  const int object = model.sensor_objid[sensor];
  const auto unit = [&](const char* slide, const char* hinge) {
    return std::string(model.jnt_type[object] == mjJNT_HINGE ? hinge : slide);
  };
  switch (model.sensor_type[sensor]) {
    case mjSENS_JOINTPOS:
      return unit("m", "rad");
    case mjSENS_JOINTVEL:
      return unit("m/s", "rad/s");
    case mjSENS_TENDONPOS:
      return "m";
    case mjSENS_TENDONVEL:
      return "m/s";
    default:
      return "";
  }
}

/// "1" of an actuator with a gear, whose control is no force.
std::string ActuatorUnit(const mjModel& model, int actuator) {
  if (*RowOf(model.actuator_gear, 6, actuator) != 1.0) return "1";
  const bool hinge =
      model.actuator_trntype[actuator] == mjTRN_JOINT &&
      model.jnt_type[*RowOf(model.actuator_trnid, 2, actuator)] == mjJNT_HINGE;
  return hinge ? "N m" : "N";
}

std::string ChannelText(const std::string& kind, const std::string& name,
                        const std::string& unit) {
  return "\n[" + kind + "." + name + "]\nelement = \"" + name + "\"\nunit = \"" + unit +
         "\"\n";
}

/// A setup of the MJCF alone, open loop.
/// @param plant  where it is, from the setup
std::string SetupOf(const fs::path& mjcf, const fs::path& plant) {
  const ModelPtr model = LoadModel(mjcf);
  std::string text = "schema = \"mjdiag.setup/1\"\nname = \"" + mjcf.stem().string() +
                     "\"\nplant = \"" + plant.string() + "\"\n\n[rates]\ncontrol = " +
                     std::string(py::repr(py::float_(1.0 / model->opt.timestep))) +
                     "\nsubsteps = 1\n";
  for (int i = 0; i < model->nsensor; ++i) {
    const std::string unit = SensorUnit(*model, i);
    const std::string name = NameOf(*model, mjOBJ_SENSOR, i);
    if (!unit.empty() && !name.empty()) text += ChannelText("sensors", name, unit);
  }
  for (int i = 0; i < model->nu; ++i) {
    const std::string name = NameOf(*model, mjOBJ_ACTUATOR, i);
    if (name.empty()) continue;
    text += ChannelText("actuators", name, ActuatorUnit(*model, i));
  }
  return text;
}

/// A file with that MJCF, which may be one already.
fs::path MjcfFile(const std::string& mjcf, MachineSource& source) {
  if (!IsMjcfText(mjcf)) return fs::absolute(mjcf);
  if (!source.texts) source.texts = std::make_shared<ScratchFolder>();
  fs::path file = source.texts->path() / "plant.xml";
  WriteTextFile(file, mjcf);
  return file;
}

}  // namespace

MachineSource SourceOf(const py::object& machine, const py::object& plant,
                       const py::object& set) {
  const std::string text = PathOf(machine, "Machine").string();
  MachineSource source{text, OverridesOf(set)};
  if (IsMjcfText(text) || fs::path(text).extension() == ".xml") {
    if (!plant.is_none()) {
      throw InputError("Machine", "a plant for an MJCF", "a plant for a setup");
    }
    const fs::path mjcf = MjcfFile(text, source);
    const std::string setup = SetupOf(mjcf, source.texts ? mjcf.filename() : mjcf);
    if (!source.texts) source.texts = std::make_shared<ScratchFolder>();
    source.setup = source.texts->path() / "setup.toml";
    WriteTextFile(source.setup, setup);
  } else if (!plant.is_none()) {
    const fs::path mjcf = MjcfFile(PathOf(plant, "plant").string(), source);
    source.overrides.insert(source.overrides.begin(),
                            "plant=\"" + mjcf.string() + "\"");
  }
  return source;
}

}  // namespace mjdiag::python
