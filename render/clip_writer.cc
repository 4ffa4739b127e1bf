#include "mjdiag/render/clip_writer.h"

#include <array>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <optional>
#include <utility>

#include "mjdiag/render/frame_folder.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/file_replacement.h"

namespace mjdiag {
namespace {

constexpr std::size_t kQueueLength = 4;

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
  for (const std::string codec : {"avc1", "mp4v"}) {
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

class ClipWriter::Output {
 public:
  Output(const std::filesystem::path& file, int width, int height, double fps,
         const std::filesystem::path& frames)
      : replacement_(CheckName(file)) {
    if (!frames.empty()) frames_.emplace(frames);
    codec_ = OpenEncoder(replacement_.temporary(), fps, {width, height}, video_);
  }

  void Add(const Image& picture) {
    const cv::Mat rgb(picture.height, picture.width, CV_8UC3,
                      const_cast<std::uint8_t*>(picture.rgb.data()));
    cv::cvtColor(rgb, bgr_, cv::COLOR_RGB2BGR);
    video_.write(bgr_);
    if (frames_) frames_->Add(picture);
    ++count_;
  }

  void Commit() {
    video_.release();
    CheckComplete(replacement_.temporary(), count_);
    if (frames_) frames_->Commit();
    replacement_.Commit();
  }

  const std::string& codec() const { return codec_; }

 private:
  // The video must be closed before its temporary file is removed: it stands last.
  FileReplacement replacement_;
  std::optional<FrameFolder> frames_;
  std::string codec_;
  cv::Mat bgr_;
  int count_ = 0;
  cv::VideoWriter video_;
};

ClipWriter::ClipWriter(const std::filesystem::path& file, int width, int height,
                       double fps, const std::filesystem::path& frames)
    : output_(std::make_unique<Output>(file, width, height, fps, frames)),
      thread_([this] { Run(); }) {}

ClipWriter::~ClipWriter() {
  {
    const std::lock_guard lock(mutex_);
    queue_.clear();
  }
  Join();
}

const std::string& ClipWriter::codec() const { return output_->codec(); }

void ClipWriter::Write(Image& picture) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return queue_.size() < kQueueLength || failure_; });
  if (failure_) std::rethrow_exception(failure_);
  queue_.push_back(std::move(picture));
  picture = {};
  if (!spare_.empty()) {
    picture = std::move(spare_.back());
    spare_.pop_back();
  }
  changed_.notify_all();
}

void ClipWriter::Finish() {
  Join();
  if (failure_) std::rethrow_exception(failure_);
  output_->Commit();
}

void ClipWriter::Join() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
}

void ClipWriter::Run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return !queue_.empty() || closing_; });
    if (queue_.empty()) return;
    Image picture = std::move(queue_.front());
    queue_.pop_front();
    changed_.notify_all();
    lock.unlock();
    std::exception_ptr failure;
    try {
      output_->Add(picture);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (failure) {
      failure_ = failure;
      changed_.notify_all();
      return;
    }
    spare_.push_back(std::move(picture));
  }
}

}  // namespace mjdiag
