#include "mjdiag/plugin/setup/toml_table.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <tuple>
#include <utility>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag {
namespace {

std::string Join(const std::string& path, std::string_view key) {
  return path.empty() ? std::string(key) : path + "." + std::string(key);
}

std::string Element(const std::string& path, std::size_t index) {
  return path + "[" + std::to_string(index) + "]";
}

std::string Shown(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

/// The type of a node as the TOML standard calls it.
std::string TypeName(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "text";
    case toml::node_type::integer:
      return "an integer";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "a boolean";
    default:
      return "a date or time";
  }
}

/// Characters 0, which no name of a file or channel has: what reads C strings would end
/// there.
bool HasZeros(const toml::node& node) {
  constexpr char kZero = '\0';
  if (const auto* text = node.as_string())
    return text->get().find(kZero) != text->get().npos;
  if (const toml::array* array = node.as_array()) {
    return std::any_of(array->begin(), array->end(), HasZeros);
  }
  const toml::table* table = node.as_table();
  return table && std::any_of(table->begin(), table->end(), [](const auto& entry) {
           return entry.first.str().find(kZero) != std::string_view::npos ||
                  HasZeros(entry.second);
         });
}

/// The first line with which the parser's assumptions fail, counted from 1.
int LineOfAssumption(std::string_view text) {
  int line = 1;
  for (std::size_t end = text.find('\n'); end != text.npos;
       end = text.find('\n', end + 1), ++line) {
    try {
      static_cast<void>(toml::parse(text.substr(0, end + 1)));
    } catch (const toml::parse_error&) {  // cut within an array, or in several lines
    } catch (const TomlAssumption&) {
      return line;
    }
  }
  return line;
}

toml::table ParseToml(std::string_view text, const std::string& where) {
  const auto location = [&](auto line) {
    return where.starts_with("override") ? where : where + ":" + std::to_string(line);
  };
  try {
    toml::table table = toml::parse(text, where);
    if (HasZeros(table)) throw InputError(where, "a character 0", "texts without");
    return table;
  } catch (const toml::parse_error& error) {
    throw InputError(location(error.source().begin.line),
                     std::string(error.description()), "TOML");
  } catch (const TomlAssumption&) {
    throw InputError(
        location(LineOfAssumption(text)), "a line that is no TOML",
        "names and numbers in ASCII, other text in quotes, brackets in pairs");
  }
}

void Merge(toml::table& into, toml::table& from) {
  for (auto&& [key, node] : from) {
    toml::table* present = into[key.str()].as_table();
    if (present && node.is_table()) {
      Merge(*present, *node.as_table());
    } else {
      into.insert_or_assign(key, std::move(node));
    }
  }
}

bool IsName(std::string_view text) {
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  };
  return !text.empty() && is_letter(text.front()) &&
         std::all_of(text.begin(), text.end(), [&](char c) {
           return is_letter(c) || (c >= '0' && c <= '9') || c == '_';
         });
}

}  // namespace

TomlDocument::TomlDocument(const std::filesystem::path& file,
                           const std::vector<std::string>& overrides)
    : file_(file.string()), root_(ParseToml(ReadTextFile(file), file_)) {
  for (const std::string& text : overrides) {
    toml::table values = ParseToml(text, "override '" + text + "'");
    if (values.empty())
      throw InputError("override '" + text + "'", "is empty", "key=value");
    Merge(root_, values);
  }
}

TomlDocument::TomlDocument(const std::string& where, std::string_view text)
    : file_(where), root_(ParseToml(text, where)) {}

TomlTable TomlDocument::Root() const { return {*this, root_, "", ""}; }

std::string TomlDocument::Location(const toml::node& node) const {
  const toml::source_region& source = node.source();
  std::string from = source.path ? *source.path : file_;
  if (from != file_ || source.begin.line == 0) return from;
  return from + ":" + std::to_string(source.begin.line);
}

void TomlDocument::RefuseUnknownKeys() const { RefuseUnknownKeys(root_, ""); }

void TomlDocument::RefuseUnknownKeys(const toml::table& table,
                                     const std::string& path) const {
  for (const auto& [key, node] : table) {
    const std::string key_path = Join(path, key.str());
    if (!paths_.contains(key_path)) {
      std::string known;
      const std::string prefix = path.empty() ? "" : path + ".";
      for (const std::string& asked : paths_) {
        if (!asked.starts_with(prefix)) continue;
        const std::string rest = asked.substr(prefix.size());
        if (rest.find_first_of(".[") != std::string::npos) continue;
        known += (known.empty() ? "" : ", ") + rest;
      }
      throw InputError(Location(node) + ": " + key_path, "unknown key",
                       known.empty() ? "no keys here" : "one of " + known);
    }
    if (const toml::table* child = node.as_table()) {
      RefuseUnknownKeys(*child, key_path);
    } else if (const toml::array* array = node.as_array()) {
      for (std::size_t i = 0; i < array->size(); ++i) {
        if (const toml::table* element = array->get(i)->as_table()) {
          RefuseUnknownKeys(*element, Element(key_path, i));
        }
      }
    }
  }
}

