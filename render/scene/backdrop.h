#pragma once
// A plain bright sky behind models that declare none, instead of OpenGL's black.

#include <mujoco/mujoco.h>

#include <vector>

namespace mjdiag {

/// The model with one more texture, for mjr_makeContext only: a compiled model cannot
/// grow, so this is a shallow copy whose texture arrays point into this object.
class Backdrop {
 public:
  /// `model` must outlive this object.
  explicit Backdrop(const mjModel& model);
  Backdrop(const Backdrop&) = delete;
  Backdrop& operator=(const Backdrop&) = delete;

  const mjModel& model() const { return model_; }

 private:
  void AddSky();

  mjModel model_;
  std::vector<int> type_, height_, width_, address_;
  std::vector<mjtByte> rgb_;
};

}  // namespace mjdiag
