#pragma once
// What MuJoCo draws: the machine in a pose, as one of its cameras sees it.

#include <mujoco/mujoco.h>

#include <string>

#include "mjdiag/render/scene/drawing_order.h"
#include "mjdiag/render/scene/ghost.h"

namespace mjdiag {

class PosedScene {
 public:
  /// The machine before it moves. InputError on an unknown camera (lists the cameras).
  /// `model` must outlive the scene.
  /// @param camera  of the MJCF file; empty: a free camera that sees the whole model
  PosedScene(const mjModel& model, const std::string& camera);
  ~PosedScene();
  PosedScene(const PosedScene&) = delete;
  PosedScene& operator=(const PosedScene&) = delete;

  /// The pose data.qpos; refreshes the kinematics in `data` but runs no callback.
  void Show(mjData& data);
  /// Adds the ghost of a second pose, in the same way.
  void AddGhost(mjData& data, const Ghost& ghost);

  mjvScene& get() { return scene_; }
  const mjvScene& get() const { return scene_; }

 private:
  const mjModel& model_;
  mjvCamera camera_;
  mjvOption visual_;
  mjvScene scene_;
  DrawingOrder order_;
};

}  // namespace mjdiag
