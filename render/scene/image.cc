#include "mjdiag/render/scene/image.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "mjdiag/render/scene/image_pixels.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag {

std::string EncodePng(const Image& image) {
  cv::Mat bgr;
  cv::cvtColor(PixelsOf(image), bgr, cv::COLOR_RGB2BGR);
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", bgr, bytes);
  return {bytes.begin(), bytes.end()};
}

void WritePng(const std::filesystem::path& file, const Image& image) {
  WriteTextFile(file, EncodePng(image));
}

}  // namespace mjdiag
