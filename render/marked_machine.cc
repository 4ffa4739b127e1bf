#include "mjdiag/render/marked_machine.h"

#include <algorithm>
#include <array>
#include <iterator>

#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {
namespace {

/// Vermilion, as reports have it for what is not as it should be.
constexpr std::array<float, 4> kMarkColor = {0.90F, 0.28F, 0.0F, 1.0F};
/// What is not marked keeps so much of its colour; the rest is light grey.
constexpr float kKept = 0.25F;
constexpr float kPale = 0.82F;

int BodyOfActuator(const mjModel& model, int actuator) {
  const int target = model.actuator_trnid[2 * actuator];
  switch (model.actuator_trntype[actuator]) {
    case mjTRN_JOINT:
    case mjTRN_JOINTINPARENT:
      return model.jnt_bodyid[target];
    case mjTRN_SITE:
      return model.site_bodyid[target];
    case mjTRN_BODY:
      return target;
    default:
      return -1;  // a tendon, which is in no one place
  }
}

/// Those that it passes.
std::vector<int> BodiesOfTendon(const mjModel& model, int tendon) {
  std::vector<int> bodies;
  const int first = model.tendon_adr[tendon];
  for (int wrap = first; wrap < first + model.tendon_num[tendon]; ++wrap) {
    const int id = model.wrap_objid[wrap];
    switch (model.wrap_type[wrap]) {
      case mjWRAP_JOINT:
        bodies.push_back(model.jnt_bodyid[id]);
        break;
      case mjWRAP_SITE:
        if (model.site_bodyid[id] > 0) bodies.push_back(model.site_bodyid[id]);
        break;
      default:
        break;  // pulleys have no body, and what it is wound around is not of it
    }
  }
  return bodies;
}

void Mark(std::span<const int> bodies, mjModel& model) {
  for (int geom = 0; geom < model.ngeom; ++geom) {
    const bool marked =
        std::ranges::find(bodies, model.geom_bodyid[geom]) != bodies.end();
    const int material = model.geom_matid[geom];
    const float* own =
        material >= 0 ? model.mat_rgba + 4 * material : model.geom_rgba + 4 * geom;
    std::array<float, 4> color = kMarkColor;
    for (std::size_t i = 0; !marked && i < 3; ++i) {
      color[i] = kKept * own[i] + (1.0F - kKept) * kPale;
    }
    color[3] = own[3];
    // A material, and its texture, would hide it.
    model.geom_matid[geom] = -1;
    std::ranges::copy(color, model.geom_rgba + 4 * geom);
  }
}

}  // namespace

std::vector<int> BodiesOf(const mjModel& model, const FaultParameter& fault) {
  std::vector<int> bodies;
  for (const int element : fault.elements) {
    switch (ElementOf(fault.kind)) {
      case mjOBJ_BODY:
        bodies.push_back(element);
        break;
      case mjOBJ_TENDON:
        std::ranges::copy(BodiesOfTendon(model, element), std::back_inserter(bodies));
        break;
      case mjOBJ_ACTUATOR:
        if (const int body = BodyOfActuator(model, element); body >= 0) {
          bodies.push_back(body);
        }
        break;
      default:
        bodies.push_back(model.jnt_bodyid[element]);
    }
  }
  return bodies;
}

std::string DrawMarked(const mjModel& model, const Eigen::VectorXd& position,
                       std::span<const int> bodies, const SceneOptions& options) {
  const ModelPtr marked = CopyModel(model);
  if (!bodies.empty()) Mark(bodies, *marked);
  const DataPtr data = MakeData(*marked);
  std::copy(position.begin(), position.end(), data->qpos);
  Image image;
  SceneRenderer(*marked, options).Render(*data, image);
  return EncodePng(image);
}

}  // namespace mjdiag
