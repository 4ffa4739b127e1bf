#pragma once
// A video file, written by a module (loaded_module.h): what encodes links hundreds of
// libraries, for which every other command would wait.

#include <cstdint>

namespace mjdiag {

class VideoFile {
 public:
  virtual ~VideoFile() = default;

  /// "avc1" or "mp4v".
  virtual const char* codec() const = 0;
  /// Rows of pixels from the top, red, green and blue.
  virtual void Write(const std::uint8_t* rgb) = 0;
  /// Closes it. Whether all the frames are in it: writing fails without a word, for example
  /// on a full disk.
  virtual bool Finish() = 0;
};

/// Null: no encoder opens.
using OpenVideoFile = VideoFile*(const char* file, int width, int height, double fps);
inline constexpr const char* kVideoFileFunction = "mjdiag_open_video_file";

}  // namespace mjdiag
