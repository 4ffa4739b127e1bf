#include "mjdiag/plugin/plant/newer_mjcf.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>

#include "mjdiag/plugin/plant/newer_mjcf_table.h"
#include "mjdiag/plugin/setup/xml_text.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag {
namespace {

/// An element that MuJoCo knows, with its attributes and children.
struct SchemaNode {
  std::string name;
  std::set<std::string, std::less<>> attributes;
  std::vector<std::unique_ptr<SchemaNode>> children;

  const SchemaNode* Child(std::string_view tag) const {
    // Bodies and classes of defaults hold more of their kind.
    if (tag == "worldbody") tag = "body";
    if ((tag == "body" || tag == "default") && tag == name) return this;
    for (const auto& child : children) {
      if (child->name == tag) return child.get();
    }
    return nullptr;
  }
};

/// Of what MuJoCo prints: an element a line, three spaces a level, "name (how often)" and
/// its attributes, which go on in lines of their own. The world is "(world)body".
std::unique_ptr<SchemaNode> ReadSchema() {
  constexpr std::size_t kIndent = 3;
  std::vector<char> buffer(1U << 18);
  const int size =
      mj_printSchema(nullptr, buffer.data(), static_cast<int>(buffer.size()), 0, 0);
  std::istringstream lines(
      std::string(buffer.data(), static_cast<std::size_t>(std::max(size, 0))));
  auto root = std::make_unique<SchemaNode>();
  std::vector<SchemaNode*> open{root.get()};
  for (std::string line; std::getline(lines, line);) {
    const std::size_t indent = line.find_first_not_of(' ');
    if (indent == std::string::npos) continue;
    std::istringstream words(line);
    std::string word;
    if (const std::size_t bracket = line.rfind(" (");
        bracket != std::string::npos && line.find(')', bracket) == bracket + 3) {
      auto node = std::make_unique<SchemaNode>();
      words >> node->name >> word;
      if (node->name == "(world)body") node->name = "body";
      open.resize(std::min(open.size(), indent / kIndent + 1));
      open.back()->children.push_back(std::move(node));
      open.push_back(open.back()->children.back().get());
    }
    while (words >> word) open.back()->attributes.insert(word);
  }
  return root;
}

const SchemaNode* KnownMjcf() {
  static const std::unique_ptr<SchemaNode> root = ReadSchema();
  return root->Child("mujoco");
}

const NewerEntry* FindEntry(std::string_view element, std::string_view attribute,
                            std::string_view keyword) {
  const auto found = std::ranges::find_if(kNewerEntries, [&](const NewerEntry& entry) {
    return (entry.element.empty() || entry.element == element) &&
           entry.attribute == attribute && entry.keyword == keyword;
  });
  return found == kNewerEntries.end() ? nullptr : &*found;
}

class MjcfReading {
 public:
  explicit MjcfReading(const std::filesystem::path& mjcf)
      : folder_(mjcf.parent_path()) {}

  void Read(const std::filesystem::path& file, const SchemaNode* inside, int depth) {
    constexpr int kDeepest = 20;
    if (depth > kDeepest) return;
    const XmlText xml(file.string(), ReadTextFile(file));
    const std::string text = xml.Text();
    // What each element is in the schema; null: nothing is asked about what is in it.
    std::vector<const SchemaNode*> nodes;
    for (const XmlElement& element : xml.elements()) {
      const int line = static_cast<int>(
          1 + std::count(text.begin(),
                         text.begin() + static_cast<std::ptrdiff_t>(element.begin),
                         '\n'));
      file_ = file.filename().string();
      line_ = line;
      const SchemaNode* parent = element.parent < 0
                                     ? nullptr
                                     : nodes[static_cast<std::size_t>(element.parent)];
      if (element.parent < 0) {
        nodes.push_back(inside);
        if (depth == 0) CheckAttributes(element, *inside);
      } else if (parent == nullptr) {
        nodes.push_back(nullptr);
      } else if (element.tag == "include") {
        nodes.push_back(nullptr);
        if (const std::string* included = element.Find("file")) {
          Read(folder_ / *included, parent, depth + 1);
        }
      } else {
        nodes.push_back(CheckElement(element, *parent));
      }
    }
  }

  /// Ranges without a word about limits are limits from 3.0.0 on.
  void AddLimits() {
    if (has_autolimits_ || first_range_ == 0 || items.empty()) return;
    items.push_back({"range without limited", items.front().file, first_range_, "3.0.0",
                     "<compiler autolimits=\"true\"/>"});
  }

  std::vector<NewerItem> items;

 private:
  /// @return the node of it; of a frame or a replicate that of what it stands in
  const SchemaNode* CheckElement(const XmlElement& element, const SchemaNode& parent) {
    const SchemaNode* node = parent.Child(element.tag);
    if (node != nullptr) {
      CheckAttributes(element, *node);
      return node;
    }
    Add("<" + element.tag + ">", FindEntry(element.tag, "", ""));
    return element.tag == "frame" || element.tag == "replicate" ? &parent : nullptr;
  }

  void CheckAttributes(const XmlElement& element, const SchemaNode& node) {
    for (const XmlAttribute& attribute : element.attributes) {
      std::string words = element.tag;
      words += " " + attribute.name;
      has_autolimits_ |= attribute.name == "autolimits";
      if (attribute.name.ends_with("range") && first_range_ == 0) first_range_ = line_;
      if (!node.attributes.contains(attribute.name)) {
        Add(words, FindEntry(element.tag, attribute.name, ""));
      } else if (const NewerEntry* entry =
                     FindEntry(element.tag, attribute.name, attribute.value)) {
        Add(words + "=\"" + attribute.value + "\"", entry);
      }
    }
  }

  void Add(const std::string& words, const NewerEntry* entry) {
    if (std::ranges::count(items, words, &NewerItem::words) > 0) return;
    items.push_back({words, file_, line_, entry ? std::string(entry->version) : "",
                     entry ? std::string(entry->instead) : ""});
  }

  std::filesystem::path folder_;
  std::string file_;
  int line_ = 0;
  bool has_autolimits_ = false;
  int first_range_ = 0;  ///< line; 0: none
};

}  // namespace

std::vector<NewerItem> NewerThanThisMujoco(const std::filesystem::path& mjcf) {
  const SchemaNode* known = KnownMjcf();
  if (known == nullptr) return {};
  MjcfReading reading(mjcf);
  try {
    reading.Read(mjcf, known, 0);
  } catch (const InputError&) {
    // An include that is not there, or no XML: MuJoCo has said so itself.
  }
  reading.AddLimits();
  return reading.items;
}

std::string DescribeNewer(const std::vector<NewerItem>& items) {
  std::string newest;
  std::string list;
  for (const NewerItem& item : items) {
    newest = std::max(newest, item.version);
    list += (list.empty() ? "" : "; ") + item.words + " (line " +
            std::to_string(item.line) +
            (item.file == items.front().file ? "" : " of " + item.file) + ", ";
    list += item.version.empty() ? "misspelt, or newer still)"
                                 : item.version + "): " + item.instead;
  }
  if (newest.empty()) return "";
  return "is written for MuJoCo " + newest + " or newer; this one, " +
         mj_versionString() + ", does not know " + list;
}

}  // namespace mjdiag
