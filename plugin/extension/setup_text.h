#pragma once
// A setup file's text in which single values are changed. Everything else stays as its
// author wrote it, to the byte (text_changes.h).

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "mjdiag/plugin/setup/text_changes.h"
#include "mjdiag/plugin/setup/toml_library.h"

namespace mjdiag {

class SetupText {
 public:
  /// Of a file that ReadSetup accepts. A last line without an end gets one.
  explicit SetupText(const std::filesystem::path& file);

  /// The value of a key, "sensors.x.element"; nothing if the file does not give it.
  toml::node_view<const toml::node> At(std::string_view path) const;
  /// A value as it is written.
  std::string Raw(const toml::node& value) const;

  void Replace(const toml::node& value, const std::string& text);
  /// Takes out the lines of a key of the root table.
  void RemoveLines(const toml::node& value);
  /// Adds a key to the table that holds `neighbour` under the key `neighbour_key`.
  void AddBeside(const toml::table& table, const toml::node& neighbour,
                 std::string_view neighbour_key, const std::string& key,
                 const std::string& value);
  /// The same in the root table, where the key may be given: it then gets that value.
  void SetBeside(std::string_view neighbour_key, const std::string& key,
                 const std::string& value);

  /// The text with all changes.
  std::string Text() const { return changes_.Apply(text_); }

 private:
  std::size_t LineStart(std::size_t at) const;
  /// Behind the line break; the text ends with one.
  std::size_t LineEnd(std::size_t at) const;
  /// Columns count code points.
  std::size_t Position(const toml::source_position& position) const;

  std::string text_;
  toml::table root_;
  TextChanges changes_;
};

}  // namespace mjdiag
