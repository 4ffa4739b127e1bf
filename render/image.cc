#include "mjdiag/render/image.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string_view>

#include "mjdiag/signals/text_file.h"

namespace mjdiag {

void WritePng(const std::filesystem::path& file, const Image& image) {
  // OpenCV has no const view of foreign pixels; cvtColor only reads them.
  const cv::Mat rgb(image.height, image.width, CV_8UC3,
                    const_cast<std::uint8_t*>(image.rgb.data()));
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", bgr, bytes);
  WriteTextFile(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace mjdiag
