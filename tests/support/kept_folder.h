#pragma once
// Folders that tests write, for programs that read them afterwards: copies below the folder
// that MJDIAG_KEPT_FOLDERS names, each under its whole path, so that files in it find those
// of other kept folders. Without that variable nothing is kept.

#include <cstdlib>
#include <filesystem>

namespace mjdiag::test {

inline void KeepFolder(const std::filesystem::path& folder) {
  const char* kept = std::getenv("MJDIAG_KEPT_FOLDERS");
  if (kept == nullptr) return;
  namespace fs = std::filesystem;
  const fs::path copy = fs::path(kept) / fs::absolute(folder).relative_path();
  fs::create_directories(copy);
  fs::copy(folder, copy,
           fs::copy_options::recursive | fs::copy_options::overwrite_existing);
}

}  // namespace mjdiag::test
