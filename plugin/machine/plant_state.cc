#include "mjdiag/plugin/machine/plant_state.h"

#include "mjdiag/plugin/plant/tangent_coordinates.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

Index TangentSize(const mjModel& model) { return 2 * model.nv + model.na; }

PlantState StateOf(const mjModel& model, const mjData& data) {
  return {VectorXd::Map(data.qpos, model.nq),
          VectorXd::Map(data.qvel, model.nv),
          VectorXd::Map(data.act, model.na),
          {}};
}

void SetState(const mjModel& model, const PlantState& state, mjData& data) {
  VectorXd::Map(data.qpos, model.nq) = state.position;
  VectorXd::Map(data.qvel, model.nv) = state.velocity;
  VectorXd::Map(data.act, model.na) = state.activation;
}

PlantState Moved(const mjModel& model, const PlantState& from, const VectorXd& dx) {
  return {Displaced(model, from.position, dx.head(model.nv)),
          from.velocity + dx.segment(model.nv, model.nv),
          from.activation + dx.segment(2 * model.nv, model.na),
          from.bodies + dx.segment(TangentSize(model), from.bodies.size())};
}

VectorXd Deviation(const mjModel& model, const PlantState& from, const PlantState& to) {
  const Index size = TangentSize(model);
  VectorXd dx = VectorXd::Zero(size + from.bodies.size());
  dx.head(size) << Displacement(model, from.position, to.position),
      to.velocity - from.velocity, to.activation - from.activation;
  if (to.bodies.size() == from.bodies.size()) {
    dx.tail(from.bodies.size()) = to.bodies - from.bodies;
  }
  return dx;
}

}  // namespace mjdiag