TomlTable::TomlTable(const TomlDocument& document, const toml::table& table,
                     std::string path, std::string pattern)
    : document_(&document),
      table_(&table),
      path_(std::move(path)),
      pattern_(std::move(pattern)) {}

std::string TomlTable::name() const { return path_.substr(path_.rfind('.') + 1); }

void TomlTable::FailAt(const toml::node& node, const std::string& path,
                       const std::string& what, const std::string& expected) const {
  const std::string location = document_->Location(node);
  throw InputError(path.empty() ? location : location + ": " + path, what, expected);
}

void TomlTable::RequireSchema(const std::string& schema) const {
  if (Text("schema") == schema) return;
  Fail("schema", "is another one", "\"" + schema + "\"");
}

void TomlTable::Fail(std::string_view key, const std::string& what,
                     const std::string& expected) const {
  const toml::node* node = table_->get(key);
  FailAt(node ? *node : *table_, Join(path_, key), what, expected);
}

std::string TomlTable::Where(std::string_view key) const {
  const toml::node* node = table_->get(key);
  const std::string path = node ? Join(path_, key) : path_;
  const std::string location = document_->Location(node ? *node : *table_);
  return path.empty() ? location : location + ": " + path;
}

void TomlTable::Fail(const std::string& what, const std::string& expected) const {
  FailAt(*table_, path_, what, expected);
}

const toml::node* TomlTable::Find(std::string_view key) const {
  document_->paths_.insert(Join(path_, key));
  document_->patterns_.insert(Join(pattern_, key));
  return table_->get(key);
}

const toml::node& TomlTable::Demand(std::string_view key,
                                    const std::string& expected) const {
  const toml::node* node = Find(key);
  if (!node) Fail(key, "is missing", expected);
  return *node;
}

double TomlTable::CheckedNumber(const toml::node& node, const std::string& path,
                                const NumberRule& rule) const {
  if (!node.is_number()) FailAt(node, path, "is " + TypeName(node), rule.expected);
  const double value = node.is_integer() ? static_cast<double>(node.as_integer()->get())
                                         : node.as_floating_point()->get();
  if (!std::isfinite(value) || !rule.holds(value)) {
    FailAt(node, path, "is " + Shown(value), rule.expected);
  }
  return value;
}

double TomlTable::Number(std::string_view key, const NumberRule& rule) const {
  return CheckedNumber(Demand(key, rule.expected), Join(path_, key), rule);
}

double TomlTable::Number(std::string_view key, const NumberRule& rule,
                         double fallback) const {
  return Has(key) ? Number(key, rule) : fallback;
}

int TomlTable::Integer(std::string_view key, int least, int most) const {
  const std::string expected =
      "an integer from " + std::to_string(least) + " to " + std::to_string(most);
  const toml::node& node = Demand(key, expected);
  if (!node.is_integer()) Fail(key, "is " + TypeName(node), expected);
  const std::int64_t value = node.as_integer()->get();
  if (value < least || value > most) {
    Fail(key, "is " + std::to_string(value), expected);
  }
  return static_cast<int>(value);
}

int TomlTable::Integer(std::string_view key, int least, int most, int fallback) const {
  return Has(key) ? Integer(key, least, most) : fallback;
}

bool TomlTable::Flag(std::string_view key, bool fallback) const {
  const toml::node* node = Find(key);
  if (!node) return fallback;
  if (!node->is_boolean()) Fail(key, "is " + TypeName(*node), "true or false");
  return node->as_boolean()->get();
}

std::string TomlTable::Text(std::string_view key) const {
  const toml::node& node = Demand(key, "text in quotes");
  if (!node.is_string()) Fail(key, "is " + TypeName(node), "text in quotes");
  if (node.as_string()->get().empty()) Fail(key, "is empty", "text in quotes");
  return node.as_string()->get();
}

std::string TomlTable::Text(std::string_view key, const std::string& fallback) const {
  return Has(key) ? Text(key) : fallback;
}

std::vector<double> TomlTable::Numbers(std::string_view key,
                                       const NumberRule& rule) const {
  const std::string expected = std::string("an array, each ") + rule.expected;
  const toml::node& node = Demand(key, expected);
  const toml::array* array = node.as_array();
  if (!array) Fail(key, "is " + TypeName(node), expected);
  if (array->empty()) Fail(key, "is empty", expected);
  std::vector<double> values;
  for (std::size_t i = 0; i < array->size(); ++i) {
    values.push_back(CheckedNumber(*array->get(i), Element(Join(path_, key), i), rule));
  }
  return values;
}

