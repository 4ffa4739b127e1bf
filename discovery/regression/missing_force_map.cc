#include "mjdiag/discovery/regression/missing_force_map.h"

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

MissingForceMap::Rest RestOfRows(const VectorXd& rows, Index nf) {
  MissingForceMap::Rest rest{VectorXd(nf), VectorXd(nf)};
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

}  // namespace

std::vector<MissingForceMap::Window> MissingForceMap::WindowsOf(
    const FilterPath& path) {
  constexpr double kLength = 0.02;  // [s]
  const auto ticks =
      std::max<Index>(1, static_cast<Index>(std::lround(kLength / path.sample_time)));
  std::vector<Window> windows;
  for (std::size_t record = 0; record < path.first.size(); ++record) {
    for (Index k = path.first[record]; k + ticks <= path.EndOf(record); k += ticks) {
      windows.push_back({k, ticks});
    }
  }
  return windows;
}

VectorXd MissingForceMap::Means(const MatrixXd& forces) const {
  const Index nf = path_.dof_count();
  VectorXd rows(std::ssize(windows_) * nf);
  Index row = 0;
  for (const Window& window : windows_) {
    rows.segment(row, nf) =
        forces.middleCols(window.first, window.count).rowwise().mean();
    row += nf;
  }
  return rows;
}

MissingForceMap::MissingForceMap(const FilterPath& path, const MatrixXd& missing,
                                 const Rest& rest)
    : path_(path),
      windows_(WindowsOf(path)),
      rest_(rest),
      weight_((rest.sd.cwiseProduct(rest.repeats.cwiseSqrt())).cwiseInverse()) {
  const Index nf = path.dof_count();
  const MatrixXd means = Means(missing).reshaped(nf, std::ssize(windows_));
  left_ = (weight_.asDiagonal() * means).reshaped();
  for (const TickTangent& tangent : path.tangents) {
    force_of_change_.push_back(
        PseudoInverse(tangent.B(Eigen::indexing::all, path.dofs)));
  }
}

MissingForceMap::Rest MissingForceMap::RestOf(const FilterPath& path,
                                              const MatrixXd& missing) {
  const Index nf = path.dof_count();
  const MissingForceMap plain(path, missing, {VectorXd::Ones(nf), VectorXd::Ones(nf)});
  return RestOfRows(plain.left_, nf);
}

MissingForceMap::Rest MissingForceMap::RestOf(const VectorXd& left) const {
  const Index nf = path_.dof_count();
  MatrixXd rows = left.reshaped(nf, std::ssize(windows_));
  rows.array().colwise() /= weight_.array();
  return RestOfRows(rows.reshaped(), nf);
}

double MissingForceMap::log_determinant() const {
  double sum = 0.0;
  for (Index j = 0; j < rest_.sd.size(); ++j) {
    sum += 2.0 * static_cast<double>(windows_.size()) / rest_.repeats[j] *
           std::log(rest_.sd[j]);
  }
  return sum;
}

MatrixXd MissingForceMap::Of(const std::vector<const Column*>& columns) const {
  const Index nf = path_.dof_count();
  MatrixXd out(rows(), std::ssize(columns));
  ParallelFor(static_cast<int>(columns.size()), [&](int number) {
    const Column& column = *columns[static_cast<std::size_t>(number)];
    MatrixXd forces = MatrixXd::Zero(nf, path_.samples());
    for (const auto& [dof, signal] : column.forces) {
      const auto place = std::ranges::find(path_.dofs, dof);
      if (place != path_.dofs.end()) {
        forces.row(place - path_.dofs.begin()) += signal.transpose();
      }
    }
    for (const auto& [state, signal] : column.states) {
      for (Index k = 0; k < path_.samples(); ++k) {
        if (signal[k] == 0.0) continue;
        forces.col(k) +=
            signal[k] *
            force_of_change_[path_.of_tick[static_cast<std::size_t>(k)]].col(state);
      }
    }
    out.col(number) =
        (weight_.asDiagonal() * Means(forces).reshaped(nf, std::ssize(windows_)))
            .reshaped();
  });
  return out;
}

std::vector<RowMap::Transposed> MissingForceMap::TransposedTimes(
    const MatrixXd& u) const {
  const Index nf = path_.dof_count();
  const Index nv = path_.tangents.front().B.cols();
  std::vector<Transposed> all(static_cast<std::size_t>(u.cols()));
  ParallelFor(static_cast<int>(u.cols()), [&](int number) {
    Transposed& one = all[static_cast<std::size_t>(number)];
    one.forces = MatrixXd::Zero(path_.samples(), nv);
    one.readings = MatrixXd::Zero(path_.samples(), path_.sensors());
    Index row = 0;
    for (const Window& window : windows_) {
      for (Index j = 0; j < nf; ++j, ++row) {
        one.forces.col(path_.dofs[static_cast<std::size_t>(j)])
            .segment(window.first, window.count)
            .setConstant(weight_[j] * u(row, number) /
                         static_cast<double>(window.count));
      }
    }
  });
  return all;
}

}  // namespace mjdiag
