#include "mjdiag/discovery/hypotheses/mass_moments.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {
namespace {

using Eigen::Vector3d;

Vector3d VectorOf(const mjtNum* values, int row) {
  return Vector3d::Map(RowOf(values, 3, row));
}

/// Mass and first moment about the origin of a body's frame, in that frame, of it and of
/// what hangs on it.
struct Gathered {
  double mass = 0.0;
  Vector3d moment = Vector3d::Zero();
};

Eigen::Quaterniond TurnOf(const mjModel& plant, int body) {
  const mjtNum* q = RowOf(plant.body_quat, 4, body);
  return {q[0], q[1], q[2], q[3]};
}

/// What stays where it is while the joints of a body move, at its rest.
Gathered Gather(const mjModel& plant, int body) {
  Gathered all;
  all.mass = plant.body_mass[body];
  all.moment = all.mass * VectorOf(plant.body_ipos, body);
  for (int child = body + 1; child < plant.nbody; ++child) {
    if (plant.body_parentid[child] != body) continue;
    Gathered own = Gather(plant, child);
    // The last hinge first: what it turns stays on its axis.
    for (int i = plant.body_jntnum[child] - 1; i >= 0; --i) {
      const int joint = plant.body_jntadr[child] + i;
      if (plant.jnt_type[joint] != mjJNT_HINGE) continue;
      const Vector3d anchor = VectorOf(plant.jnt_pos, joint);
      const Vector3d axis = VectorOf(plant.jnt_axis, joint);
      const Vector3d about = own.moment - own.mass * anchor;
      own.moment = own.mass * anchor + axis * axis.dot(about);
    }
    all.mass += own.mass;
    all.moment +=
        TurnOf(plant, child) * own.moment + own.mass * VectorOf(plant.body_pos, child);
  }
  return all;
}

}  // namespace

std::vector<MassMoment> MassMoments(const mjModel& plant) {
  constexpr std::array kAxes = {"x", "y", "z"};
  std::vector<MassMoment> moments;
  for (int joint = 0; joint < plant.njnt; ++joint) {
    if (plant.jnt_type[joint] != mjJNT_HINGE) continue;
    const Gathered all = Gather(plant, plant.jnt_bodyid[joint]);
    const Vector3d axis = VectorOf(plant.jnt_axis, joint);
    Vector3d about = all.moment - all.mass * VectorOf(plant.jnt_pos, joint);
    about -= axis * axis.dot(about);
    int along = 0;
    axis.cwiseAbs().maxCoeff(&along);
    for (int i = 0; i < 3; ++i) {
      if (i == along) continue;
      moments.push_back({ElementName(plant, mjOBJ_JOINT, joint),
                         kAxes[static_cast<std::size_t>(i)], about[i]});
    }
  }
  return moments;
}

}  // namespace mjdiag
