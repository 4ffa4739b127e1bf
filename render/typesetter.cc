#include "mjdiag/render/typesetter.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

namespace mjdiag {
namespace {

constexpr int kOversampling = 8;
constexpr int kFace = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kCapitals = 0.72;      // height of capitals [em]
constexpr double kFaceCapitals = 21.0;  // the same in the font's own units
constexpr double kSpace = 0.36;         // advance of a blank [em]
constexpr double kAscent = 1.0;         // picture above the baseline [em]
constexpr double kDescent = 0.5;        // and below [em]
constexpr char32_t kMicro = 0x00B5;
constexpr char32_t kTimes = 0x00D7;
constexpr char32_t kMinus = 0x2212;
constexpr char32_t kDot = 0x00B7;

std::vector<char32_t> Decode(std::string_view utf8) {
  std::vector<char32_t> characters;
  for (const char raw : utf8) {
    const auto byte = static_cast<unsigned char>(raw);
    if ((byte & 0xC0) == 0x80 && !characters.empty()) {
      characters.back() = (characters.back() << 6) | (byte & 0x3F);
    } else {
      const int lead = byte < 0x80 ? 0x7F : byte < 0xE0 ? 0x1F : byte < 0xF0 ? 0x0F : 7;
      characters.push_back(byte & lead);
    }
  }
  return characters;
}

// The character of the stroke font that lends its shape or its width.
std::string FaceCharacter(char32_t character) {
  if (character == kMicro) return "u";
  if (character == kTimes || character == kMinus) return "x";
  if (character == kDot) return ".";
  if (character < 0x20 || character > 0x7E) return "?";
  return {static_cast<char>(character)};
}

double StrokeWidth(const Font& font) {
  return font.em * (font.weight == Weight::kBold ? 0.125 : 0.088);
}

// Strokes that the font lacks, in em from the pen: x to the right, y down.
struct Stroke {
  cv::Point2d from;
  cv::Point2d to;
};
std::vector<Stroke> OwnStrokes(char32_t character, double advance) {
  const double middle = advance / 2.0;
  switch (character) {
    case kMicro:  // u with a tail
      return {{{0.19, -0.42}, {0.12, 0.22}}};
    case kTimes:
      return {{{middle - 0.2, -0.5}, {middle + 0.2, -0.1}},
              {{middle - 0.2, -0.1}, {middle + 0.2, -0.5}}};
    case kMinus:
      return {{{middle - 0.23, -0.3}, {middle + 0.23, -0.3}}};
    case kDot:
      return {{{middle, -0.3}, {middle, -0.3}}};
    default:
      return {};
  }
}

bool TakesFaceShape(char32_t character) {
  return character != kTimes && character != kMinus && character != kDot;
}

}  // namespace

int Typesetter::Width(std::string_view text, const Font& font) {
  double width = 0.0;
  for (const char32_t character : Decode(text)) width += Find(character, font).advance;
  return static_cast<int>(std::ceil(width));
}

void Typesetter::Draw(std::string_view text, cv::Point origin, const Font& font,
                      const cv::Scalar& rgb, cv::Mat& picture) {
  const cv::Rect whole({0, 0}, picture.size());
  double pen = origin.x;
  for (const char32_t character : Decode(text)) {
    const Glyph& glyph = Find(character, font);
    const cv::Point corner =
        cv::Point(static_cast<int>(std::lround(pen)), origin.y) + glyph.offset;
    const cv::Rect box = cv::Rect(corner, glyph.coverage.size()) & whole;
    for (int y = box.y; y < box.y + box.height; ++y) {
      const auto* coverage = glyph.coverage.ptr<std::uint8_t>(y - corner.y);
      auto* pixels = picture.ptr<cv::Vec3b>(y);
      for (int x = box.x; x < box.x + box.width; ++x) {
        const int a = coverage[x - corner.x];
        if (a == 0) continue;
        for (int c = 0; c < 3; ++c) {
          const int ink = static_cast<int>(rgb[c]);
          pixels[x][c] = static_cast<std::uint8_t>(
              (pixels[x][c] * (255 - a) + ink * a + 127) / 255);
        }
      }
    }
    pen += glyph.advance;
  }
}

std::string Typesetter::Fit(std::string_view text, int width, const Font& font) {
  if (Width(text, font) <= width) return std::string(text);
  std::string kept(text);
  const std::string ellipsis = "...";
  while (!kept.empty() && Width(kept + ellipsis, font) > width) {
    // A character of several bytes goes as a whole.
    while (kept.size() > 1 && (kept.back() & 0xC0) == 0x80) kept.pop_back();
    kept.pop_back();
  }
  return kept + ellipsis;
}

const Typesetter::Glyph& Typesetter::Find(char32_t character, const Font& font) {
  const Key key{character, font.em, font.weight};
  const auto found = glyphs_.find(key);
  if (found != glyphs_.end()) return found->second;
  return glyphs_.emplace(key, Make(character, font)).first->second;
}

Typesetter::Glyph Typesetter::Make(char32_t character, const Font& font) {
  const double em = font.em * kOversampling;  // [fine px]
  const double scale = em * kCapitals / kFaceCapitals;
  const int thickness =
      std::max(1, static_cast<int>(std::lround(StrokeWidth(font) * kOversampling)));
  const std::string shape = FaceCharacter(character);

  Glyph glyph;
  if (character == U' ') {
    glyph.advance = kSpace * font.em;
    return glyph;
  }
  // At a large scale the integer width of getTextSize is as good as the real one.
  constexpr double kMeasure = 100.0;
  const int units = cv::getTextSize(shape, kFace, kMeasure, 0, nullptr).width;
  glyph.advance = units / kMeasure * scale / kOversampling;

  const int margin = static_cast<int>(std::ceil(0.2 * font.em));  // [px]
  const int width = static_cast<int>(std::ceil(glyph.advance)) + 2 * margin;
  const int above = static_cast<int>(std::ceil(kAscent * font.em));
  const int below = static_cast<int>(std::ceil(kDescent * font.em));
  cv::Mat fine =
      cv::Mat::zeros((above + below) * kOversampling, width * kOversampling, CV_8U);
  const cv::Point pen(margin * kOversampling, above * kOversampling);
  if (TakesFaceShape(character)) {
    cv::putText(fine, shape, pen, kFace, scale, 255, thickness, cv::LINE_AA);
  }
  const auto place = [&](cv::Point2d em_position) {
    return pen + cv::Point(static_cast<int>(std::lround(em_position.x * em)),
                           static_cast<int>(std::lround(em_position.y * em)));
  };
  for (const Stroke& stroke : OwnStrokes(character, glyph.advance / font.em)) {
    cv::line(fine, place(stroke.from), place(stroke.to), 255, thickness, cv::LINE_AA);
  }
  cv::resize(fine, glyph.coverage, {width, above + below}, 0, 0, cv::INTER_AREA);
  glyph.offset = {-margin, -above};
  return glyph;
}

}  // namespace mjdiag
