#pragma once
// Typed access to a TOML file in which every complaint says file, line and key. The
// document remembers which keys were asked for, so that a key that nobody asks for (a
// typing error) is refused at the end.

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mjdiag/plugin/setup/toml_library.h"

namespace mjdiag {

/// What a number must satisfy, and how to say so.
struct NumberRule {
  bool (*holds)(double);
  const char* expected;
};

inline constexpr NumberRule kAnyNumber{[](double) { return true; }, "a number"};
inline constexpr NumberRule kNonZero{[](double x) { return x != 0.0; },
                                     "a number other than 0"};
inline constexpr NumberRule kPositive{[](double x) { return x > 0.0; }, "a number > 0"};
inline constexpr NumberRule kNonNegative{[](double x) { return x >= 0.0; },
                                         "a number >= 0"};
inline constexpr NumberRule kShare{[](double x) { return x > 0.0 && x <= 1.0; },
                                   "a number > 0 and <= 1"};

class TomlTable;

/// A parsed file with overrides merged in.
class TomlDocument {
 public:
  /// `overrides` are `key.path=value` in TOML syntax: tables are merged key by key, any
  /// other value is replaced. InputError with file and line on malformed TOML.
  TomlDocument(const std::filesystem::path& file,
               const std::vector<std::string>& overrides);
  /// Of a text. @param where  what complaints call it in the place of a file
  TomlDocument(const std::string& where, std::string_view text);

  /// The document must outlive its tables.
  TomlTable Root() const;
  /// InputError names the first key that no table was asked for.
  void RefuseUnknownKeys() const;
  /// Patterns of all keys asked for: "sensors.<channel>.unit".
  const std::set<std::string>& known_keys() const { return patterns_; }

 private:
  friend class TomlTable;

  /// "<file>:<line>", or the override that the node comes from.
  std::string Location(const toml::node& node) const;
  void RefuseUnknownKeys(const toml::table& table, const std::string& path) const;

  std::string file_;
  toml::table root_;
  mutable std::set<std::string> paths_;     ///< asked for: "sensors.x.unit"
  mutable std::set<std::string> patterns_;  ///< the same: "sensors.<channel>.unit"
};

/// One table of a document. A getter without a fallback demands the key; InputError
/// names file, line and key on a missing key, a wrong type or a value out of range.
class TomlTable {
 public:
  /// Last part of the key path: "x" for "sensors.x".
  std::string name() const;

  bool Has(std::string_view key) const { return Find(key) != nullptr; }
  double Number(std::string_view key, const NumberRule& rule) const;
  double Number(std::string_view key, const NumberRule& rule, double fallback) const;
  int Integer(std::string_view key, int least, int most) const;
  int Integer(std::string_view key, int least, int most, int fallback) const;
  bool Flag(std::string_view key, bool fallback) const;
  std::string Text(std::string_view key) const;
  std::string Text(std::string_view key, const std::string& fallback) const;
  /// A non-empty array of numbers.
  std::vector<double> Numbers(std::string_view key, const NumberRule& rule) const;
  /// An array of texts; `fallback` without the key.
  std::vector<std::string> Texts(std::string_view key,
                                 const std::vector<std::string>& fallback) const;

  TomlTable Table(std::string_view key) const;
  std::optional<TomlTable> FindTable(std::string_view key) const;
  /// The tables [key.<name>], in the order of the file; none if the key is missing.
  /// `placeholder` stands for the name in known_keys(): "<channel>". Names are letters,
  /// digits and _, beginning with a letter.
  std::vector<TomlTable> NamedTables(std::string_view key,
                                     const std::string& placeholder) const;
  /// The numbers key.<name>, in the order of the file.
  std::vector<std::pair<std::string, double>> NamedNumbers(
      std::string_view key, const std::string& placeholder,
      const NumberRule& rule) const;
  /// The numbers of this table, in the order of the file.
  std::vector<std::pair<std::string, double>> AllNumbers(const std::string& placeholder,
                                                         const NumberRule& rule) const;
  /// The tables of the array `key`; none if the key is missing.
  std::vector<TomlTable> TableArray(std::string_view key) const;
  /// The keys of this table, which are names chosen by the file, in the file's order.
  std::vector<std::string> Names(const std::string& placeholder) const;
  /// The table `key`, whose own keys are key paths of another document, as overrides of
  /// that: "axes.x.drive_gain=2.0"; none if the key is missing.
  std::vector<std::string> Overrides(std::string_view key) const;
  /// The numbers of the table `key`, whose own keys are any texts; none if the key is
  /// missing.
  std::vector<std::pair<std::string, double>> TextNumbers(std::string_view key) const;
  /// InputError if the key "schema" is not `schema`.
  void RequireSchema(const std::string& schema) const;
  /// Throws the InputError "<file>:<line>: <key path>: <what>; expected <expected>".
  [[noreturn]] void Fail(std::string_view key, const std::string& what,
                         const std::string& expected) const;
  /// "<file>:<line>: <key path>", of the table itself without the key.
  std::string Where(std::string_view key) const;
  /// The same for the table itself.
  [[noreturn]] void Fail(const std::string& what, const std::string& expected) const;

 private:
  friend class TomlDocument;
  TomlTable(const TomlDocument& document, const toml::table& table, std::string path,
            std::string pattern);

  /// The node, or null; notes that the key was asked for.
  const toml::node* Find(std::string_view key) const;
  const toml::node& Demand(std::string_view key, const std::string& expected) const;
  double CheckedNumber(const toml::node& node, const std::string& path,
                       const NumberRule& rule) const;
  TomlTable Child(const toml::node& node, const std::string& path,
                  const std::string& pattern) const;
  [[noreturn]] void FailAt(const toml::node& node, const std::string& path,
                           const std::string& what, const std::string& expected) const;

  const TomlDocument* document_;
  const toml::table* table_;
  std::string path_;     ///< "sensors.x"
  std::string pattern_;  ///< "sensors.<channel>"
};

}  // namespace mjdiag
