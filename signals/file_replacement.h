#pragma once
// Files that appear at once or not at all: a writer fills a temporary file next to the
// target, which is renamed when it is complete. Whoever reads the target sees the old
// file or the new one, never half of one.

#include <filesystem>

namespace mjdiag {

class FileReplacement {
 public:
  /// Makes the empty temporary file. InputError if the target's folder is missing or
  /// not writable, or the target must not be replaced (a folder, a device).
  explicit FileReplacement(std::filesystem::path target);
  /// Removes the temporary file unless it was committed.
  ~FileReplacement();
  FileReplacement(const FileReplacement&) = delete;
  FileReplacement& operator=(const FileReplacement&) = delete;

  /// Where to write: in the target's folder, with the target's extension.
  const std::filesystem::path& temporary() const { return temporary_; }
  /// Renames the closed temporary file to the target, at once or with the other files of
  /// a FolderUpdate. InputError if that fails.
  void Commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path temporary_;
};

/// Removes temporary files whose writer was killed from a folder: of a process that is
/// gone, and untouched for a minute, as the process may run on another computer.
void RemoveAbandonedFiles(const std::filesystem::path& folder);

}  // namespace mjdiag
