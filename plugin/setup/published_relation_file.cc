#include "mjdiag/plugin/setup/published_relation_file.h"

#include "mjdiag/plugin/setup/toml_table.h"

namespace mjdiag {
namespace {

constexpr const char* kRelationSchema = "mjdiag.published_row/1";
constexpr int kHighestPower = 100;
constexpr int kMostDigits = 17;

}  // namespace

PublishedRelation ReadPublishedRelation(const std::filesystem::path& file) {
  const TomlDocument document(file, {});
  const TomlTable root = document.Root();
  root.RequireSchema(kRelationSchema);
  PublishedRelation relation;
  relation.degree = root.Integer("degree", 1, kHighestPower);
  relation.digits = root.Integer("digits", 1, kMostDigits);
  for (const TomlTable& pin : root.TableArray("pins")) {
    relation.pins.push_back({pin.Text("channel"),
                             pin.Integer("power", 0, relation.degree),
                             pin.Number("value", kAnyNumber)});
  }
  const TomlTable coefficients = root.Table("coefficients");
  for (const std::string& channel : coefficients.Names("<channel>")) {
    relation.polynomials.push_back(
        {channel, coefficients.Numbers(channel, kAnyNumber)});
    if (static_cast<int>(relation.polynomials.back().coefficients.size()) >
        relation.degree + 1) {
      coefficients.Fail(channel, "holds too many coefficients",
                        "at most degree + 1 of them");
    }
  }
  document.RefuseUnknownKeys();
  return relation;
}

}  // namespace mjdiag
