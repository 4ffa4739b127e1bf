#pragma once
// Encodes pictures to an mp4 file and PNG files.

#include <filesystem>
#include <memory>
#include <string>

#include "mjdiag/render/scene/image.h"

namespace mjdiag {

class ClipWriter {
 public:
  /// @param frames  folder for PNGs; empty: none
  /// InputError if the file or folder cannot be written or no encoder opens.
  ClipWriter(const std::filesystem::path& file, int width, int height, double fps,
             const std::filesystem::path& frames);
  /// Without Finish, everything written so far is removed.
  ~ClipWriter();
  ClipWriter(const ClipWriter&) = delete;
  ClipWriter& operator=(const ClipWriter&) = delete;

  void Write(const Image& picture);
  /// Puts the files in place. InputError if not everything arrived in them.
  void Finish();

  /// "avc1" (H.264) or "mp4v".
  const std::string& codec() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mjdiag
