#include "mjdiag/discovery/regression/disturbance_map.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/decompositions.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Over how many samples a signal repeats itself: 1 + 2 sum of its autocorrelations up to
/// where they vanish.
double RepeatsOf(const VectorXd& signal) {
  const Index n = signal.size();
  const double square = signal.squaredNorm();
  double repeats = 1.0;
  if (!(square > 0.0)) return repeats;
  for (Index lag = 1; 4 * lag < n; ++lag) {
    const double one = signal.head(n - lag).dot(signal.tail(n - lag)) / square;
    if (one <= 0.0) break;
    repeats += 2.0 * one;
  }
  return repeats;
}

DisturbanceMap::Rest RestOfRows(const VectorXd& rows, Index nf) {
  DisturbanceMap::Rest rest{VectorXd(nf), VectorXd(nf)};
  const Index count = rows.size() / nf;
  for (Index j = 0; j < nf; ++j) {
    const VectorXd one = rows(Eigen::seqN(j, count, nf));
    rest.sd[j] = std::max(
        1e-300,
        std::sqrt(one.squaredNorm() / static_cast<double>(std::max<Index>(1, count))));
    rest.repeats[j] = RepeatsOf(one);
  }
  return rest;
}

/// Forces at joints that do a change of the state in a tick, by its tangent, at those that
/// nothing holds: what sticks moves by next to nothing, and a change of it divided by that says
/// nothing of a force.
std::vector<MatrixXd> ForcesOfChanges(const FilterPath& path) {
  constexpr double kHeld = 0.1;  // of what the joint moves where it is free
  const Index nv = path.tangents.front().B.cols();
  const auto gains = [&](const TickTangent& tangent) -> VectorXd {
    return tangent.B.middleRows(nv, nv).diagonal()(path.dofs);
  };
  VectorXd free = VectorXd::Zero(path.dof_count());
  for (const TickTangent& one : path.tangents) free = free.cwiseMax(gains(one));
  std::vector<MatrixXd> forces;
  for (const TickTangent& one : path.tangents) {
    const VectorXd gain = gains(one);
    std::vector<Index> places, dofs;
    for (Index j = 0; j < gain.size(); ++j) {
      if (gain[j] < kHeld * free[j]) continue;
      places.push_back(j);
      dofs.push_back(path.dofs[static_cast<std::size_t>(j)]);
    }
    forces.push_back(MatrixXd::Zero(gain.size(), one.B.rows()));
    if (places.empty()) continue;
    forces.back()(places, Eigen::indexing::all) =
        PseudoInverse(one.B(Eigen::indexing::all, dofs));
  }
  return forces;
}

}  // namespace

MatrixXd PositionOfReadings(const FilterPath& path) {
  const TickTangent& tangent = path.tangents.front();
  const VectorXd weight = path.noise.reading.cwiseInverse();
  const MatrixXd C = weight.asDiagonal() * tangent.C.leftCols(tangent.B.cols());
  return PseudoInverse(C) * weight.asDiagonal();
}

DisturbanceRows::DisturbanceRows(const FilterPath& of, const MatrixXd& forces)
    : path(of) {
  constexpr double kLength = 0.02;  // [s]
  const auto ticks =
      std::max<Index>(1, static_cast<Index>(std::lround(kLength / path.sample_time)));
  for (std::size_t record = 0; record < path.first.size(); ++record) {
    for (Index k = path.first[record]; k + ticks <= path.EndOf(record); k += ticks) {
      windows.push_back({k, ticks});
    }
  }
  missing = Means(forces);
  force_of_change = ForcesOfChanges(path);
  position_of_readings = PositionOfReadings(path);
}

VectorXd DisturbanceRows::Means(const MatrixXd& forces) const {
  const Index nf = path.dof_count();
  VectorXd rows(std::ssize(windows) * nf);
  Index row = 0;
  for (const Window& window : windows) {
    rows.segment(row, nf) =
        forces.middleCols(window.first, window.count).rowwise().mean();
    row += nf;
  }
  return rows;
}

DisturbanceMap::DisturbanceMap(const DisturbanceRows& of, const Rest& rest)
    : of_(of),
      rest_(rest),
      weight_((rest.sd.cwiseProduct(rest.repeats.cwiseSqrt())).cwiseInverse()),
      left_((weight_.asDiagonal() *
             of.missing.reshaped(of.path.dof_count(), std::ssize(of.windows)))
                .reshaped()) {}

DisturbanceMap::Rest DisturbanceMap::RestOf(const DisturbanceRows& of) {
  return RestOfRows(of.missing, of.path.dof_count());
}

DisturbanceMap::Rest DisturbanceMap::RestOf(const VectorXd& left) const {
  const Index nf = of_.path.dof_count();
  MatrixXd rows = left.reshaped(nf, std::ssize(of_.windows));
  rows.array().colwise() /= weight_.array();
  return RestOfRows(rows.reshaped(), nf);
}

double DisturbanceMap::log_determinant() const {
  double sum = 0.0;
  for (Index j = 0; j < rest_.sd.size(); ++j) {
    sum += 2.0 * static_cast<double>(of_.windows.size()) / rest_.repeats[j] *
           std::log(rest_.sd[j]);
  }
  return sum;
}

