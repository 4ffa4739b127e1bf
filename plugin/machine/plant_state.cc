#include "mjdiag/plugin/machine/plant_state.h"

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
  PlantState to = from;
  mj_integratePos(&model, to.position.data(), dx.data(), 1.0);
  to.velocity += dx.segment(model.nv, model.nv);
  to.activation += dx.segment(2 * model.nv, model.na);
  return to;
}

VectorXd Deviation(const mjModel& model, const PlantState& from, const PlantState& to) {
  VectorXd dx(TangentSize(model));
  mj_differentiatePos(&model, dx.data(), 1.0, from.position.data(), to.position.data());
  dx.segment(model.nv, model.nv) = to.velocity - from.velocity;
  dx.tail(model.na) = to.activation - from.activation;
  return dx;
}

}  // namespace mjdiag
