#include "mjdiag/plugin/plant/reading_rate.h"

namespace mjdiag {
namespace {

/// Where a frame is, and how it turns and moves, in the world.
struct Frame {
  const mjtNum* position = nullptr;
  const mjtNum* rotation = nullptr;
  mjtNum velocity[6] = {};  // angular, then linear
};

Frame FrameOf(const mjModel& model, const mjData& data, int type, int id) noexcept {
  Frame frame;
  switch (type) {
    case mjOBJ_BODY:
      frame.position = data.xipos + 3 * id;
      frame.rotation = data.ximat + 9 * id;
      break;
    case mjOBJ_XBODY:
      frame.position = data.xpos + 3 * id;
      frame.rotation = data.xmat + 9 * id;
      break;
    case mjOBJ_GEOM:
      frame.position = data.geom_xpos + 3 * id;
      frame.rotation = data.geom_xmat + 9 * id;
      break;
    case mjOBJ_SITE:
      frame.position = data.site_xpos + 3 * id;
      frame.rotation = data.site_xmat + 9 * id;
      break;
    case mjOBJ_CAMERA:
      frame.position = data.cam_xpos + 3 * id;
      frame.rotation = data.cam_xmat + 9 * id;
      break;
    default:
      return frame;
  }
  mj_objectVelocity(&model, &data, type, id, frame.velocity, 0);
  return frame;
}

/// Of a point that moves, as one sees it who moves and turns as well:
/// R^T (v - v_R - w_R x (p - p_R)).
double FrameRate(const mjModel& model, const mjData& data, int sensor,
                 int component) noexcept {
  const Frame frame =
      FrameOf(model, data, model.sensor_objtype[sensor], model.sensor_objid[sensor]);
  if (frame.position == nullptr) return 0.0;
  if (model.sensor_refid[sensor] < 0) return frame.velocity[3 + component];
  const Frame from =
      FrameOf(model, data, model.sensor_reftype[sensor], model.sensor_refid[sensor]);
  if (from.position == nullptr) return 0.0;
  mjtNum apart[3], turned[3], rate[3], local[3];
  mju_sub3(apart, frame.position, from.position);
  mju_cross(turned, from.velocity, apart);
  mju_sub3(rate, frame.velocity + 3, from.velocity + 3);
  mju_subFrom3(rate, turned);
  mju_rotVecMatT(local, rate, from.rotation);
  return local[component];
}

}  // namespace

bool HasRate(const mjModel& model, int sensor) {
  switch (model.sensor_type[sensor]) {
    case mjSENS_JOINTPOS:
    case mjSENS_TENDONPOS:
    case mjSENS_ACTUATORPOS:
    case mjSENS_FRAMEPOS:
      return true;
    default:
      return false;
  }
}

double ReadingRate(const mjModel& model, const mjData& data, int sensor,
                   int component) noexcept {
  const int object = model.sensor_objid[sensor];
  switch (model.sensor_type[sensor]) {
    case mjSENS_JOINTPOS:
      return data.qvel[model.jnt_dofadr[object]];
    case mjSENS_TENDONPOS:
      return data.ten_velocity[object];
    case mjSENS_ACTUATORPOS:
      return data.actuator_velocity[object];
    case mjSENS_FRAMEPOS:
      return FrameRate(model, data, sensor, component);
    default:
      return 0.0;
  }
}

}  // namespace mjdiag