MatrixXd DisturbanceMap::ForcesOfErrors(const MatrixXd& errors) const {
  const FilterPath& path = of_.path;
  const Index nv = path.tangents.front().B.cols();
  MatrixXd forces = MatrixXd::Zero(path.dof_count(), path.samples());
  const MatrixXd dq = of_.position_of_readings * errors;
  for (std::size_t record = 0; record < path.first.size(); ++record) {
    for (Index k = path.first[record]; k + 2 < path.EndOf(record); ++k) {
      const auto tangent = path.of_tick[static_cast<std::size_t>(k)];
      const MatrixXd& A = path.tangents[tangent].A;
      VectorXd change = VectorXd::Zero(A.rows());
      const VectorXd dv = (dq.col(k + 1) - dq.col(k)) / path.sample_time;
      change.head(nv) = dq.col(k + 1);
      change.segment(nv, nv) = (dq.col(k + 2) - dq.col(k + 1)) / path.sample_time;
      change -= A.leftCols(nv) * dq.col(k) + A.middleCols(nv, nv) * dv;
      forces.col(k) = of_.force_of_change[tangent] * change;
    }
  }
  return forces;
}

MatrixXd DisturbanceMap::ErrorsOfForces(const MatrixXd& forces) const {
  const FilterPath& path = of_.path;
  const Index nv = path.tangents.front().B.cols();
  MatrixXd dq = MatrixXd::Zero(nv, path.samples());
  for (std::size_t record = 0; record < path.first.size(); ++record) {
    for (Index k = path.first[record]; k + 2 < path.EndOf(record); ++k) {
      const auto tangent = path.of_tick[static_cast<std::size_t>(k)];
      const MatrixXd& A = path.tangents[tangent].A;
      const VectorXd change = of_.force_of_change[tangent].transpose() * forces.col(k);
      const VectorXd next = change.segment(nv, nv) / path.sample_time;
      const VectorXd now = A.middleCols(nv, nv).transpose() * change / path.sample_time;
      dq.col(k + 2) += next;
      dq.col(k + 1) += change.head(nv) - next - now;
      dq.col(k) += now - A.leftCols(nv).transpose() * change;
    }
  }
  return of_.position_of_readings.transpose() * dq;
}

MatrixXd DisturbanceMap::Of(const std::vector<const Column*>& columns) const {
  const Index nf = of_.path.dof_count();
  MatrixXd out(rows(), std::ssize(columns));
  ParallelFor(static_cast<int>(columns.size()), [&](int number) {
    const Column& column = *columns[static_cast<std::size_t>(number)];
    MatrixXd forces = MatrixXd::Zero(nf, of_.path.samples());
    for (const auto& [dof, signal] : column.forces) {
      const auto place = std::ranges::find(of_.path.dofs, dof);
      if (place != of_.path.dofs.end()) {
        forces.row(place - of_.path.dofs.begin()) += signal.transpose();
      }
    }
    for (const auto& [state, signal] : column.states) {
      for (Index k = 0; k < of_.path.samples(); ++k) {
        if (signal[k] == 0.0) continue;
        forces.col(k) +=
            signal[k] *
            of_.force_of_change[of_.path.of_tick[static_cast<std::size_t>(k)]].col(
                state);
      }
    }
    if (!column.readings.empty()) {
      MatrixXd errors = MatrixXd::Zero(of_.path.sensors(), of_.path.samples());
      for (const auto& [sensor, signal] : column.readings) {
        errors.row(sensor) += signal.transpose();
      }
      forces += ForcesOfErrors(errors);
    }
    out.col(number) =
        (weight_.asDiagonal() * of_.Means(forces).reshaped(nf, std::ssize(of_.windows)))
            .reshaped();
  });
  return out;
}

std::vector<RowMap::Transposed> DisturbanceMap::TransposedTimes(
    const MatrixXd& u) const {
  const Index nf = of_.path.dof_count();
  const Index nv = of_.path.tangents.front().B.cols();
  std::vector<Transposed> all(static_cast<std::size_t>(u.cols()));
  ParallelFor(static_cast<int>(u.cols()), [&](int number) {
    Transposed& one = all[static_cast<std::size_t>(number)];
    one.forces = MatrixXd::Zero(of_.path.samples(), nv);
    MatrixXd forces = MatrixXd::Zero(nf, of_.path.samples());
    Index row = 0;
    for (const DisturbanceRows::Window& window : of_.windows) {
      for (Index j = 0; j < nf; ++j, ++row) {
        forces.row(j)
            .segment(window.first, window.count)
            .setConstant(weight_[j] * u(row, number) /
                         static_cast<double>(window.count));
      }
    }
    for (Index j = 0; j < nf; ++j) {
      one.forces.col(of_.path.dofs[static_cast<std::size_t>(j)]) =
          forces.row(j).transpose();
    }
    one.readings = ErrorsOfForces(forces).transpose();
  });
  return all;
}

}  // namespace mjdiag
