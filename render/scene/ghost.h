#pragma once
// A second pose of the machine drawn translucent into the same scene, so that the eye
// sees where it differs from the first.

#include <mujoco/mujoco.h>

#include <array>
#include <vector>

namespace mjdiag {

/// What of the second pose is drawn, and how.
struct Ghost {
  std::vector<bool> bodies;                     ///< of the model, which are drawn
  std::array<float, 3> rgb{0.0F, 0.45F, 0.7F};  ///< 0 .. 1
  float opacity = 0.45F;
};

/// Finds the bodies that stand apart: a ghost of the others would only veil them.
class BodyDistances {
 public:
  explicit BodyDistances(const mjModel& model);

  /// Notes how far apart the bodies of two poses are; computes the kinematics of both.
  void Compare(mjData& a, mjData& b);
  /// Bodies any part of which was at least this far [m] apart in a comparison.
  std::vector<bool> AtLeast(double distance) const;

 private:
  const mjModel* model_;
  std::vector<double> distances_;  // largest so far of every body [m]
};

/// Adds the ghost of the pose in `data`, whose kinematics are up to date, to a scene
/// that already holds the machine.
void AddGhost(const mjModel& model, mjData& data, const mjvOption& visual,
              const Ghost& ghost, mjvScene& scene);

}  // namespace mjdiag
