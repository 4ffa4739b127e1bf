#include "mjdiag/render/scene/posed_scene.h"

#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

constexpr int kMaxDecorations = 1000;  // geoms beside those of the model and its ghost

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

}  // namespace

PosedScene::PosedScene(const mjModel& model, const std::string& camera)
    : model_(model), camera_(ChooseCamera(model, camera)) {
  mjv_defaultOption(&visual_);
  mjv_defaultScene(&scene_);
  mjv_makeScene(&model, &scene_, 2 * model.ngeom + model.nsite + kMaxDecorations);
  const DataPtr data = MakeData(model);
  Show(*data);
  order_ = DrawingOrder(model, scene_);
}

PosedScene::~PosedScene() { mjv_freeScene(&scene_); }

void PosedScene::Show(mjData& data) {
  UpdatePose(model_, data);
  mjv_updateScene(&model_, &data, &visual_, nullptr, &camera_, mjCAT_ALL, &scene_);
  order_.Sort(scene_);
}

void PosedScene::AddGhost(mjData& data, const Ghost& ghost) {
  UpdatePose(model_, data);
  mjdiag::AddGhost(model_, data, visual_, ghost, scene_);
}

}  // namespace mjdiag
