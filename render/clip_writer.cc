#include "mjdiag/render/clip_writer.h"

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <optional>

#include "mjdiag/render/frame_folder.h"
#include "mjdiag/render/scene/image_pixels.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/file_replacement.h"

namespace mjdiag {
namespace {

const std::filesystem::path& CheckName(const std::filesystem::path& file) {
  if (file.extension() == ".mp4") return file;
  throw InputError(file.string(), "not an mp4 file name", "a name that ends in .mp4");
}

// Trying an encoder that is missing is no error, so OpenCV need not report it.
class QuietOpenCv {
 public:
  QuietOpenCv() : level_(cv::utils::logging::setLogLevel(kSilent)) {}
  ~QuietOpenCv() { cv::utils::logging::setLogLevel(level_); }
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;

 private:
  static constexpr auto kSilent = cv::utils::logging::LOG_LEVEL_SILENT;
  cv::utils::logging::LogLevel level_;
};

// Opens the best encoder there is; returns its name.
std::string OpenEncoder(const std::filesystem::path& file, double fps, cv::Size size,
                        cv::VideoWriter& video) {
  const QuietOpenCv quiet;
  for (const char* codec : {"avc1", "mp4v"}) {
    const int code = cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]);
    if (video.open(file.string(), cv::CAP_FFMPEG, code, fps, size)) return codec;
  }
  throw InputError("clip", "no video encoder opens for " + file.string(),
                   "an OpenCV with FFmpeg and its H.264 or MPEG-4 encoder, and a "
                   "writable folder");
}

// OpenCV does not say when a write fails, for example on a full disk: look whether
// everything arrived.
void CheckComplete(const std::filesystem::path& file, int frames) {
  const QuietOpenCv quiet;
  cv::VideoCapture video(file.string(), cv::CAP_FFMPEG);
  if (video.isOpened() && video.get(cv::CAP_PROP_FRAME_COUNT) == frames) return;
  throw InputError(file.parent_path().string(), "the clip could not be written",
                   "a writable folder on a disk with space left");
}

}  // namespace

struct ClipWriter::State {
  State(const std::filesystem::path& file, int width, int height, double fps,
        const std::filesystem::path& folder)
      : replacement(CheckName(file)) {
    if (!folder.empty()) frames.emplace(folder);
    codec = OpenEncoder(replacement.temporary(), fps, {width, height}, video);
  }

  // The video must be closed before its temporary file is removed: it stands last.
  FileReplacement replacement;
  std::optional<FrameFolder> frames;
  std::string codec;
  cv::Mat bgr;
  int count = 0;
  cv::VideoWriter video;
};

ClipWriter::ClipWriter(const std::filesystem::path& file, int width, int height,
                       double fps, const std::filesystem::path& frames)
    : state_(std::make_unique<State>(file, width, height, fps, frames)) {}

ClipWriter::~ClipWriter() = default;

const std::string& ClipWriter::codec() const { return state_->codec; }

void ClipWriter::Write(const Image& picture) {
  cv::cvtColor(PixelsOf(picture), state_->bgr, cv::COLOR_RGB2BGR);
  state_->video.write(state_->bgr);
  if (state_->frames) state_->frames->Add(picture);
  ++state_->count;
}

void ClipWriter::Finish() {
  state_->video.release();
  CheckComplete(state_->replacement.temporary(), state_->count);
  if (state_->frames) state_->frames->Commit();
  state_->replacement.Commit();
}

}  // namespace mjdiag
