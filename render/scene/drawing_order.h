#pragma once
// In which order a scene is drawn: what is near first, so that what it hides fails the
// depth test before it is shaded.

#include <mujoco/mujoco.h>

#include <vector>

namespace mjdiag {

/// The order is that of the pose it was made from and stays: of two faces in one plane
/// the first drawn is seen, which must not change while the machine moves.
class DrawingOrder {
 public:
  /// As the model lists its geoms.
  DrawingOrder() = default;
  /// From a scene that shows the model's geoms.
  DrawingOrder(const mjModel& model, const mjvScene& scene);

  /// Sorts the scene's geoms; those that are not the model's stay behind them.
  void Sort(mjvScene& scene) const;

 private:
  std::vector<int> ranks_;  // of the model's geoms
};

}  // namespace mjdiag
