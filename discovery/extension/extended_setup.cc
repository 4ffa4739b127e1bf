// The setup of an extended plant: ExtendSetup of extended_plant.h.

#include <toml++/toml.h>

#include <algorithm>
#include <string_view>

#include "mjdiag/discovery/extension/digits.h"
#include "mjdiag/discovery/extension/extended_plant.h"
#include "mjdiag/discovery/extension/text_changes.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;

/// A TOML text in which single values are changed; the rest stays to the byte.
class SetupText {
 public:
  SetupText(const fs::path& file, std::string text)
      : text_(std::move(text)), root_(toml::parse(text_, file.string())) {}

  toml::node_view<const toml::node> At(std::string_view path) const {
    return std::as_const(root_).at_path(path);
  }

  std::string Raw(const toml::node& value) const {
    const std::size_t begin = Position(value.source().begin);
    return text_.substr(begin, Position(value.source().end) - begin);
  }

  void Replace(const toml::node& value, const std::string& text) {
    changes_.Replace(Position(value.source().begin), Position(value.source().end),
                     text);
  }

  /// Takes out the lines of a key of the root table.
  void RemoveLines(const toml::node& value) {
    changes_.Replace(LineStart(Position(value.source().begin)),
                     LineEnd(Position(value.source().end)), "");
  }

  /// Adds a key to the table that holds `neighbour` under the key `neighbour_key`.
  void AddBeside(const toml::table& table, const toml::node& neighbour,
                 std::string_view neighbour_key, const std::string& key,
                 const std::string& value) {
    const std::size_t end = Position(neighbour.source().end);
    if (table.is_inline()) {
      changes_.Replace(end, end, ", " + key + " = " + value);
      return;
    }
    // The line up to the value, which has the indentation and any dotted prefix.
    const std::size_t begin = Position(neighbour.source().begin);
    std::string line = text_.substr(LineStart(begin), begin - LineStart(begin));
    line.replace(line.rfind(neighbour_key), neighbour_key.size(), key);
    changes_.Replace(LineEnd(end), LineEnd(end), line + value + "\n");
  }

  std::string Text() const { return changes_.Apply(text_); }

 private:
  std::size_t LineStart(std::size_t at) const {
    return at == 0 ? 0 : text_.rfind('\n', at - 1) + 1;
  }
  /// Behind the line break; the text ends with one.
  std::size_t LineEnd(std::size_t at) const {
    return std::min(text_.find('\n', at), text_.size() - 1) + 1;
  }

  /// Columns count code points.
  std::size_t Position(const toml::source_position& position) const {
    std::size_t at = 0;
    for (toml::source_index line = 1; line < position.line; ++line) {
      at = text_.find('\n', at) + 1;
    }
    for (toml::source_index column = 1; column < position.column; ++column) {
      ++at;
      while (at < text_.size() && (text_[at] & '\xc0') == '\x80') ++at;
    }
    return at;
  }

  std::string text_;
  toml::table root_;
  TextChanges changes_;
};

std::string TextWithLineEnd(const fs::path& file) {
  std::string text = ReadTextFile(file);
  if (!text.ends_with('\n')) text += '\n';
  return text;
}

void WriteNoise(SetupText& text, const Setup& setup, const SensorSetup& sensor,
                double sd) {
  const std::string path = "sensors." + sensor.channel;
  if (const auto given = text.At(path + ".noise_sd")) {
    text.Replace(*given.node(), AllDigits(sd));
  } else if (const auto power = text.At(path + ".noise_power")) {
    text.Replace(*power.node(), AllDigits(sd * sd / setup.rates.control));
  } else if (const auto element = text.At(path + ".element")) {
    text.AddBeside(*text.At(path).as_table(), *element.node(), "element", "noise_sd",
                   AllDigits(sd));
  }
}

/// Puts `suffix` in front of the closing quotation marks of a TOML string.
std::string WithSuffix(std::string quoted, const std::string& suffix) {
  const bool multiline = quoted.starts_with(R"(""")") || quoted.starts_with("'''");
  return quoted.insert(quoted.size() - (multiline ? 3 : 1), suffix);
}

}  // namespace

std::string ExtendSetup(const fs::path& setup_file, const Setup& setup,
                        const std::vector<PlacedEffect>& effects,
                        const fs::path& folder) {
  const fs::path file =
      fs::is_directory(setup_file) ? setup_file / "setup.toml" : setup_file;
  std::error_code ignored;
  if (fs::equivalent(file, folder / "setup.toml", ignored)) {
    throw InputError(folder.string(), "holds the nominal setup", "another folder");
  }
  SetupText text(file, TextWithLineEnd(file));
  const std::string kSuffix = " (extended)";
  const toml::node& name = *text.At("name").node();
  if (!name.value_or(std::string()).ends_with(kSuffix)) {
    text.Replace(name, WithSuffix(text.Raw(name), kSuffix));
  }
  text.Replace(*text.At("plant").node(), R"("plant.xml")");
  for (const char* key : {"analytic", "published"}) {
    if (const auto old = text.At(key)) text.RemoveLines(*old.node());
  }
  if (const auto friction = text.At("physics.static_friction")) {
    text.Replace(*friction.node(), "true");
  }
  for (const SensorSetup& sensor : setup.channels.sensors) {
    double sd = sensor.noise_sd;
    for (const PlacedEffect& placed : effects) {
      if (placed.site != sensor.element) continue;
      sd = placed.effect->NoiseSd(sd, placed.values);
    }
    if (sd != sensor.noise_sd) WriteNoise(text, setup, sensor, sd);
  }
  return text.Text();
}

}  // namespace mjdiag
