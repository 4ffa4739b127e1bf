#include "mjdiag/plugin/setup/mjcf_files.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "mjdiag/plugin/setup/xml_text.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;

std::string Trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(kSpace);
  if (begin == text.npos) return "";
  return std::string(text.substr(begin, text.find_last_not_of(kSpace) + 1 - begin));
}

/// @param around  files that this one is being put into
std::string WithIncludes(const fs::path& file, const fs::path& folder,
                         std::vector<fs::path> around = {}) {
  std::error_code ignored;
  if (std::ranges::any_of(around, [&](const fs::path& outer) {
        return fs::equivalent(outer, file, ignored);
      })) {
    throw InputError(around.back().string(), "includes " + file.string() + " in itself",
                     "every file once");
  }
  XmlText xml(file.string(), ReadTextFile(file));
  around.push_back(file);
  for (std::size_t i = 0; i < xml.elements().size(); ++i) {
    const XmlElement& element = xml.elements()[i];
    if (element.tag != "include") continue;
    const std::string* name = element.Find("file");
    if (name == nullptr) {
      throw InputError(file.string(), "<include> without a file", "file=\"...\"");
    }
    const XmlText included(*name, WithIncludes(folder / *name, folder, around));
    xml.Replace(static_cast<int>(i), Trimmed(included.Content(included.At(0))));
  }
  return xml.Text();
}

/// A folder that the compiler element names, and what is looked up there.
struct FileFolder {
  const char* attribute;
  std::vector<std::string_view> users;
};

bool NamesFile(const XmlElement& element) {
  return std::any_of(
      element.attributes.begin(), element.attributes.end(),
      [](const XmlAttribute& attribute) { return attribute.name.starts_with("file"); });
}

bool IsUsed(const XmlText& xml, const FileFolder& folder) {
  return std::any_of(
      xml.elements().begin(), xml.elements().end(), [&](const XmlElement& element) {
        return NamesFile(element) && std::find(folder.users.begin(), folder.users.end(),
                                               element.tag) != folder.users.end();
      });
}

std::string PathFrom(const fs::path& folder, const fs::path& target) {
  std::error_code error;
  const fs::path to = fs::weakly_canonical(target, error);
  if (error) {
    throw InputError(target.string(), error.message(),
                     "a folder of meshes or textures");
  }
  const fs::path relative = to.lexically_relative(fs::weakly_canonical(folder));
  return relative.generic_string() + "/";
}

void Relocate(XmlText& xml, const fs::path& from, const fs::path& to) {
  static const std::array<FileFolder, 2> kFolders{
      {{"meshdir", {"mesh", "hfield", "skin"}}, {"texturedir", {"texture"}}}};
  int compiler = -1;
  std::string attributes;
  for (const FileFolder& folder : kFolders) {
    bool given = false;
    for (std::size_t i = 0; i < xml.elements().size(); ++i) {
      const XmlElement& element = xml.elements()[i];
      if (element.tag != "compiler") continue;
      compiler = static_cast<int>(i);
      const std::string* value = element.Find(folder.attribute);
      if (value == nullptr) continue;
      given = true;
      if (!fs::path(*value).is_absolute()) {
        xml.SetAttribute(compiler, folder.attribute, PathFrom(to, from / *value));
      }
    }
    if (given || !IsUsed(xml, folder)) continue;
    const std::string path = PathFrom(to, from);
    if (compiler >= 0) {
      xml.SetAttribute(compiler, folder.attribute, path);
    } else {
      attributes +=
          std::string(" ") + folder.attribute + "=\"" + XmlEscape(path) + "\"";
    }
  }
  if (!attributes.empty()) xml.InsertFirst(0, "<compiler" + attributes + "/>");
}

}  // namespace

std::string MjcfForFolder(const fs::path& mjcf, const fs::path& folder) {
  const fs::path own = fs::absolute(mjcf).parent_path();
  return MjcfForFolder(mjcf.string(), WithIncludes(mjcf, own), own, folder);
}

std::string MjcfForFolder(const std::string& where, std::string text,
                          const fs::path& own, const fs::path& folder) {
  XmlText xml(where, std::move(text));
  Relocate(xml, own, folder);
  return xml.Text();
}

}  // namespace mjdiag
