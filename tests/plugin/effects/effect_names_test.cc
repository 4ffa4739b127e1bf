// Effects are known by their own files only.

#include <gtest/gtest.h>

#include <filesystem>

#include "mjdiag/plugin/effects/registry.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;

/// The folders with code, but those that hold effects or examples of them.
const std::vector<std::string>& Folders() {
  static const std::vector<std::string> folders{
      "signals", "controllers", "diagnosis", "plugin", "discovery",  "studies",
      "watch",   "render",      "report",    "app",    "tests/bench"};
  return folders;
}

std::vector<fs::path> Sources() {
  const fs::path root(MJDIAG_SOURCE_DIR);
  std::vector<fs::path> sources;
  for (const std::string& folder : Folders()) {
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const fs::path& file = entry.path();
      const bool source = file.extension() == ".cc" || file.extension() == ".h";
      const bool effect =
          file.parent_path().parent_path() == root / "plugin" / "effects";
      if (source && !effect) sources.push_back(file);
    }
  }
  return sources;
}

TEST(EffectNames, AreStringsInNoOtherSourceThanTheirOwn) {
  const std::vector<fs::path> sources = Sources();
  EXPECT_GT(sources.size(), 300u);
  for (const fs::path& file : sources) {
    const std::string text = ReadTextFile(file);
    for (const Effect* effect : Effects()) {
      EXPECT_EQ(text.find('"' + effect->name() + '"'), std::string::npos)
          << effect->name() << " in " << file;
    }
  }
}

}  // namespace
}  // namespace mjdiag
