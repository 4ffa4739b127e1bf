#include "mjdiag/plugin/machine/plant_state.h"

#include "mjdiag/plugin/plant/tangent_coordinates.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

Index TangentSize(const mjModel& model) { return 2 * model.nv + model.na; }

PlantState StateOf(const mjModel& model, const mjData& data) {
  return {VectorXd::Map(data.qpos, model.nq), VectorXd::Map(data.qvel, model.nv),
          VectorXd::Map(data.act, model.na)};
}

void SetState(const mjModel& model, const PlantState& state, mjData& data) {
  VectorXd::Map(data.qpos, model.nq) = state.position;
  VectorXd::Map(data.qvel, model.nv) = state.velocity;
  VectorXd::Map(data.act, model.na) = state.activation;
}

PlantState Moved(const mjModel& model, const PlantState& from, const VectorXd& dx) {
  return {Displaced(model, from.position, dx.head(model.nv)),
          from.velocity + dx.segment(model.nv, model.nv),
          from.activation + dx.segment(2 * model.nv, model.na)};
}

VectorXd Deviation(const mjModel& model, const PlantState& from, const PlantState& to) {
  VectorXd dx(TangentSize(model));
  dx << Displacement(model, from.position, to.position), to.velocity - from.velocity,
      to.activation - from.activation;
  return dx;
}

}  // namespace mjdiag
