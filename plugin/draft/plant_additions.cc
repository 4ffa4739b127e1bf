#include "mjdiag/plugin/draft/plant_additions.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "mjdiag/plugin/draft/plant_places.h"
#include "mjdiag/plugin/setup/mjcf_files.h"
#include "mjdiag/plugin/setup/xml_text.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/number_text.h"
#include "mjdiag/signals/scratch_folder.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;

bool IsUrdf(const fs::path& file) {
  const XmlText xml(file.string(), ReadTextFile(file));
  return !xml.elements().empty() && xml.At(0).tag == "robot";
}

std::string SavedXml(const mjModel& model) {
  const ScratchFolder scratch;
  const fs::path file = scratch.path() / "plant.xml";
  std::array<char, 1024> report{};
  if (mj_saveLastXML(file.c_str(), &model, report.data(), report.size()) == 0) {
    throw InputError(model.names, report.data(), "a URDF that MuJoCo writes as MJCF");
  }
  return ReadTextFile(file);
}

/// Joints of bodies in MuJoCo's order: body by body, parents first, as the text has them.
std::vector<int> JointElements(const XmlText& xml) {
  const auto count = static_cast<int>(xml.elements().size());
  std::map<int, std::vector<int>> joints;  // of every body
  std::vector<int> bodies;
  for (int i = 0; i < count; ++i) {
    const XmlElement& element = xml.At(i);
    if (element.tag == "body") bodies.push_back(i);
    const bool joint = element.tag == "joint" || element.tag == "freejoint";
    if (joint && xml.ParentTag(element) == "body") joints[element.parent].push_back(i);
  }
  std::vector<int> ordered;
  for (const int body : bodies) {
    ordered.insert(ordered.end(), joints[body].begin(), joints[body].end());
  }
  return ordered;
}

std::vector<int> ActuatorElements(const XmlText& xml) {
  std::vector<int> actuators;
  for (int i = 0; i < static_cast<int>(xml.elements().size()); ++i) {
    // Inside <default> such an element says what others have, outside of a section.
    if (xml.ParentTag(xml.At(i)) == "actuator") actuators.push_back(i);
  }
  return actuators;
}

void GiveNames(const mjModel& model, mjtObj kind, const std::vector<int>& ids,
               const std::vector<int>& elements, int count, XmlText& xml) {
  if (ids.empty()) return;
  if (static_cast<int>(elements.size()) != count) {
    throw InputError(model.names,
                     std::string("has a ") + mju_type2Str(kind) + " without a name",
                     "a name for every joint and actuator");
  }
  for (const int id : ids) {
    xml.SetAttribute(elements[static_cast<std::size_t>(id)], "name",
                     XmlEscape(GivenName(model, kind, id)));
  }
}

int FindSection(const XmlText& xml, const std::string& tag) {
  int last = -1;
  for (int i = 0; i < static_cast<int>(xml.elements().size()); ++i) {
    const XmlElement& element = xml.At(i);
    if (element.tag == tag && element.parent == 0) last = i;
  }
  return last;
}

/// Elements at the end of a section of the root, which is made where there is none.
void Append(const std::string& tag, const std::vector<std::string>& children,
            XmlText& xml, std::vector<std::string>& sections) {
  if (children.empty()) return;
  const int section = FindSection(xml, tag);
  if (section >= 0) {
    xml.InsertLast(section, children);
    return;
  }
  std::string text = "<" + tag + ">";
  for (const std::string& child : children) text += "\n    " + child;
  sections.push_back(text + "\n  </" + tag + ">");
}

void SetOptions(const PlantAdditions& additions, XmlText& xml) {
  std::vector<std::pair<std::string, std::string>> attributes;
  if (additions.timestep) {
    attributes.emplace_back("timestep", AllDigits(*additions.timestep));
  }
  if (additions.euler) attributes.emplace_back("integrator", "Euler");
  if (attributes.empty()) return;
  const int option = FindSection(xml, "option");
  std::string text;
  for (const auto& [name, value] : attributes) {
    if (option >= 0) xml.SetAttribute(option, name, value);
    text += " " + name + "=\"" + value + "\"";
  }
  if (option < 0) xml.InsertFirst(0, "<option" + text + "/>");
}

std::vector<std::string> Texts(const std::string& tag,
                               const std::vector<PlantAdditions::Element>& elements) {
  std::vector<std::string> texts;
  for (const PlantAdditions::Element& element : elements) {
    texts.push_back("<" + tag + " name=\"" + XmlEscape(element.name) + "\" joint=\"" +
                    XmlEscape(element.joint) + "\"/>");
  }
  return texts;
}

}  // namespace

SourcePlant LoadSourcePlant(const fs::path& file) {
  SourcePlant source;
  source.model = LoadModel(file);
  source.is_urdf = IsUrdf(file);
  if (source.is_urdf) source.mjcf = SavedXml(*source.model);
  return source;
}

std::string FreeName(const mjModel& model, mjtObj kind, const std::string& wanted) {
  std::string name = wanted;
  for (int i = 2; mj_name2id(&model, kind, name.c_str()) >= 0; ++i) {
    name = wanted + "_" + std::to_string(i);
  }
  return name;
}

std::string PlantWith(const fs::path& file, const SourcePlant& source,
                      const PlantAdditions& additions, const fs::path& folder) {
  const fs::path own = fs::absolute(file).parent_path();
  XmlText xml(file.string(),
              source.is_urdf ? MjcfForFolder(file.string(), source.mjcf, own, folder)
                             : MjcfForFolder(file, folder));
  const mjModel& model = *source.model;
  GiveNames(model, mjOBJ_JOINT, additions.named_joints, JointElements(xml), model.njnt,
            xml);
  GiveNames(model, mjOBJ_ACTUATOR, additions.named_actuators, ActuatorElements(xml),
            model.nu, xml);
  SetOptions(additions, xml);
  std::vector<std::string> sections;
  Append("actuator", Texts("motor", additions.motors), xml, sections);
  Append("sensor", Texts("jointpos", additions.sensors), xml, sections);
  if (!sections.empty()) xml.InsertLast(0, sections);
  return xml.Text();
}

}  // namespace mjdiag
