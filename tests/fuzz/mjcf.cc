// MJCF as text and its editing. MuJoCo's compiler is not ours and is left out: what is
// edited is any text that our reader of XML takes, by edits that the bytes in front of it
// choose. What comes out has to be XML again, with what was put in.
//
// Input: edits of three bytes (which, element, value), a byte 0, then the text.

#include <vector>

#include "fuzz/target.h"
#include "mjdiag/plugin/setup/mjcf_files.h"
#include "mjdiag/plugin/setup/xml_text.h"

namespace mjdiag::fuzz {
namespace {

constexpr std::size_t kMostEdits = 8;

struct XmlEdit {
  std::size_t kind = 0;
  int element = 0;
  std::string value;
};

/// Nothing of an element is edited twice, nor anything inside what is taken out.
class XmlEditor {
 public:
  explicit XmlEditor(XmlText& xml) : xml_(xml) {}

  void Do(const XmlEdit& edit) {
    if (Touches(edit.element)) return;
    edited_.push_back(edit.element);
    switch (edit.kind) {
      case 0:
        xml_.SetAttribute(edit.element, "mjdiag_added", edit.value);
        attributes_.push_back(edit.value);
        break;
      case 1:
        xml_.InsertFirst(edit.element, "<mjdiag_first/>");
        ++added_;
        break;
      case 2:
        xml_.InsertLast(edit.element, {"<mjdiag_last/>", "<mjdiag_last/>"});
        added_ += 2;
        break;
      default:
        if (edit.element == 0) return;  // without a root it is no document
        removed_ += 1 + InnerElements(edit.element);
        xml_.Remove(edit.element);
        break;
    }
  }

  void Check(const std::string& text) const {
    const XmlText again("edited", text);
    Require(again.elements().size() == xml_.elements().size() + added_ - removed_,
            "another number of elements");
    for (const std::string& value : attributes_) {
      Require(std::ranges::any_of(again.elements(),
                                  [&](const XmlElement& element) {
                                    const std::string* own =
                                        element.Find("mjdiag_added");
                                    return own != nullptr && *own == value;
                                  }),
              "an attribute that does not come back");
    }
  }

 private:
  bool Inside(int element, int outer) const {
    for (; element >= 0; element = xml_.At(element).parent) {
      if (element == outer) return true;
    }
    return false;
  }
  bool Touches(int element) const {
    return std::ranges::any_of(edited_, [&](int other) {
      return Inside(element, other) || Inside(other, element);
    });
  }
  std::size_t InnerElements(int outer) const {
    std::size_t count = 0;
    for (int i = outer + 1; i < std::ssize(xml_.elements()); ++i) {
      count += Inside(i, outer) ? 1 : 0;
    }
    return count;
  }

  XmlText& xml_;
  std::vector<int> edited_;
  std::vector<std::string> attributes_;
  std::size_t added_ = 0;
  std::size_t removed_ = 0;
};

}  // namespace

void FuzzMjcf(Input input) {
  Choices choices(input);
  std::vector<XmlEdit> edits;
  while (edits.size() < kMostEdits) {
    const std::uint8_t kind = choices.Byte();
    if (kind == 0) break;
    const std::uint8_t element = choices.Byte();
    edits.push_back(
        {kind % 4U, element,
         std::string(1, static_cast<char>(std::max<std::uint8_t>(choices.Byte(), 1)))});
  }
  const std::string text(TextOf(choices.Rest()));
  Done([&] {
    XmlText xml("fuzzed", text);
    XmlEditor editor(xml);
    for (XmlEdit& edit : edits) {
      edit.element %= static_cast<int>(xml.elements().size());
      editor.Do(edit);
    }
    MustDo("edited XML", [&] { editor.Check(xml.Text()); });
  });
  if (text.find("include") == std::string::npos) return;
  const auto file = WriteFile("fuzzed.xml", text);
  Done([&] { MjcfForFolder(file, Folder() / "elsewhere"); });
}

}  // namespace mjdiag::fuzz
