#include "mjdiag/signals/file_replacement.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/folder_update.h"

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

void Rename(const fs::path& temporary, const fs::path& target) {
  std::error_code error;
  fs::rename(temporary, target, error);
  if (error) {
    throw InputError(target.string(), "cannot be replaced (" + error.message() + ")",
                     "a writable file");
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
  if (FolderUpdate* update = FolderUpdate::Current()) {
    update->waiting_.emplace_back(temporary_, target_);
  } else {
    Rename(temporary_, target_);
  }
  temporary_.clear();
}

void RemoveAbandonedFiles(const fs::path& folder) {
  // As TemporaryName makes them.
  static const std::regex pattern(R"(\..*\.(\d{1,9})-\d+\.part(\.[^.]*)?)");
  std::error_code ignored;
  std::vector<fs::path> abandoned;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    std::smatch match;
    if (!std::regex_match(name, match, pattern)) continue;
    const bool is_gone = kill(std::stoi(match[1]), 0) != 0 && errno == ESRCH;
    const auto age = fs::file_time_type::clock::now() - entry.last_write_time(ignored);
    if (is_gone && age > std::chrono::minutes(1)) abandoned.push_back(entry.path());
  }
  for (const fs::path& file : abandoned) fs::remove(file, ignored);
}

FolderUpdate*& FolderUpdate::Current() {
  thread_local FolderUpdate* current = nullptr;
  return current;
}

FolderUpdate::FolderUpdate() : outer_(Current()) { Current() = this; }

FolderUpdate::~FolderUpdate() {
  Current() = outer_;
  std::error_code ignored;
  for (const auto& [temporary, target] : waiting_) fs::remove(temporary, ignored);
}

void FolderUpdate::Commit() {
  if (outer_ != nullptr) {
    outer_->waiting_.insert(outer_->waiting_.end(), waiting_.begin(), waiting_.end());
  } else {
    for (const auto& [temporary, target] : waiting_) Rename(temporary, target);
  }
  waiting_.clear();
}

}  // namespace mjdiag
