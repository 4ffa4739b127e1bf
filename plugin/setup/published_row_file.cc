#include "mjdiag/plugin/setup/published_row_file.h"

#include "mjdiag/plugin/setup/toml_table.h"

namespace mjdiag {
namespace {

constexpr const char* kRowSchema = "mjdiag.published_row/1";
constexpr int kHighestPower = 100;
constexpr int kMostDigits = 17;

}  // namespace

PublishedRow ReadPublishedRow(const std::filesystem::path& file) {
  const TomlDocument document(file, {});
  const TomlTable root = document.Root();
  root.RequireSchema(kRowSchema);
  PublishedRow row;
  row.degree = root.Integer("degree", 1, kHighestPower);
  row.digits = root.Integer("digits", 1, kMostDigits);
  for (const TomlTable& pin : root.TableArray("pins")) {
    row.pins.push_back({pin.Text("channel"), pin.Integer("power", 0, row.degree),
                        pin.Number("value", kAnyNumber)});
  }
  const TomlTable coefficients = root.Table("coefficients");
  for (const std::string& channel : coefficients.Names("<channel>")) {
    row.polynomials.push_back({channel, coefficients.Numbers(channel, kAnyNumber)});
    if (static_cast<int>(row.polynomials.back().coefficients.size()) > row.degree + 1) {
      coefficients.Fail(channel, "holds too many coefficients",
                        "at most degree + 1 of them");
    }
  }
  document.RefuseUnknownKeys();
  return row;
}

}  // namespace mjdiag
