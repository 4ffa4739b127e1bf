#pragma once
// Smooth text on pictures. OpenCV's stroke font is drawn large and averaged down, one
// character at a time; characters are kept, so that moving numbers cost little.

#include <map>
#include <opencv2/core.hpp>
#include <string_view>
#include <tuple>

namespace mjdiag {

enum class Weight { kRegular, kBold };

/// Size of a text: `em` [px] is the line height's unit, capitals are 0.72 em high.
struct Font {
  double em = 16.0;
  Weight weight = Weight::kRegular;
};

class Typesetter {
 public:
  /// Advance width of UTF-8 text [px].
  int Width(std::string_view text, const Font& font);
  /// Draws with the baseline's left end at `origin`; clipped at the picture's edge.
  /// `picture` is 8-bit RGB.
  void Draw(std::string_view text, cv::Point origin, const Font& font,
            const cv::Scalar& rgb, cv::Mat& picture);
  /// The text, or as much of it as fits into `width` with "..." behind.
  std::string Fit(std::string_view text, int width, const Font& font);

 private:
  struct Glyph {
    cv::Mat coverage;  // 8-bit; its left top lies at `offset` from the pen
    cv::Point offset;
    double advance = 0.0;  // [px]
  };
  using Key = std::tuple<char32_t, double, Weight>;

  const Glyph& Find(char32_t character, const Font& font);
  static Glyph Make(char32_t character, const Font& font);

  std::map<Key, Glyph> glyphs_;
};

}  // namespace mjdiag
