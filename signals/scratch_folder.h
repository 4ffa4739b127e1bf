#pragma once
// A folder of its own for what nobody keeps, removed at its end.

#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkdtemp is POSIX

#include <filesystem>
#include <string>
#include <system_error>

#include "mjdiag/signals/error.h"

namespace mjdiag {

class ScratchFolder {
 public:
  /// InputError if there is no room for it.
  explicit ScratchFolder(
      const std::filesystem::path& within = std::filesystem::temp_directory_path()) {
    std::string name = (within / "mjdiag-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw InputError(name, "cannot be made", "a folder for temporary files");
    }
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace mjdiag
