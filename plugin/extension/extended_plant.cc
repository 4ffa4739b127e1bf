#include "mjdiag/plugin/extension/extended_plant.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <numbers>
#include <span>
#include <utility>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/plant/scale_number.h"
#include "mjdiag/plugin/setup/mjcf_files.h"
#include "mjdiag/plugin/setup/xml_text.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/number_text.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;

using Attributes = std::vector<std::pair<std::string, std::string>>;

/// `count` values of each element, those of one.
std::span<const mjtNum> Row(const mjtNum* values, int element, std::size_t count = 1) {
  return {values + static_cast<std::size_t>(element) * count, count};
}

/// Adds the attribute if its values, in the file and as they shall be, differ.
void AddIfChanged(Attributes& attributes, const char* name,
                  std::span<const mjtNum> before, std::span<const mjtNum> after) {
  if (std::equal(before.begin(), before.end(), after.begin())) return;
  attributes.emplace_back(name, AllDigits(after));
}

/// The plant with everything in it that MJCF can say in attributes. What the model
/// holds of effects that it carries as numerics leaves, for the whole of them comes back
/// from there.
ModelPtr WithNativeChanges(const mjModel& plant, const Changes& changes) {
  ModelPtr extended = CopyModel(plant);
  for (const PlacedEffect& carried : EffectsOf(plant)) {
    if (carried.effect->form() == Form::kAttributes) continue;
    carried.effect->Retract(*extended, CheckEffect(*extended, carried), carried.values);
  }
  ScaleNumbers(*extended, changes.numbers);
  for (const Fault& fault : changes.faults) ApplyFault(*extended, fault);
  for (const PlacedEffect& placed : changes.effects) {
    if (placed.effect->form() == Form::kAttributes) {
      ApplyEffect(*extended, placed);
    } else {
      CheckEffect(*extended, placed);
    }
  }
  return extended;
}

/// Writes the differences between two models of the same file into its text.
class MjcfEditor {
 public:
  MjcfEditor(const fs::path& mjcf, const fs::path& folder, const mjModel& before,
             const mjModel& after)
      : where_(mjcf.string()),
        xml_(where_, MjcfForFolder(mjcf, folder)),
        before_(before),
        after_(after) {}

  void WriteAttributes() {
    EditOption();
    for (int joint = 0; joint < before_.njnt; ++joint) EditJoint(joint);
    for (int body = 1; body < before_.nbody; ++body) EditMass(body);
    for (int actuator = 0; actuator < before_.nu; ++actuator) EditActuator(actuator);
    for (int tendon = 0; tendon < before_.ntendon; ++tendon) EditTendon(tendon);
  }

  void WriteNumerics(const std::vector<PlacedEffect>& carried,
                     const std::vector<PlacedEffect>& added);

  std::string Text() const { return xml_.Text(); }

 private:
  /// The element of one of the tags, directly in `parent`, with that name.
  int Find(std::string_view parent, const std::string& name,
           std::string_view tag = "") const;
  int FindOrFail(std::string_view parent, mjtObj kind, int id,
                 std::string_view tag = "") const;
  /// The value that the last <compiler> gives; empty if none does.
  std::string CompilerOption(std::string_view option) const;
  void Set(int element, const Attributes& attributes) {
    for (const auto& [name, value] : attributes)
      xml_.SetAttribute(element, name, value);
  }

  void EditOption();
  void EditJoint(int joint);
  void EditMass(int body);
  void EditActuator(int actuator);
  void EditTendon(int tendon);
  /// Gain and bias, in the words of the element's tag.
  Attributes DriveOf(int actuator, const std::string& tag) const;
  /// What an angle or a distance is multiplied by in the file.
  double AngleUnit(int joint) const;
  void RequireOwnMasses(int body) const;

  std::string where_;
  XmlText xml_;
  const mjModel& before_;
  const mjModel& after_;
};

