// Clips through OpenCV and FFmpeg.

#include <memory>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <string>

#include "mjdiag/render/video_file.h"

namespace mjdiag {
namespace {

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

class OpenCvFile final : public VideoFile {
 public:
  OpenCvFile(const char* file, int width, int height, double fps)
      : file_(file), rows_(height), columns_(width) {
    const QuietOpenCv quiet;
    // The best encoder there is.
    for (const char* codec : {"avc1", "mp4v"}) {
      const int code = cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]);
      if (!video_.open(file_, cv::CAP_FFMPEG, code, fps, {width, height})) continue;
      codec_ = codec;
      return;
    }
  }

  const char* codec() const override { return codec_; }

  void Write(const std::uint8_t* rgb) override {
    // OpenCV has no view of pixels that are constant.
    const cv::Mat pixels(rows_, columns_, CV_8UC3, const_cast<std::uint8_t*>(rgb));
    cv::cvtColor(pixels, bgr_, cv::COLOR_RGB2BGR);
    video_.write(bgr_);
    ++count_;
  }

  bool Finish() override {
    video_.release();
    const QuietOpenCv quiet;
    cv::VideoCapture written(file_, cv::CAP_FFMPEG);
    return written.isOpened() && written.get(cv::CAP_PROP_FRAME_COUNT) == count_;
  }

 private:
  std::string file_;
  int rows_;
  int columns_;
  const char* codec_ = nullptr;
  int count_ = 0;
  cv::Mat bgr_;
  cv::VideoWriter video_;
};

}  // namespace
}  // namespace mjdiag

extern "C" __attribute__((visibility("default"))) mjdiag::VideoFile*
mjdiag_open_video_file(const char* file, int width, int height, double fps);

mjdiag::VideoFile* mjdiag_open_video_file(const char* file, int width, int height,
                                          double fps) {
  auto opened = std::make_unique<mjdiag::OpenCvFile>(file, width, height, fps);
  return opened->codec() == nullptr ? nullptr : opened.release();
}