std::vector<std::string> TomlTable::Texts(
    std::string_view key, const std::vector<std::string>& fallback) const {
  const toml::node* node = Find(key);
  if (!node) return fallback;
  const std::string expected = "an array of texts";
  const toml::array* array = node->as_array();
  if (!array) Fail(key, "is " + TypeName(*node), expected);
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < array->size(); ++i) {
    const auto text = array->get(i)->value_exact<std::string>();
    if (!text) {
      FailAt(*array->get(i), Element(Join(path_, key), i),
             "is " + TypeName(*array->get(i)), "a text");
    }
    texts.push_back(*text);
  }
  return texts;
}

TomlTable TomlTable::Child(const toml::node& node, const std::string& path,
                           const std::string& pattern) const {
  const toml::table* table = node.as_table();
  if (!table) FailAt(node, path, "is " + TypeName(node), "a table");
  return {*document_, *table, path, pattern};
}

TomlTable TomlTable::Table(std::string_view key) const {
  return Child(Demand(key, "a table"), Join(path_, key), Join(pattern_, key));
}

std::optional<TomlTable> TomlTable::FindTable(std::string_view key) const {
  if (!Has(key)) return std::nullopt;
  return Table(key);
}

std::vector<TomlTable> TomlTable::NamedTables(std::string_view key,
                                              const std::string& placeholder) const {
  std::vector<TomlTable> tables;
  const std::optional<TomlTable> parent = FindTable(key);
  if (!parent) return tables;
  for (const std::string& name : parent->Names(placeholder)) {
    tables.push_back(parent->Child(*parent->table_->get(name),
                                   Join(parent->path_, name),
                                   Join(parent->pattern_, placeholder)));
  }
  return tables;
}

std::vector<std::pair<std::string, double>> TomlTable::NamedNumbers(
    std::string_view key, const std::string& placeholder,
    const NumberRule& rule) const {
  return Table(key).AllNumbers(placeholder, rule);
}

std::vector<std::pair<std::string, double>> TomlTable::AllNumbers(
    const std::string& placeholder, const NumberRule& rule) const {
  std::vector<std::pair<std::string, double>> numbers;
  for (const std::string& name : Names(placeholder)) {
    const toml::node& node = *table_->get(name);
    numbers.emplace_back(name, CheckedNumber(node, Join(path_, name), rule));
  }
  return numbers;
}

std::vector<TomlTable> TomlTable::TableArray(std::string_view key) const {
  std::vector<TomlTable> tables;
  const toml::node* node = Find(key);
  if (!node) return tables;
  const toml::array* array = node->as_array();
  if (!array) Fail(key, "is " + TypeName(*node), "an array of tables");
  for (std::size_t i = 0; i < array->size(); ++i) {
    tables.push_back(Child(*array->get(i), Element(Join(path_, key), i),
                           Join(pattern_, key) + "[]"));
  }
  return tables;
}

std::vector<std::string> TomlTable::Overrides(std::string_view key) const {
  const auto table = FindTable(key);
  std::vector<std::string> overrides;
  if (!table) return overrides;
  for (const auto& [name, node] : *table->table_) {
    if (node.is_table()) {
      table->Fail(name.str(), "is a table",
                  "a whole key path in quotes, and its value");
    }
    std::ostringstream text;
    text << name.str() << '=' << toml::node_view<const toml::node>(node);
    overrides.push_back(text.str());
    document_->paths_.insert(Join(table->path_, name.str()));
  }
  return overrides;
}

std::vector<std::pair<std::string, double>> TomlTable::TextNumbers(
    std::string_view key) const {
  const auto table = FindTable(key);
  std::vector<std::pair<std::string, double>> numbers;
  if (!table) return numbers;
  for (const auto& [name, node] : *table->table_) {
    const auto number = node.value<double>();
    if (!number || !node.is_number()) {
      table->Fail(name.str(), "is no number", "a number");
    }
    numbers.emplace_back(name.str(), *number);
    document_->paths_.insert(Join(table->path_, name.str()));
  }
  return numbers;
}

std::vector<std::string> TomlTable::Names(const std::string& placeholder) const {
  // toml::table sorts by key; the position in the file is the order meant. What an
  // override adds comes last.
  using Place = std::tuple<bool, unsigned, unsigned, std::string>;
  std::vector<Place> places;
  for (const auto& [key, node] : *table_) {
    const std::string name(key.str());
    if (!IsName(name)) {
      Fail(name, "is not a name", "letters, digits and _, beginning with a letter");
    }
    const toml::source_region& source = node.source();
    const bool added = source.path && *source.path != document_->file_;
    places.emplace_back(added, source.begin.line, source.begin.column, name);
    document_->paths_.insert(Join(path_, name));
  }
  document_->patterns_.insert(Join(pattern_, placeholder));
  std::sort(places.begin(), places.end());
  std::vector<std::string> names;
  names.reserve(places.size());
  for (const Place& place : places) names.push_back(std::get<std::string>(place));
  return names;
}

}  // namespace mjdiag
