#include "mjdiag/plugin/setup/record_manifest.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "mjdiag/plugin/setup/toml_table.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

void CheckOverrides(const TomlTable& table, const std::vector<std::string>& overrides) {
  constexpr std::array<std::string_view, 3> kAllowed{"axes.", "record.", "compare."};
  for (const std::string& text : overrides) {
    if (std::ranges::none_of(kAllowed,
                             [&](auto prefix) { return text.starts_with(prefix); })) {
      table.Fail("set", "changes '" + text.substr(0, text.find('=')) + "'",
                 "keys under axes, record or compare; `plant` names another plant, "
                 "`numbers` what is other in this one");
    }
  }
}

}  // namespace

std::vector<ManifestRecord> ReadRecordManifest(const std::filesystem::path& manifest,
                                               const std::filesystem::path& folder) {
  const TomlDocument document(manifest, {});
  std::vector<ManifestRecord> records;
  for (const TomlTable& table : document.Root().TableArray("record")) {
    const std::string role = table.Text("role", "fit");
    if (role != "fit" && role != "validation") {
      table.Fail("role", "is \"" + role + "\"", "\"fit\" or \"validation\"");
    }
    ManifestRecord record{folder / table.Text("file"), role == "fit",
                          table.Overrides("set"), table.Text("plant", ""),
                          table.TextNumbers("numbers")};
    CheckOverrides(table, record.overrides);
    if (std::ranges::count(records, record.file, &ManifestRecord::file) > 0) {
      table.Fail("file", "is named twice", "every record once");
    }
    records.push_back(std::move(record));
  }
  document.RefuseUnknownKeys();
  if (std::ranges::none_of(records, &ManifestRecord::fit)) {
    throw InputError(manifest.string(), "no record to fit",
                     "[[record]] tables with role \"fit\"");
  }
  return records;
}

}  // namespace mjdiag
