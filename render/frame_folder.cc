#include "mjdiag/render/frame_folder.h"

#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;

std::string FrameName(int index) {
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "frame_%06d.png", index);
  return name.data();
}

bool IsFrame(const fs::path& file) {
  return file.extension() == ".png" && file.filename().string().starts_with("frame_");
}

}  // namespace

FrameFolder::FrameFolder(fs::path folder)
    : folder_(std::move(folder)), temporary_(folder_ / ".frames.part") {
  made_folder_ = !fs::exists(folder_);
  MakeOutputFolder(folder_);
  fs::remove_all(temporary_);
  MakeOutputFolder(temporary_);
}

FrameFolder::~FrameFolder() {
  std::error_code ignored;
  fs::remove_all(temporary_, ignored);
  // Succeeds only if the folder is empty.
  if (made_folder_) fs::remove(folder_, ignored);
}

void FrameFolder::Add(const Image& picture) {
  WritePng(temporary_ / FrameName(count_), picture);
  ++count_;
}

void FrameFolder::Commit() {
  try {
    std::vector<fs::path> older;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
      if (IsFrame(entry.path())) older.push_back(entry.path());
    }
    for (const fs::path& file : older) fs::remove(file);
    for (int i = 0; i < count_; ++i) {
      fs::rename(temporary_ / FrameName(i), folder_ / FrameName(i));
    }
  } catch (const fs::filesystem_error& error) {
    throw InputError(folder_.string(), error.code().message(),
                     "a folder that frames can be moved to");
  }
}

}  // namespace mjdiag
