#pragma once
// The pixels of a picture as OpenCV sees them, without a copy.

#include <opencv2/core.hpp>

#include "mjdiag/render/scene/image.h"

namespace mjdiag {

/// To be read only: OpenCV has no const view of foreign pixels.
inline cv::Mat PixelsOf(const Image& image) {
  return {image.height, image.width, CV_8UC3,
          const_cast<std::uint8_t*>(image.rgb.data())};
}

}  // namespace mjdiag
