#pragma once
// Colours (RGB, 0 .. 255). Those of the runs are Okabe and Ito's, which people with any
// kind of colour vision tell apart; light and dark alternate, so grey prints work too.

#include <array>
#include <cstddef>
#include <opencv2/core.hpp>

namespace mjdiag::palette {

inline const cv::Scalar kInk{28, 32, 38};        // text
inline const cv::Scalar kQuietInk{92, 99, 110};  // axis numbers, captions
inline const cv::Scalar kPaper{252, 252, 253};   // behind text and plots
inline const cv::Scalar kGrid{222, 226, 231};
inline const cv::Scalar kRule{178, 184, 192};    // frames, zero lines
inline const cv::Scalar kWarning{240, 228, 66};  // Okabe and Ito's yellow, on ink

/// Colour of the n-th run: blue, vermillion, bluish green, reddish purple, orange.
inline cv::Scalar OfRun(std::size_t run) {
  static const std::array<cv::Scalar, 5> kRuns{
      cv::Scalar{0, 114, 178}, cv::Scalar{213, 94, 0}, cv::Scalar{0, 158, 115},
      cv::Scalar{204, 121, 167}, cv::Scalar{230, 159, 0}};
  return kRuns[run % kRuns.size()];
}

/// A part of `rgb` on paper; share 0: paper, 1: the colour.
inline cv::Scalar Tint(const cv::Scalar& rgb, double share) {
  return kPaper + (rgb - kPaper) * share;
}

}  // namespace mjdiag::palette
