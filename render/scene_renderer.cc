#include "mjdiag/render/scene_renderer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "mjdiag/plugin/mujoco_model.h"
#include "mjdiag/render/backdrop.h"
#include "mjdiag/render/offscreen_context.h"
#include "mjdiag/render/osmesa_library.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr int kMinSide = 16;
constexpr int kMaxSide = 4096;
constexpr float kBackground = 1.0F;    // in the depth buffer
constexpr int kMaxDecorations = 1000;  // geoms beside those of the model and its ghost

void CheckSide(const char* name, int side) {
  if (side < kMinSide || side > kMaxSide) {
    throw InputError(name, std::to_string(side) + " px",
                     std::to_string(kMinSide) + " to " + std::to_string(kMaxSide));
  }
}

int Oversampling(Smoothing smoothing) {
  return smoothing == Smoothing::kSupersample2 ? 2 : 1;
}

// Curved geoms need no more facets than this at the size of a clip, and a processor
// that draws them one by one feels every one.
void CapFacets(mjModel& model) {
  auto& quality = model.vis.quality;
  quality.numslices = std::min(quality.numslices, 20);
  quality.numstacks = std::min(quality.numstacks, 12);
  quality.numquads = std::min(quality.numquads, 1);
}

// The model with an off-screen buffer as large as the picture.
ModelPtr SizedModel(const mjModel& model, const SceneOptions& options) {
  ModelPtr sized = CopyModel(model);
  sized->vis.global.offwidth = options.width * Oversampling(options.smoothing);
  sized->vis.global.offheight = options.height * Oversampling(options.smoothing);
  sized->vis.quality.offsamples = options.smoothing == Smoothing::kMultisample4 ? 4 : 0;
  CapFacets(*sized);
  if (!options.shadows) sized->vis.quality.shadowsize = 0;
  return sized;
}

std::string CameraNames(const mjModel& model) {
  std::string names;
  for (int id = 0; id < model.ncam; ++id) {
    const char* name = mj_id2name(&model, mjOBJ_CAMERA, id);
    if (name == nullptr) continue;
    names += (names.empty() ? "one of: " : ", ") + std::string(name);
  }
  return names.empty() ? "no camera name, as the model has none" : names;
}

mjvCamera ChooseCamera(const mjModel& model, const std::string& name) {
  mjvCamera camera;
  mjv_defaultFreeCamera(&model, &camera);
  if (name.empty()) return camera;
  camera.type = mjCAMERA_FIXED;
  camera.fixedcamid = mj_name2id(&model, mjOBJ_CAMERA, name.c_str());
  if (camera.fixedcamid < 0) {
    throw InputError("camera", "no camera named \"" + name + "\"", CameraNames(model));
  }
  return camera;
}

// What drawing needs from a pose. mj_forward would also run the control callback.
void UpdatePose(const mjModel& model, mjData& data) {
  mj_kinematics(&model, &data);
  mj_comPos(&model, &data);
  mj_camlight(&model, &data);
  mj_tendon(&model, &data);
}

class Scene {
 public:
  explicit Scene(const mjModel& model) {
    mjv_defaultScene(&scene_);
    mjv_makeScene(&model, &scene_, 2 * model.ngeom + model.nsite + kMaxDecorations);
  }
  ~Scene() { mjv_freeScene(&scene_); }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
  mjvScene* get() { return &scene_; }

 private:
  mjvScene scene_;
};

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
        camera(ChooseCamera(source, wanted.camera)),
        model(SizedModel(source, wanted)),
        scene(*model),
        context(Backdrop(*model).model()),
        viewport{0, 0, wanted.width * Oversampling(wanted.smoothing),
                 wanted.height * Oversampling(wanted.smoothing)},
        pixels(3 * static_cast<std::size_t>(viewport.width) * viewport.height) {
    mjv_defaultOption(&visual);
    scene.get()->flags[mjRND_SHADOW] = options.shadows;
  }
  // The context must be current while its objects are freed.
  ~State() { offscreen.MakeCurrent(); }

  void Draw(mjData& data, mjData* ghost_data = nullptr, const Ghost& ghost = {}) {
    offscreen.MakeCurrent();
    mjr_setBuffer(mjFB_OFFSCREEN, context.get());
    UpdatePose(*model, data);
    mjv_updateScene(model.get(), &data, &visual, nullptr, &camera, mjCAT_ALL,
                    scene.get());
    if (ghost_data != nullptr) {
      UpdatePose(*model, *ghost_data);
      AddGhost(*model, *ghost_data, visual, ghost, *scene.get());
    }
    mjr_render(viewport, scene.get(), context.get());
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
  mjvCamera camera;
  ModelPtr model;
  OffscreenContext offscreen;
  Scene scene;
  RenderContext context;
  mjvOption visual;
  mjrRect viewport;
  std::vector<std::uint8_t> pixels;  // as OpenGL gives them: rows from the bottom
};

SceneRenderer::SceneRenderer(const mjModel& model, const SceneOptions& options) {
  CheckSide("width", options.width);
  CheckSide("height", options.height);
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

// The perspective projection of the fixed pipeline: the frustum at its near plane.
std::optional<Eigen::Vector2d> SceneRenderer::Project(
    const Eigen::Vector3d& point) const {
  const mjvScene& scene = *state_->scene.get();
  const mjvGLCamera eye = mjv_averageCamera(&scene.camera[0], &scene.camera[1]);
  const auto vector = [](const float* v) { return Eigen::Vector3d(v[0], v[1], v[2]); };
  const Eigen::Vector3d forward = vector(eye.forward);
  const Eigen::Vector3d up = vector(eye.up);
  const Eigen::Vector3d offset = point - vector(eye.pos);
  const double distance = forward.dot(offset);
  if (distance < eye.frustum_near) return std::nullopt;
  const double scale = eye.frustum_near / distance;
  const double x = forward.cross(up).dot(offset) * scale - eye.frustum_center;
  const double y = up.dot(offset) * scale;
  const double height = eye.frustum_top - eye.frustum_bottom;
  const double per_unit = state_->options.height / height;
  return Eigen::Vector2d(0.5 * state_->options.width + x * per_unit,
                         (eye.frustum_top - y) * per_unit);
}

double SceneRenderer::ViewHeight(mjData& data) {
  State& s = *state_;
  s.scene.get()->flags[mjRND_SKYBOX] = 0;  // it would count as a distant thing
  s.Draw(data);
  s.scene.get()->flags[mjRND_SKYBOX] = 1;
  const auto& v = s.viewport;
  float depth = s.MedianDepth({v.width / 3, v.height / 3, v.width / 3, v.height / 3});
  if (depth == kBackground) depth = s.MedianDepth(v);
  if (depth == kBackground) return s.model->stat.extent;

  // Depth buffer d of the perspective projection: z = n f / (f - d (f - n)).
  const mjvGLCamera eye =
      mjv_averageCamera(&s.scene.get()->camera[0], &s.scene.get()->camera[1]);
  const double near = eye.frustum_near;
  const double far = eye.frustum_far;
  const double distance =
      near * far / (far - static_cast<double>(depth) * (far - near));
  return (eye.frustum_top - eye.frustum_bottom) * distance / near;
}

}  // namespace mjdiag
