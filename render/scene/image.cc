#include "mjdiag/render/scene/image.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string_view>

#include "mjdiag/render/scene/image_pixels.h"
#include "mjdiag/signals/text_file.h"

namespace mjdiag {

void WritePng(const std::filesystem::path& file, const Image& image) {
  cv::Mat bgr;
  cv::cvtColor(PixelsOf(image), bgr, cv::COLOR_RGB2BGR);
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", bgr, bytes);
  WriteTextFile(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace mjdiag
