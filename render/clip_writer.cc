#include "mjdiag/render/clip_writer.h"

#include <optional>

#include "mjdiag/render/frame_folder.h"
#include "mjdiag/render/video_file.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/file_replacement.h"
#include "mjdiag/signals/loaded_module.h"

namespace mjdiag {
namespace {

const std::filesystem::path& CheckName(const std::filesystem::path& file) {
  if (file.extension() == ".mp4") return file;
  throw InputError(file.string(), "not an mp4 file name", "a name that ends in .mp4");
}

std::unique_ptr<VideoFile> OpenVideo(const std::filesystem::path& file, int width,
                                     int height, double fps) {
  static const auto open = reinterpret_cast<OpenVideoFile*>(
      FunctionOf({"libmjdiag-video.so", "MJDIAG_VIDEO_MODULE", kVideoFileFunction},
                 "the module of clips (package mjdiag-video) of this version, and the "
                 "libraries of OpenCV's videoio"));
  std::unique_ptr<VideoFile> video(open(file.c_str(), width, height, fps));
  if (video) return video;
  throw InputError("clip", "no video encoder opens for " + file.string(),
                   "an OpenCV with FFmpeg and its H.264 or MPEG-4 encoder, and a "
                   "writable folder");
}

}  // namespace

struct ClipWriter::State {
  State(const std::filesystem::path& file, int width, int height, double fps,
        const std::filesystem::path& folder)
      : replacement(CheckName(file)) {
    if (!folder.empty()) frames.emplace(folder);
    video = OpenVideo(replacement.temporary(), width, height, fps);
    codec = video->codec();
  }

  // The video must be closed before its temporary file is removed: it stands last.
  FileReplacement replacement;
  std::optional<FrameFolder> frames;
  std::string codec;
  std::unique_ptr<VideoFile> video;
};

ClipWriter::ClipWriter(const std::filesystem::path& file, int width, int height,
                       double fps, const std::filesystem::path& frames)
    : state_(std::make_unique<State>(file, width, height, fps, frames)) {}

ClipWriter::~ClipWriter() = default;

const std::string& ClipWriter::codec() const { return state_->codec; }

void ClipWriter::Write(const Image& picture) {
  state_->video->Write(picture.rgb.data());
  if (state_->frames) state_->frames->Add(picture);
}

void ClipWriter::Finish() {
  if (!state_->video->Finish()) {
    throw InputError(state_->replacement.temporary().parent_path().string(),
                     "the clip could not be written",
                     "a writable folder on a disk with space left");
  }
  if (state_->frames) state_->frames->Commit();
  state_->replacement.Commit();
}

}  // namespace mjdiag
