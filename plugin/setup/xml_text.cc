#include "mjdiag/plugin/setup/xml_text.h"

#include <algorithm>
#include <array>
#include <utility>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr std::string_view kSpace = " \t\r\n";
constexpr std::array<std::pair<std::string_view, char>, 5> kEntities{
    {{"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}, {"&amp;", '&'}}};

std::string Unescape(std::string_view raw) {
  std::string text;
  while (!raw.empty()) {
    const auto entity =
        std::find_if(kEntities.begin(), kEntities.end(),
                     [&](const auto& known) { return raw.starts_with(known.first); });
    text += entity == kEntities.end() ? raw.front() : entity->second;
    raw.remove_prefix(entity == kEntities.end() ? 1 : entity->first.size());
  }
  return text;
}

/// Reads the elements of a text from front to back.
class Scanner {
 public:
  Scanner(const std::string& where, std::string_view text)
      : where_(where), text_(text) {}

  std::vector<XmlElement> Scan() {
    if (at_ = text_.find('\0'); at_ != text_.npos) Fail("a byte 0");
    at_ = 0;
    while ((at_ = text_.find('<', at_)) != text_.npos) {
      if (!SkipMarkup("<!--", "-->") && !SkipMarkup("<![CDATA[", "]]>") &&
          !SkipMarkup("<?", "?>") && !SkipMarkup("<!", ">")) {
        text_.substr(at_).starts_with("</") ? ReadEndTag() : ReadStartTag();
      }
    }
    if (!open_.empty()) Fail("an element has no end");
    if (elements_.empty()) Fail("no element");
    return std::move(elements_);
  }

 private:
  [[noreturn]] void Fail(const std::string& what) const {
    const auto line = 1 + std::count(text_.begin(),
                                     text_.begin() + static_cast<std::ptrdiff_t>(
                                                         std::min(at_, text_.size())),
                                     '\n');
    throw InputError(where_ + ":" + std::to_string(line), what, "well-formed XML");
  }

  bool SkipMarkup(std::string_view begin, std::string_view end) {
    if (!text_.substr(at_).starts_with(begin)) return false;
    Until(end);
    at_ += end.size();
    return true;
  }

  /// What lies in front of `mark`; goes there.
  std::string_view Until(std::string_view mark) {
    const std::size_t found = text_.find(mark, at_);
    if (found == text_.npos) Fail("no '" + std::string(mark) + "' follows");
    return TakeTo(found);
  }

  /// What lies up to there; goes there.
  std::string_view TakeTo(std::size_t end) {
    const std::size_t begin = std::exchange(at_, end);
    return text_.substr(begin, end - begin);
  }

  std::string_view Name() {
    const std::size_t end =
        std::min(text_.find_first_of(" \t\r\n=/>", at_), text_.size());
    return TakeTo(end);
  }

  void SkipSpace() {
    at_ = std::min(text_.find_first_not_of(kSpace, at_), text_.size());
  }

  char Next() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  void ReadStartTag() {
    XmlElement element;
    element.begin = at_++;
    element.tag = Name();
    element.parent = open_.empty() ? -1 : open_.back();
    element.attributes_end = at_;
    for (SkipSpace(); Next() != '>' && Next() != '/'; SkipSpace()) {
      element.attributes.push_back(ReadAttribute());
      element.attributes_end = at_;
    }
    element.empty = Next() == '/';
    if (element.empty) ++at_;
    if (element.tag.empty() || element.tag.find_first_of("<\"'") != std::string::npos ||
        Next() != '>') {
      Fail("a tag that is none");
    }
    element.content_begin = element.content_end = element.end = ++at_;
    if (!element.empty) open_.push_back(static_cast<int>(elements_.size()));
    elements_.push_back(std::move(element));
  }

  XmlAttribute ReadAttribute() {
    const std::string name(Name());
    SkipSpace();
    if (name.empty() || Next() != '=') Fail("an attribute has no value");
    ++at_;
    SkipSpace();
    const char quote = Next();
    if (quote != '"' && quote != '\'') Fail("a value without quotation marks");
    const std::size_t begin = ++at_;
    const std::string_view raw = Until({&quote, 1});
    ++at_;
    return {name, Unescape(raw), begin, begin + raw.size()};
  }

  void ReadEndTag() {
    if (open_.empty()) Fail("an end without a beginning");
    XmlElement& element = elements_[static_cast<std::size_t>(open_.back())];
    open_.pop_back();
    element.content_end = at_;
    at_ += 2;
    if (Name() != element.tag) Fail("<" + element.tag + "> has another end tag");
    SkipSpace();
    if (Next() != '>') Fail("an end tag without its '>'");
    element.end = ++at_;
  }

  const std::string& where_;
  std::string_view text_;
  std::size_t at_ = 0;
  std::vector<XmlElement> elements_;
  std::vector<int> open_;
};

}  // namespace

const std::string* XmlElement::Find(std::string_view attribute) const {
  for (const XmlAttribute& candidate : attributes) {
    if (candidate.name == attribute) return &candidate.value;
  }
  return nullptr;
}

XmlText::XmlText(const std::string& where, std::string text)
    : text_(std::move(text)), elements_(Scanner(where, text_).Scan()) {}

std::string_view XmlText::ParentTag(const XmlElement& element) const {
  return element.parent < 0 ? std::string_view() : At(element.parent).tag;
}

std::string_view XmlText::Content(const XmlElement& element) const {
  return std::string_view(text_).substr(element.content_begin,
                                        element.content_end - element.content_begin);
}

std::string XmlText::IndentOf(const XmlElement& element) const {
  const std::size_t line = text_.rfind('\n', element.begin) + 1;
  std::string indent = text_.substr(line, element.begin - line);
  return indent.find_first_not_of(" \t") == std::string::npos ? indent : "";
}

void XmlText::SetAttribute(int element, const std::string& name,
                           const std::string& value) {
  const XmlElement& changed = At(element);
  for (const XmlAttribute& attribute : changed.attributes) {
    if (attribute.name != name) continue;
    changes_.Replace(attribute.value_begin, attribute.value_end, XmlEscape(value));
    return;
  }
  changes_.Replace(changed.attributes_end, changed.attributes_end,
                   " " + name + "=\"" + XmlEscape(value) + "\"");
}

void XmlText::Open(const XmlElement& element,
                   const std::vector<std::string>& children) {
  const std::string indent = IndentOf(element);
  std::string text = ">\n";
  for (const std::string& child : children) {
    text.append(indent).append("  ").append(child) += '\n';
  }
  changes_.Replace(text_.rfind('/', element.end - 1), element.end,
                   text + indent + "</" + element.tag + ">");
}

void XmlText::InsertFirst(int element, const std::string& child) {
  const XmlElement& parent = At(element);
  if (parent.empty) return Open(parent, {child});
  changes_.Replace(parent.content_begin, parent.content_begin,
                   "\n" + IndentOf(parent) + "  " + child);
}

void XmlText::InsertLast(int element, const std::vector<std::string>& children) {
  const XmlElement& parent = At(element);
  if (parent.empty) return Open(parent, children);
  const std::size_t line = text_.rfind('\n', parent.content_end - 1) + 1;
  const bool own_line = line >= parent.content_begin &&
                        text_.find_first_not_of(" \t", line) == parent.content_end;
  const std::size_t place = own_line ? line : parent.content_end;
  std::string text;
  for (const std::string& child : children) {
    text += own_line ? IndentOf(parent) + "  " + child + "\n" : child;
  }
  changes_.Replace(place, place, text);
}

void XmlText::Replace(int element, std::string_view text) {
  changes_.Replace(At(element).begin, At(element).end, std::string(text));
}

void XmlText::Remove(int element) {
  std::size_t begin = At(element).begin;
  std::size_t end = At(element).end;
  const std::size_t line = text_.rfind('\n', begin) + 1;
  const std::size_t rest = text_.find_first_not_of(" \t\r", end);
  if (text_.find_first_not_of(" \t", line) == begin && rest != text_.npos &&
      text_[rest] == '\n') {
    begin = line;
    end = rest + 1;
  }
  changes_.Replace(begin, end, "");
}

std::string XmlText::Text() const { return changes_.Apply(text_); }

std::string XmlEscape(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    const auto entity = std::find_if(kEntities.begin(), kEntities.end(),
                                     [&](const auto& k) { return k.second == c; });
    entity == kEntities.end() ? escaped += c : escaped += entity->first;
  }
  return escaped;
}

}  // namespace mjdiag
