#pragma once
// The clip of a run folder, as `mjdiag render` wrote it.

#include <filesystem>
#include <optional>
#include <string>

namespace mjdiag {

struct ClipFile {
  std::string name;     ///< of the file
  std::string bytes;    ///< the whole file, MP4
  std::string codec;    ///< of its pictures: "avc1" (H.264), "mp4v", ...
  std::string caption;  ///< what it shows, how slow, how much is amplified
  std::string command;  ///< that made it; empty: not known

  bool PlaysInBrowsers() const { return codec == "avc1"; }
};

/// clip.mp4 of the folder with what render.json says about it; none if there is no
/// clip. InputError if either cannot be read, is damaged or broken off.
std::optional<ClipFile> ReadClipOf(const std::filesystem::path& folder);

}  // namespace mjdiag