int MjcfEditor::Find(std::string_view parent, const std::string& name,
                     std::string_view tag) const {
  for (std::size_t i = 0; i < xml_.elements().size(); ++i) {
    const XmlElement& element = xml_.elements()[i];
    const std::string* own = element.Find("name");
    if (own != nullptr && *own == name && xml_.ParentTag(element) == parent &&
        (tag.empty() || element.tag == tag)) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

int MjcfEditor::FindOrFail(std::string_view parent, mjtObj kind, int id,
                           std::string_view tag) const {
  const std::string name = ElementName(before_, kind, id);
  const int element = Find(parent, name, tag);
  if (element >= 0) return element;
  throw InputError(where_, "'" + name + "' is not written out under its own name",
                   std::string("a ") + mju_type2Str(kind) + " with that name");
}

std::string MjcfEditor::CompilerOption(std::string_view option) const {
  std::string value;
  for (const XmlElement& element : xml_.elements()) {
    if (element.tag != "compiler") continue;
    if (const std::string* given = element.Find(option)) value = *given;
  }
  return value;
}

/// The last <option> that gives it is the one that counts.
void MjcfEditor::EditOption() {
  Attributes changed;
  AddIfChanged(changed, "timestep", {&before_.opt.timestep, 1},
               {&after_.opt.timestep, 1});
  if (changed.empty()) return;
  int last = -1;
  for (std::size_t i = 0; i < xml_.elements().size(); ++i) {
    const XmlElement& element = xml_.elements()[i];
    if (element.tag != "option" || element.parent != 0) continue;
    if (last < 0 || element.Find("timestep") != nullptr) last = static_cast<int>(i);
  }
  if (last >= 0) {
    Set(last, changed);
  } else {
    xml_.InsertFirst(0, "<option timestep=\"" + changed.front().second + "\"/>");
  }
}

double MjcfEditor::AngleUnit(int joint) const {
  const bool degrees =
      before_.jnt_type[joint] == mjJNT_HINGE && CompilerOption("angle") != "radian";
  return degrees ? 180.0 / std::numbers::pi : 1.0;
}

void MjcfEditor::EditJoint(int joint) {
  const int dof = before_.jnt_dofadr[joint];
  const int address = before_.jnt_qposadr[joint];
  Attributes changed;
  AddIfChanged(changed, "stiffness", Row(before_.jnt_stiffness, joint),
               Row(after_.jnt_stiffness, joint));
  AddIfChanged(changed, "damping", Row(before_.dof_damping, dof),
               Row(after_.dof_damping, dof));
  const bool springdamper = std::any_of(
      xml_.elements().begin(), xml_.elements().end(), [](const XmlElement& element) {
        return element.Find("springdamper") != nullptr;
      });
  if (!changed.empty() && springdamper) {
    // It would derive both anew.
    changed = {{"springdamper", "0 0"},
               {"stiffness", AllDigits(after_.jnt_stiffness[joint])},
               {"damping", AllDigits(after_.dof_damping[dof])}};
  }
  AddIfChanged(changed, "armature", Row(before_.dof_armature, dof),
               Row(after_.dof_armature, dof));
  const auto add_position = [&](const char* name, const mjtNum* before,
                                const mjtNum* after) {
    if (before_.jnt_type[joint] < mjJNT_SLIDE || before[address] == after[address]) {
      return;
    }
    changed.emplace_back(name, AllDigits(after[address] * AngleUnit(joint)));
  };
  add_position("springref", before_.qpos_spring, after_.qpos_spring);
  add_position("ref", before_.qpos0, after_.qpos0);
  AddIfChanged(changed, "frictionloss", Row(before_.dof_frictionloss, dof),
               Row(after_.dof_frictionloss, dof));
  if (after_.dof_frictionloss[dof] != 0.0) {
    AddIfChanged(changed, "solreffriction", Row(before_.dof_solref, dof, mjNREF),
                 Row(after_.dof_solref, dof, mjNREF));
    AddIfChanged(changed, "solimpfriction", Row(before_.dof_solimp, dof, mjNIMP),
                 Row(after_.dof_solimp, dof, mjNIMP));
  }
  if (!changed.empty()) Set(FindOrFail("body", mjOBJ_JOINT, joint), changed);
}

void MjcfEditor::RequireOwnMasses(int body) const {
  const auto fail = [&](const std::string& option) {
    throw InputError(where_,
                     "compiler " + option + " derives the mass of '" +
                         ElementName(before_, mjOBJ_BODY, body) + "' from other bodies",
                     "masses that each body has by itself");
  };
  const std::string total = CompilerOption("settotalmass");
  if (!total.empty() && total.front() != '-') fail("settotalmass");
  if (CompilerOption("fusestatic") == "true") fail("fusestatic");
  if (CompilerOption("inertiafromgeom") == "true") fail("inertiafromgeom");
  if (CompilerOption("coordinate") == "global") fail("coordinate=\"global\"");
}

void MjcfEditor::EditMass(int body) {
  Attributes changed;
  AddIfChanged(changed, "pos", Row(before_.body_ipos, body, 3),
               Row(after_.body_ipos, body, 3));
  AddIfChanged(changed, "mass", Row(before_.body_mass, body),
               Row(after_.body_mass, body));
  AddIfChanged(changed, "diaginertia", Row(before_.body_inertia, body, 3),
               Row(after_.body_inertia, body, 3));
  if (changed.empty()) return;
  RequireOwnMasses(body);
  const int joint = before_.body_jntadr[body];
  const int element = joint < 0
                          ? FindOrFail("body", mjOBJ_BODY, body, "body")
                          : xml_.At(FindOrFail("body", mjOBJ_JOINT, joint)).parent;
  for (std::size_t i = 0; i < xml_.elements().size(); ++i) {
    const XmlElement& child = xml_.elements()[i];
    if (child.parent != element || child.tag != "inertial") continue;
    if (changed.back().first == "diaginertia" && child.Find("fullinertia") != nullptr) {
      throw InputError(where_,
                       "an inertia that is given by fullinertia cannot be scaled",
                       "diaginertia");
    }
    Set(static_cast<int>(i), changed);
    return;
  }
  xml_.InsertFirst(
      element, "<inertial pos=\"" + AllDigits(Row(after_.body_ipos, body, 3)) +
                   "\" quat=\"" + AllDigits(Row(after_.body_iquat, body, 4)) +
                   "\" mass=\"" + AllDigits(after_.body_mass[body]) +
                   "\" diaginertia=\"" + AllDigits(Row(after_.body_inertia, body, 3)) +
                   "\"/>");
}

void MjcfEditor::EditActuator(int actuator) {
  Attributes changed;
  AddIfChanged(changed, "forcerange", Row(before_.actuator_forcerange, actuator, 2),
               Row(after_.actuator_forcerange, actuator, 2));
  if (!changed.empty()) changed.emplace_back("forcelimited", "true");
  AddIfChanged(changed, "gear", Row(before_.actuator_gear, actuator, 6),
               Row(after_.actuator_gear, actuator, 6));
  const auto gain = Row(after_.actuator_gainprm, actuator, mjNGAIN);
  const auto bias = Row(after_.actuator_biasprm, actuator, mjNBIAS);
  const bool same_drive =
      std::ranges::equal(gain, Row(before_.actuator_gainprm, actuator, mjNGAIN)) &&
      std::ranges::equal(bias, Row(before_.actuator_biasprm, actuator, mjNBIAS));
  if (changed.empty() && same_drive) return;
  const int element = FindOrFail("actuator", mjOBJ_ACTUATOR, actuator);
  if (!same_drive) {
    std::ranges::move(DriveOf(actuator, xml_.At(element).tag),
                      std::back_inserter(changed));
  }
  Set(element, changed);
}

Attributes MjcfEditor::DriveOf(int actuator, const std::string& tag) const {
  const auto gain = Row(after_.actuator_gainprm, actuator, mjNGAIN);
  const auto bias = Row(after_.actuator_biasprm, actuator, mjNBIAS);
  if (tag == "position" && bias[1] == -gain[0]) return {{"kp", AllDigits(gain[0])}};
  if (tag == "velocity" && bias[2] == -gain[0]) return {{"kv", AllDigits(gain[0])}};
  if (tag != "general") {
    throw InputError(where_,
                     "<" + tag + "> does not say gain and bias of '" +
                         ElementName(before_, mjOBJ_ACTUATOR, actuator) + "' apart",
                     "<general> with gainprm, biastype and biasprm");
  }
  Attributes changed;
  AddIfChanged(changed, "gainprm", Row(before_.actuator_gainprm, actuator, mjNGAIN),
               gain);
  AddIfChanged(changed, "biasprm", Row(before_.actuator_biasprm, actuator, mjNBIAS),
               bias);
  return changed;
}

void MjcfEditor::EditTendon(int tendon) {
  Attributes changed;
  AddIfChanged(changed, "stiffness", Row(before_.tendon_stiffness, tendon),
               Row(after_.tendon_stiffness, tendon));
  AddIfChanged(changed, "damping", Row(before_.tendon_damping, tendon),
               Row(after_.tendon_damping, tendon));
  AddIfChanged(changed, "frictionloss", Row(before_.tendon_frictionloss, tendon),
               Row(after_.tendon_frictionloss, tendon));
  if (!changed.empty()) Set(FindOrFail("tendon", mjOBJ_TENDON, tendon), changed);
}

void MjcfEditor::WriteNumerics(const std::vector<PlacedEffect>& carried,
                               const std::vector<PlacedEffect>& added) {
  std::map<std::string, std::string> data;  // of every numeric
  std::vector<std::string> names;           // of those that change, in order
  const auto append = [&](const PlacedEffect& placed) {
    std::string name = "effect." + placed.name() + "." + placed.site;
    for (const double value : placed.values) {
      std::string& values = data[name];
      values += (values.empty() ? "" : " ") + AllDigits(value);
    }
    return name;
  };
  int removed = -1;
  for (const PlacedEffect& effect : carried) {
    const int element = Find("custom", append(effect), "numeric");
    // Native ones are in the attributes by now. A numeric may hold several effects.
    if (effect.effect->form() != Form::kAttributes || element == removed) continue;
    xml_.Remove(removed = element);
  }
  for (const PlacedEffect& effect : added) {
    if (effect.effect->form() != Form::kNumeric) continue;
    const std::string name = append(effect);
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      names.push_back(name);
    }
  }
  std::vector<std::string> lines;
  for (const std::string& name : names) {
    const std::string& values = data[name];
    const auto size = std::to_string(1 + std::count(values.begin(), values.end(), ' '));
    if (const int element = Find("custom", name, "numeric"); element >= 0) {
      Set(element, {{"size", size}, {"data", values}});
    } else {
      std::string line = "<numeric name=\"" + XmlEscape(name);
      line.append("\" size=\"").append(size).append("\" data=\"").append(values);
      lines.push_back(line.append("\"/>"));
    }
  }
  if (lines.empty()) return;
  for (std::size_t i = 0; i < xml_.elements().size(); ++i) {
    const XmlElement& element = xml_.elements()[i];
    if (element.tag != "custom" || element.parent != 0) continue;
    return xml_.InsertLast(static_cast<int>(i), lines);
  }
  std::string section = "<custom>\n";
  for (const std::string& line : lines) section.append("    ").append(line) += '\n';
  xml_.InsertLast(0, {section.append("  </custom>")});
}

}  // namespace

std::string ExtendMjcf(const fs::path& mjcf, const mjModel& plant,
                       const Changes& changes, const fs::path& folder) {
  std::error_code ignored;
  if (fs::equivalent(mjcf, folder / "plant.xml", ignored)) {
    throw InputError(folder.string(), "holds the nominal plant", "another folder");
  }
  const ModelPtr before = LoadModel(mjcf);
  const ModelPtr after = WithNativeChanges(plant, changes);
  MjcfEditor editor(mjcf, folder, *before, *after);
  editor.WriteAttributes();
  editor.WriteNumerics(EffectsOf(plant), changes.effects);
  return editor.Text();
}

}  // namespace mjdiag
