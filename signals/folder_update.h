#pragma once
// Several files that appear together: while an update lives, the files that its thread
// replaces are written and wait; Commit renames them all, one right behind the other.
// Whoever fails or is killed before leaves every old file as it was.

#include <filesystem>
#include <utility>
#include <vector>

namespace mjdiag {

class FolderUpdate {
 public:
  /// Within another update it is a part of that one.
  FolderUpdate();
  /// Removes what waits unless it was committed.
  ~FolderUpdate();
  FolderUpdate(const FolderUpdate&) = delete;
  FolderUpdate& operator=(const FolderUpdate&) = delete;

  /// Renames what waits, or hands it to the update around. InputError if a file cannot
  /// be replaced.
  void Commit();

 private:
  friend class FileReplacement;
  /// That of this thread, or none.
  static FolderUpdate*& Current();

  FolderUpdate* outer_;
  /// Temporary file and target.
  std::vector<std::pair<std::filesystem::path, std::filesystem::path>> waiting_;
};

}  // namespace mjdiag
