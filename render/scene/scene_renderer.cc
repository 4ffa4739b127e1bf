#include "mjdiag/render/scene/scene_renderer.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/render/scene/backdrop.h"
#include "mjdiag/render/scene/facets.h"
#include "mjdiag/render/scene/offscreen_context.h"
#include "mjdiag/render/scene/osmesa_library.h"
#include "mjdiag/render/scene/posed_scene.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr int kMinSide = 16;
constexpr int kMaxSide = 4096;
constexpr float kBackground = 1.0F;  // in the depth buffer

void CheckPictureSide(const char* name, int side) {
  if (side < kMinSide || side > kMaxSide) {
    throw InputError(name, std::to_string(side) + " px",
                     std::to_string(kMinSide) + " to " + std::to_string(kMaxSide));
  }
}

int Oversampling(Smoothing smoothing) {
  return smoothing == Smoothing::kSupersample2 ? 2 : 1;
}

// The model with an off-screen buffer as large as the picture.
ModelPtr SizedModel(const mjModel& model, const SceneOptions& options,
                    const PosedScene& scene) {
  ModelPtr sized = CopyModel(model);
  sized->vis.global.offwidth = options.width * Oversampling(options.smoothing);
  sized->vis.global.offheight = options.height * Oversampling(options.smoothing);
  auto& quality = sized->vis.quality;
  quality.offsamples = options.smoothing == Smoothing::kMultisample4 ? 4 : 0;
  if (!options.shadows) quality.shadowsize = 0;
  const Facets facets = FacetsThatShow(scene.get(), options.height,
                                       {quality.numslices, quality.numstacks});
  quality.numslices = facets.slices;
  quality.numstacks = facets.stacks;
  quality.numquads = 1;  // light falls evenly on what is flat
  return sized;
}

class RenderContext {
 public:
  explicit RenderContext(const mjModel& model) {
    mjr_defaultContext(&context_);
    mjr_makeContext(&model, &context_, mjFONTSCALE_100);
    for (int i = 0; i < context_.ntexture; ++i) Simplify(i);
  }
  ~RenderContext() { mjr_freeContext(&context_); }
  RenderContext(const RenderContext&) = delete;
  RenderContext& operator=(const RenderContext&) = delete;
  mjrContext* get() { return &context_; }

 private:
  // Textures are sampled from the nearest mipmap instead of between two, which halves
  // what they cost on a processor.
  void Simplify(int texture) const {
    const GLenum target = context_.textureType[texture] == mjTEXTURE_2D
                              ? GL_TEXTURE_2D
                              : GL_TEXTURE_CUBE_MAP;
    const OsMesaLibrary& gl = OsMesa();
    gl.bind_texture(target, context_.texture[texture]);
    gl.set_texture_parameter(target, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_NEAREST);
    gl.bind_texture(target, 0);
  }

  mjrContext context_;
};

}  // namespace

struct SceneRenderer::State {
  State(const mjModel& source, const SceneOptions& wanted)
      : options(wanted),
        scene(source, wanted.camera),
        model(SizedModel(source, wanted, scene)),
        context(Backdrop(*model).model()),
        viewport{0, 0, wanted.width * Oversampling(wanted.smoothing),
                 wanted.height * Oversampling(wanted.smoothing)},
        pixels(3 * static_cast<std::size_t>(viewport.width) * viewport.height) {
    scene.get().flags[mjRND_SHADOW] = options.shadows;
  }
  // The context must be current while its objects are freed.
  ~State() { offscreen.MakeCurrent(); }

  void Draw(mjData& data, mjData* ghost_data = nullptr, const Ghost& ghost = {}) {
    offscreen.MakeCurrent();
    mjr_setBuffer(mjFB_OFFSCREEN, context.get());
    scene.Show(data);
    if (ghost_data != nullptr) scene.AddGhost(*ghost_data, ghost);
    mjr_render(viewport, &scene.get(), context.get());
  }

  // The picture in the framebuffer, turned upright and averaged down to its size.
  void Read(Image& image) {
    mjr_readPixels(pixels.data(), nullptr, viewport, context.get());
    image.width = options.width;
    image.height = options.height;
    image.rgb.resize(3 * static_cast<std::size_t>(image.width) * image.height);
    const cv::Mat upside_down(viewport.height, viewport.width, CV_8UC3, pixels.data());
    cv::Mat target(image.height, image.width, CV_8UC3, image.rgb.data());
    if (upside_down.size() == target.size()) {
      cv::flip(upside_down, target, 0);
    } else {
      cv::Mat small;
      cv::resize(upside_down, small, target.size(), 0, 0, cv::INTER_AREA);
      cv::flip(small, target, 0);
    }
  }

  // Of what was drawn there; kBackground if that is nothing.
  float MedianDepth(mjrRect area) {
    std::vector<float> depth(static_cast<std::size_t>(area.width) * area.height);
    mjr_readPixels(nullptr, depth.data(), area, context.get());
    std::erase(depth, kBackground);
    if (depth.empty()) return kBackground;
    const auto median = depth.begin() + static_cast<std::ptrdiff_t>(depth.size() / 2);
    std::nth_element(depth.begin(), median, depth.end());
    return *median;
  }

  SceneOptions options;
  PosedScene scene;
  ModelPtr model;
  OffscreenContext offscreen;
  RenderContext context;
  mjrRect viewport;
  std::vector<std::uint8_t> pixels;  // as OpenGL gives them: rows from the bottom
};

SceneRenderer::SceneRenderer(const mjModel& model, const SceneOptions& options) {
  CheckPictureSide("width", options.width);
  CheckPictureSide("height", options.height);
  state_ = std::make_unique<State>(model, options);
}

SceneRenderer::~SceneRenderer() = default;

void SceneRenderer::Render(mjData& data, Image& image) {
  state_->Draw(data);
  state_->Read(image);
}

void SceneRenderer::Render(mjData& data, mjData& ghost_data, const Ghost& ghost,
                           Image& image) {
  state_->Draw(data, &ghost_data, ghost);
  state_->Read(image);
}

Projection SceneRenderer::projection() const {
  return {EyeOf(state_->scene.get()), state_->options.width, state_->options.height};
}

double SceneRenderer::ViewHeight(mjData& data) {
  State& s = *state_;
  s.scene.get().flags[mjRND_SKYBOX] = 0;  // it would count as a distant thing
  s.Draw(data);
  s.scene.get().flags[mjRND_SKYBOX] = 1;
  const auto& v = s.viewport;
  float depth = s.MedianDepth({v.width / 3, v.height / 3, v.width / 3, v.height / 3});
  if (depth == kBackground) depth = s.MedianDepth(v);
  if (depth == kBackground) return s.model->stat.extent;

  // Depth buffer d of the perspective projection: z = n f / (f - d (f - n)).
  const mjvGLCamera eye = EyeOf(s.scene.get());
  const double near = eye.frustum_near;
  const double far = eye.frustum_far;
  const double distance =
      near * far / (far - static_cast<double>(depth) * (far - near));
  return (eye.frustum_top - eye.frustum_bottom) * distance / near;
}

}  // namespace mjdiag
