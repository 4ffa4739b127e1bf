#include "mjdiag/signals/file_replacement.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <utility>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;

/// Unique among processes by the process id, within one by a counter. The extension
/// stays at the end because some writers choose the format by it.
fs::path TemporaryName(const fs::path& target) {
  static std::atomic<unsigned> counter{0};
  return target.parent_path() /
         ("." + target.stem().string() + "." + std::to_string(getpid()) + "-" +
          std::to_string(counter++) + ".part" + target.extension().string());
}

void RequireReplaceable(const fs::path& target) {
  std::error_code ignored;
  const fs::path folder = target.has_parent_path() ? target.parent_path() : ".";
  if (!fs::is_directory(folder, ignored)) {
    throw InputError(target.string(), "no folder " + folder.string(),
                     "an existing folder");
  }
  if (fs::exists(target, ignored) && !fs::is_regular_file(target, ignored)) {
    throw InputError(target.string(), "not a regular file", "the name of a file");
  }
}

}  // namespace

FileReplacement::FileReplacement(fs::path target)
    : target_(std::move(target)), temporary_(TemporaryName(target_)) {
  RequireReplaceable(target_);
  errno = 0;
  if (!std::ofstream(temporary_, std::ios::binary)) {
    throw InputError(target_.string(),
                     std::string("cannot be written (") + std::strerror(errno) + ")",
                     "a writable folder");
  }
}

FileReplacement::~FileReplacement() {
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove(temporary_, ignored);
}

void FileReplacement::Commit() {
  std::error_code error;
  fs::rename(temporary_, target_, error);
  if (error) {
    throw InputError(target_.string(), "cannot be replaced (" + error.message() + ")",
                     "a writable file");
  }
  temporary_.clear();
}

}  // namespace mjdiag
