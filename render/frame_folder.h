#pragma once
// The pictures of a clip as numbered PNG files, which appear in their folder together.

#include <filesystem>

#include "mjdiag/render/scene/image.h"

namespace mjdiag {

class FrameFolder {
 public:
  /// InputError if `folder` can be neither made nor written to.
  explicit FrameFolder(std::filesystem::path folder);
  /// Removes what was not committed.
  ~FrameFolder();
  FrameFolder(const FrameFolder&) = delete;
  FrameFolder& operator=(const FrameFolder&) = delete;

  /// Writes the next frame.
  void Add(const Image& picture);
  /// Moves the frames to frame_000000.png, ... in the folder, in place of older ones.
  void Commit();

 private:
  std::filesystem::path folder_;
  std::filesystem::path temporary_;
  bool made_folder_ = false;
  int count_ = 0;
};

}  // namespace mjdiag
