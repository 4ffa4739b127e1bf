#include "mjdiag/plugin/plant/tangent.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd JointStiffness(const mjModel& plant) {
  VectorXd stiffness(plant.nv);
  for (Index j = 0; j < plant.nv; ++j) {
    stiffness[j] = plant.jnt_stiffness[plant.dof_jntid[j]];
  }
  return stiffness;
}

namespace {

VectorXd DampingOf(const mjModel& plant) {
  return Eigen::Map<const VectorXd>(plant.dof_damping, plant.nv);
}

TickTangent NoTime(Index nv) {
  return {MatrixXd::Identity(2 * nv, 2 * nv), MatrixXd::Zero(2 * nv, nv)};
}

}  // namespace

TangentRecorder::TangentRecorder(const mjModel& plant, const MechanicalModel& model)
    : springs_(JointStiffness(plant)),
      dampers_(DampingOf(plant)),
      all_motors_(MotorBiasAtQpos0(plant)),
      motors_(all_motors_),
      mass_(plant.nv, plant.nv),
      tick_(NoTime(plant.nv)) {
  stiffness_ = model.K - MatrixXd(springs_.asDiagonal());
  damping_ = model.D - MatrixXd(dampers_.asDiagonal());
  stiffness_ -= all_motors_.stiffness;
  damping_ -= all_motors_.damping;
}

bool TangentRecorder::MassChanged(const mjModel& plant, const mjData& data) {
  const mjtNum* begin = data.qM;
  const mjtNum* end = begin + plant.nM;
  if (std::equal(begin, end, packed_mass_.begin(), packed_mass_.end())) return false;
  packed_mass_.assign(begin, end);
  mj_fullM(&plant, mass_.data(), data.qM);
  return true;
}

const TangentRecorder::Map& TangentRecorder::MapOf(const mjModel& plant,
                                                   const Held& held) {
  const auto [entry, is_new] = known_.try_emplace(held);
  if (!is_new) return entry->second;
  const double h = plant.opt.timestep;
  const MatrixXd D =
      damping_ + motors_.damping + MatrixXd(DampingOf(plant).asDiagonal());
  const MatrixXd K =
      stiffness_ + motors_.stiffness + MatrixXd(JointStiffness(plant).asDiagonal());
  MatrixXd inertia = mass_;
  MatrixXd against = D;
  for (const auto& [joint, friction] : held) {
    inertia(joint, joint) += friction.first;
    against(joint, joint) += friction.second;
  }
  const Index nv = plant.nv;
  const MatrixXd acceleration = inertia.ldlt().solve(MatrixXd::Identity(nv, nv));
  Map& map = entry->second;
  map.F = h * (mass_ + h * D).ldlt().solve(mass_ * acceleration);
  map.Q = -map.F * K;
  map.V = MatrixXd::Identity(nv, nv) - map.F * against;
  return map;
}

void TangentRecorder::Switch(const mjModel& plant, const mjData& data,
                             std::span<const int> off) {
  if (known_.empty() || !std::ranges::equal(off, off_)) {
    off_.assign(off.begin(), off.end());
    motors_ = MotorBiasOf(plant, data, off);
    known_.clear();
  }
}

void TangentRecorder::Substep(const mjModel& plant, const mjData& data,
                              std::span<const int> off) {
  if (MassChanged(plant, data)) known_.clear();
  Switch(plant, data, off);
  Held held;
  for (int row = 0; row < data.nefc; ++row) {
    if (data.efc_type[row] != mjCNSTR_FRICTION_DOF) continue;
    if (data.efc_state[row] != mjCNSTRSTATE_QUADRATIC) continue;
    const double r = data.efc_D[row];
    held[data.efc_id[row]] = {r, r * data.efc_KBIP[4 * row + 1]};
  }
  const Map& map = MapOf(plant, held);
  const Index nv = plant.nv;
  const double h = plant.opt.timestep;
  const auto advance = [&](MatrixXd& x, const MatrixXd* force) {
    MatrixXd v = map.Q * x.topRows(nv) + map.V * x.bottomRows(nv);
    if (force != nullptr) v += *force;
    x.topRows(nv) += h * v;
    x.bottomRows(nv) = v;
  };
  advance(tick_.A, nullptr);
  advance(tick_.B, &map.F);
}

TickTangent TangentRecorder::EndTick() {
  return std::exchange(tick_, NoTime(tick_.B.cols()));
}

}  // namespace mjdiag
