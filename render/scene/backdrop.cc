#include "mjdiag/render/scene/backdrop.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mjdiag {
namespace {

constexpr int kSide = 128;  // of a cube face [texels]
constexpr std::array<double, 3> kZenith{176, 196, 216};
constexpr std::array<double, 3> kGround{244, 246, 248};

enum class Face { kRight, kLeft, kUp, kDown, kFront, kBack };
constexpr std::array kFaces{Face::kRight, Face::kLeft,  Face::kUp,
                            Face::kDown,  Face::kFront, Face::kBack};

// How far down a row of a face lies: 0 zenith, 1 ground.
double Fall(Face face, int row) {
  if (face == Face::kUp) return 0.0;
  if (face == Face::kDown) return 1.0;
  return static_cast<double>(row) / (kSide - 1);
}

std::vector<mjtByte> SkyTexels() {
  std::vector<mjtByte> texels;
  texels.reserve(kFaces.size() * kSide * kSide * 3);
  for (const Face face : kFaces) {
    for (int row = 0; row < kSide; ++row) {
      const double fall = Fall(face, row);
      for (int column = 0; column < kSide; ++column) {
        for (std::size_t c = 0; c < 3; ++c) {
          const double value = kZenith[c] + fall * (kGround[c] - kZenith[c]);
          texels.push_back(static_cast<mjtByte>(std::lround(value)));
        }
      }
    }
  }
  return texels;
}

}  // namespace

Backdrop::Backdrop(const mjModel& model) : model_(model) {
  const bool has_sky = std::find(model.tex_type, model.tex_type + model.ntex,
                                 mjTEXTURE_SKYBOX) != model.tex_type + model.ntex;
  if (!has_sky) AddSky();
}

void Backdrop::AddSky() {
  const auto copy = [](const int* values, int count, int last) {
    std::vector<int> all(values, values + count);
    all.push_back(last);
    return all;
  };
  const std::vector<mjtByte> sky = SkyTexels();
  type_ = copy(model_.tex_type, model_.ntex, mjTEXTURE_SKYBOX);
  width_ = copy(model_.tex_width, model_.ntex, kSide);
  height_ =
      copy(model_.tex_height, model_.ntex, kSide * static_cast<int>(kFaces.size()));
  address_ = copy(model_.tex_adr, model_.ntex, model_.ntexdata);
  rgb_.assign(model_.tex_rgb, model_.tex_rgb + model_.ntexdata);
  rgb_.insert(rgb_.end(), sky.begin(), sky.end());

  model_.ntex += 1;
  model_.ntexdata = static_cast<int>(rgb_.size());
  model_.tex_type = type_.data();
  model_.tex_width = width_.data();
  model_.tex_height = height_.data();
  model_.tex_adr = address_.data();
  model_.tex_rgb = rgb_.data();
}

}  // namespace mjdiag
