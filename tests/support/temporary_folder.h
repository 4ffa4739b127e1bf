#pragma once
// A folder of its own for a test, removed at its end. Tests run side by side, each in
// its own process: nothing they write may have a name that another could choose.

#include <filesystem>
#include <fstream>
#include <string>

#include "mjdiag/signals/scratch_folder.h"

namespace mjdiag::test {

class TemporaryFolder : public ScratchFolder {
 public:
  using ScratchFolder::ScratchFolder;
  ~TemporaryFolder() {
    // What a test took away.
    std::error_code ignored;
    std::filesystem::permissions(path(), std::filesystem::perms::owner_all, ignored);
  }

  std::filesystem::path operator/(const std::string& name) const {
    return path() / name;
  }
  /// Writes a file and returns its path.
  std::string Write(const std::string& name, const std::string& text) const {
    std::ofstream(path() / name, std::ios::binary) << text;
    return (path() / name).string();
  }
  /// Number of entries.
  std::ptrdiff_t size() const {
    return std::distance(std::filesystem::directory_iterator(path()), {});
  }
};

}  // namespace mjdiag::test
