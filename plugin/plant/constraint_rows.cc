#include "mjdiag/plugin/plant/constraint_rows.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "mjdiag/plugin/plant/channels.h"
#include "mjdiag/plugin/plant/mujoco_model.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd ConstraintJacobian(const mjModel& model, const mjData& data,
                            const std::vector<int>& rows) {
  MatrixXd jacobian = MatrixXd::Zero(static_cast<Index>(rows.size()), model.nv);
  const bool sparse = mj_isSparse(&model) != 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const int row = rows[i];
    const auto at = static_cast<Index>(i);
    if (!sparse) {
      jacobian.row(at) = Eigen::RowVectorXd::Map(
          RowOf(data.efc_J, static_cast<int>(model.nv), row), model.nv);
      continue;
    }
    for (int k = 0; k < data.efc_J_rownnz[row]; ++k) {
      const int entry = data.efc_J_rowadr[row] + k;
      jacobian(at, data.efc_J_colind[entry]) = data.efc_J[entry];
    }
  }
  return jacobian;
}

std::vector<int> EqualityRows(const mjData& data) {
  std::vector<int> rows;
  for (int row = 0; row < data.nefc; ++row) {
    if (data.efc_type[row] == mjCNSTR_EQUALITY) rows.push_back(row);
  }
  return rows;
}

std::vector<int> HoldingRows(const mjData& data) {
  const auto is_contact = [&](int row) {
    return data.efc_type[row] >= mjCNSTR_CONTACT_FRICTIONLESS;
  };
  std::set<int> pressing;  // contacts
  for (int row = 0; row < data.nefc; ++row) {
    if (is_contact(row) && data.efc_force[row] > 0.0) pressing.insert(data.efc_id[row]);
  }
  std::vector<int> rows;
  for (int row = 0; row < data.nefc; ++row) {
    const int type = data.efc_type[row];
    const bool limit = type == mjCNSTR_LIMIT_JOINT || type == mjCNSTR_LIMIT_TENDON;
    if (type == mjCNSTR_EQUALITY || (limit && data.efc_force[row] > 0.0) ||
        (is_contact(row) && pressing.contains(data.efc_id[row]))) {
      rows.push_back(row);
    }
  }
  return rows;
}

Independence MakeIndependent(const MatrixXd& jacobian,
                             const std::vector<int>& preference) {
  constexpr double kRank = 1e-9;
  const auto nv = static_cast<Index>(preference.size());
  Independence result;
  // Gaussian elimination: in every step the column that has most left in it, of those
  // that are preferred least, becomes dependent.
  MatrixXd rest = jacobian;
  for (Index row = 0; row < rest.rows(); ++row) {
    const double size = rest.row(row).cwiseAbs().maxCoeff();
    if (size > 0.0) rest.row(row) /= size;
  }
  std::vector<bool> tied(preference.size(), false);
  std::vector<Index> pivot_rows;
  std::vector<bool> used(static_cast<std::size_t>(rest.rows()), false);
  const int levels =
      preference.empty() ? 0 : *std::max_element(preference.begin(), preference.end());
  for (int level = 0; level <= levels; ++level) {
    for (;;) {
      double best = level < levels ? 1e-3 : kRank;
      Index pivot_row = -1;
      Index pivot = -1;
      for (Index j = nv - 1; j >= 0; --j) {
        const auto dof = static_cast<std::size_t>(j);
        if (tied[dof] || preference[dof] > level) continue;
        for (Index i = 0; i < rest.rows(); ++i) {
          if (used[static_cast<std::size_t>(i)]) continue;
          if (std::abs(rest(i, j)) <= best * (1.0 + 1e-9)) continue;
          best = std::abs(rest(i, j));
          pivot_row = i;
          pivot = j;
        }
      }
      if (pivot < 0) break;
      tied[static_cast<std::size_t>(pivot)] = true;
      used[static_cast<std::size_t>(pivot_row)] = true;
      pivot_rows.push_back(pivot_row);
      result.dependent.push_back(static_cast<int>(pivot));
      rest.row(pivot_row) /= rest(pivot_row, pivot);
      for (Index i = 0; i < rest.rows(); ++i) {
        if (i != pivot_row) rest.row(i) -= rest(i, pivot) * rest.row(pivot_row);
      }
    }
  }
  for (Index j = 0; j < nv; ++j) {
    if (!tied[static_cast<std::size_t>(j)]) {
      result.independent.push_back(static_cast<int>(j));
    }
  }
  result.T = MatrixXd::Zero(nv, static_cast<Index>(result.independent.size()));
  for (std::size_t k = 0; k < result.independent.size(); ++k) {
    const auto column = static_cast<Index>(k);
    result.T(result.independent[k], column) = 1.0;
    for (std::size_t i = 0; i < result.dependent.size(); ++i) {
      result.T(result.dependent[i], column) =
          -rest(pivot_rows[i], result.independent[k]);
    }
  }
  std::ranges::sort(result.dependent);
  return result;
}

namespace {

/// 2: driven, 1: read, 0: neither; nv.
std::vector<int> Preference(const mjModel& model, const Channels& channels,
                            const mjData& data) {
  std::vector<int> preference(static_cast<std::size_t>(model.nv), 0);
  for (const SensorSetup& sensor : channels.sensors) {
    const int id = FindElement(model, mjOBJ_SENSOR, sensor.element);
    const int type = model.sensor_type[id];
    if (type != mjSENS_JOINTPOS && type != mjSENS_JOINTVEL && type != mjSENS_BALLQUAT &&
        type != mjSENS_BALLANGVEL) {
      continue;
    }
    const int joint = model.sensor_objid[id];
    for (std::size_t dof = 0; dof < preference.size(); ++dof) {
      if (model.dof_jntid[dof] == joint) preference[dof] = 1;
    }
  }
  for (const int actuator : ActuatorAddresses(channels, model)) {
    const mjtNum* arm =
        RowOf(data.actuator_moment, static_cast<int>(model.nv), actuator);
    for (std::size_t dof = 0; dof < preference.size(); ++dof) {
      if (arm[dof] != 0.0) preference[dof] = 2;
    }
  }
  return preference;
}

}  // namespace

Independence IndependentCoordinates(const mjModel& model, const Channels& channels,
                                    const mjData& data) {
  return MakeIndependent(ConstraintJacobian(model, data, HoldingRows(data)),
                         Preference(model, channels, data));
}

}  // namespace mjdiag
