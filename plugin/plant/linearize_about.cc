#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/plant/linearize.h"
#include "mjdiag/plugin/plant/plant_forces.h"
#include "mjdiag/signals/decompositions.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Rows of constraints that hold, by what they are.
struct HeldRows {
  std::vector<int> rows;
  std::vector<std::pair<int, int>> kinds;  // type and element
};

HeldRows RowsOf(const mjData& data, const std::vector<int>& rows) {
  HeldRows held{rows, {}};
  for (const int row : rows) {
    held.kinds.emplace_back(data.efc_type[row], data.efc_id[row]);
  }
  return held;
}

/// -d/dq (J^T lambda) of forces lambda that do not change: what curved constraints add to
/// the stiffness. 0 where constraints come and go within the step.
MatrixXd CurvatureStiffness(const HeldRows& held, const VectorXd& lambda,
                            PlantForces& forces) {
  constexpr double kStep = 1e-5;
  bool same = true;
  const int last = held.rows.back();
  const auto force = [&]() -> VectorXd {
    forces.Update();
    const mjData& data = forces.data();
    if (data.nefc <= last || RowsOf(data, held.rows).kinds != held.kinds) {
      same = false;
      return VectorXd::Zero(forces.size());
    }
    return ConstraintJacobian(forces.model(), data, held.rows).transpose() * lambda;
  };
  const MatrixXd stiffness = -ByPosition(forces, force, kStep);
  if (same) return stiffness;
  return MatrixXd::Zero(forces.size(), forces.size());
}

/// Whether no mode grows within the minutes that a machine is watched. Rounding moves the
/// poles of what nothing holds.
bool IsStable(const MechanicalModel& model) {
  const Index n = model.M.rows();
  if (n == 0) return true;
  const StateSpace system = UnitMassStateSpace(model, 1.0);
  const Eigen::VectorXcd poles = EigenDecomposition(system.A).values;
  const double fastest = poles.cwiseAbs().maxCoeff();
  return poles.real().maxCoeff() <= std::max(1e-3, 1e-6 * fastest);
}

std::vector<std::string> NotesOn(const mjModel& model, const Channels& channels) {
  std::vector<std::string> notes;
  const std::vector<int> actuators = ActuatorAddresses(channels, model);
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    if (ActivationOf(model, actuators[i]) < 0) continue;
    notes.push_back("actuator '" + channels.actuators[i].channel +
                    "' has dynamics of its own: its column of Gamma is the force of a "
                    "unit of its activation; A, B, C, D of tick and step contain them");
  }
  for (const SensorSetup& sensor : channels.sensors) {
    if (StageOf(model, sensor) == mjSTAGE_POS) continue;
    notes.push_back(
        "sensor '" + sensor.channel +
        "' reads no position: its column of b is 0; C and D of tick and step "
        "have what it reads");
  }
  return notes;
}

}  // namespace

Linearization LinearizeAbout(const mjModel& model, const Channels& channels,
                             const OperatingPoint& point) {
  MechanicalModel all = MotionLinearization(model, channels).About(point);
  PlantForces forces(model, point.qpos);
  forces.Total();
  const std::vector<int> rows = HoldingRows(forces.data());
  Linearization result;
  result.notes = NotesOn(model, channels);
  if (rows.empty()) {
    result.stable = IsStable(all);
    result.model = std::move(all);
    return result;
  }
  const Independence ties = IndependentCoordinates(model, channels, forces.data());
  const HeldRows held = RowsOf(forces.data(), rows);
  const MatrixXd jacobian = ConstraintJacobian(model, forces.data(), rows);
  Set(model, point, forces.data());
  const VectorXd carried =
      all.M * point.acceleration - forces.Smooth() - point.applied_force;
  const VectorXd lambda = LeastNorm(jacobian.transpose(), carried);
  all.K += CurvatureStiffness(held, lambda, forces);

  const MatrixXd& T = ties.T;
  MechanicalModel& reduced = result.model;
  for (const int dof : ties.independent) {
    reduced.coordinates.push_back(all.coordinates[static_cast<std::size_t>(dof)]);
  }
  for (const int dof : ties.dependent) {
    result.dependent.push_back(all.coordinates[static_cast<std::size_t>(dof)]);
  }
  reduced.inputs = all.inputs;
  reduced.outputs = all.outputs;
  reduced.M = T.transpose() * all.M * T;
  reduced.D = T.transpose() * all.D * T;
  reduced.K = T.transpose() * all.K * T;
  reduced.Gamma = T.transpose() * all.Gamma;
  reduced.b = T.transpose() * all.b;
  result.ties = T(ties.dependent, Eigen::all);
  result.stable = IsStable(reduced);
  return result;
}

}  // namespace mjdiag
