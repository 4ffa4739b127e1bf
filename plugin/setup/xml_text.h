#pragma once
// An XML text in which single attributes and elements are changed. Everything else
// stays as its author wrote it, to the byte: comments, order, indentation, line breaks.
// So the difference between the old and the new file is exactly what was changed. (A
// document tree, written back, would lay out the whole file anew.)
//
// Elements are addressed by their number in document order; changes are collected and
// applied by Text(), so numbers and positions stay those of the original.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "mjdiag/plugin/setup/text_changes.h"

namespace mjdiag {

struct XmlAttribute {
  std::string name;
  std::string value;        ///< with entities such as &lt; decoded
  std::size_t value_begin;  ///< position of the raw value in the text
  std::size_t value_end;
};

struct XmlElement {
  std::string tag;
  int parent = -1;                 ///< element; -1: the root has none
  std::size_t begin = 0;           ///< of its '<'
  std::size_t attributes_end = 0;  ///< where one more attribute goes
  std::size_t content_begin = 0;   ///< behind the '>' of its start tag
  std::size_t content_end = 0;     ///< its end tag begins; content_begin if it has none
  std::size_t end = 0;             ///< behind its last '>'
  bool empty = false;              ///< written as <tag/>
  std::vector<XmlAttribute> attributes;

  /// The attribute's value, or null.
  const std::string* Find(std::string_view attribute) const;
};

class XmlText {
 public:
  /// InputError with `where` and line if the text is not well-formed.
  XmlText(const std::string& where, std::string text);

  const std::vector<XmlElement>& elements() const { return elements_; }
  const XmlElement& At(int element) const {
    return elements_[static_cast<std::size_t>(element)];
  }
  /// Tag of the parent, empty for the root.
  std::string_view ParentTag(const XmlElement& element) const;
  /// What lies between the tags of an element.
  std::string_view Content(const XmlElement& element) const;

  /// Sets or adds an attribute; at most once for each.
  void SetAttribute(int element, const std::string& name, const std::string& value);
  /// Puts elements, given as text, first or last into another, on lines of their own
  /// where the other has its tags on lines of their own; at most once for each.
  void InsertFirst(int element, const std::string& child);
  void InsertLast(int element, const std::vector<std::string>& children);
  /// Replaces an element by text.
  void Replace(int element, std::string_view text);
  /// Takes an element out, with its line if nothing else is on it.
  void Remove(int element);

  /// The text with all changes.
  std::string Text() const;

 private:
  /// White space in front of the element on its line; empty if there is more.
  std::string IndentOf(const XmlElement& element) const;
  /// Gives an element written as <tag/> an end tag behind `children`.
  void Open(const XmlElement& element, const std::vector<std::string>& children);

  std::string text_;
  std::vector<XmlElement> elements_;
  TextChanges changes_;
};

/// `text` with & < > and " as entities, for an attribute.
std::string XmlEscape(std::string_view text);

}  // namespace mjdiag
