#include "mjdiag/discovery/regression/whitening.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/replay/linear_pass.h"
#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Columns that go through the run side by side: their deviations stay in the cache.
constexpr Index kTogether = 32;

}  // namespace

MatrixXd InflationAlong(const FilterPath& path) {
  MatrixXd inflation = MatrixXd::Ones(path.sensors(), path.samples());
  for (std::size_t record = 0; record < path.first.size(); ++record) {
    LinearPass pass(path, path.noise);
    pass.at_reading = [&](Index sensor, Index sample, bool, double) {
      inflation(sensor, sample) = pass.kalman.inflation;
    };
    const Index first = path.first[record];
    pass.Over(first, path.EndOf(record) - first);
  }
  return inflation;
}

Whitening::Whitening(const FilterPath& path, const FilterNoise& noise,
                     const MatrixXd& inflation)
    : path_(path), ticks_(static_cast<std::size_t>(path.samples())) {
  const Index n = path.pulled.rows();
  const Index rows = path.counts.count();
  K_.resize(n, rows);
  C_.resize(n, rows);
  inverse_sd_.resize(rows);
  left_.resize(rows);
  Index row = 0;
  for (std::size_t record = 0; record < path.first.size(); ++record) {
    LinearPass pass(path, noise);
    pass.inflation = &inflation;
    pass.at_tick = [&](Index k) { ticks_[static_cast<std::size_t>(k)].first = row; };
    pass.at_reading = [&](Index sensor, Index sample, bool late, double) {
      readings_.push_back({sensor, sample, late});
      K_.col(row) = pass.kalman.gain;
      C_.col(row) = pass.kalman.c();
      inverse_sd_[row] = 1.0 / std::sqrt(pass.kalman.variance);
      left_[row] = pass.kalman.last_innovation * inverse_sd_[row];
      log_determinant_ += std::log(pass.kalman.variance);
      ++row;
    };
    pass.at_advance = [&](Index k) { ticks_[static_cast<std::size_t>(k)].end = row; };
    const Index first = path.first[record];
    pass.Over(first, path.EndOf(record) - first);
    rho_ = pass.kalman.rho();
  }
  // Readings of the end of a tick before the first one of a record are taken by nobody.
  K_.conservativeResize(n, row);
  C_.conservativeResize(n, row);
  inverse_sd_.conservativeResize(row);
  left_.conservativeResize(row);
}

void Whitening::ForwardInto(const std::vector<const Column*>& columns, Index first,
                            Index count, MatrixXd& out) const {
  const Index n = K_.rows();
  const Index nf = path_.dof_count();
  const Index ns = n - nf - 1;
  const Index nv = path_.tangents.front().B.cols();
  MatrixXd d(n, count);
  MatrixXd moved(ns, count);
  MatrixXd F = MatrixXd::Zero(nv, count);
  MatrixXd H = MatrixXd::Zero(path_.sensors(), count);
  MatrixXd latent;
  const TickTangent* of_latent = nullptr;
  Eigen::RowVectorXd y(count);
  std::vector<bool> forced(static_cast<std::size_t>(nv), false);
  bool any_reading = false;
  for (Index j = 0; j < count; ++j) {
    const Column& column = *columns[static_cast<std::size_t>(first + j)];
    for (const auto& [dof, signal] : column.forces) {
      forced[static_cast<std::size_t>(dof)] = true;
    }
    any_reading |= !column.readings.empty();
  }
  std::vector<Index> dofs;
  for (Index dof = 0; dof < nv; ++dof) {
    if (forced[static_cast<std::size_t>(dof)]) dofs.push_back(dof);
  }
  for (std::size_t record = 0; record < path_.first.size(); ++record) {
    d.setZero();
    for (Index k = path_.first[record]; k < path_.EndOf(record); ++k) {
      const TickTangent& tangent = path_.At(k);
      for (Index j = 0; j < count; ++j) {
        for (const auto& [dof, signal] :
             columns[static_cast<std::size_t>(first + j)]->forces) {
          F(dof, j) = signal[k];
        }
      }
      const Tick& tick = ticks_[static_cast<std::size_t>(k)];
      for (Index row = tick.first; row < tick.end; ++row) {
        const Reading& reading = readings_[static_cast<std::size_t>(row)];
        y.noalias() = C_.col(row).transpose() * d;
        if (reading.late) y += tangent.D.row(reading.sensor) * F;
        if (any_reading) {
          for (Index j = 0; j < count; ++j) {
            for (const auto& [sensor, signal] :
                 columns[static_cast<std::size_t>(first + j)]->readings) {
              if (sensor == reading.sensor) y[j] += signal[reading.sample];
            }
          }
        }
        out.row(row).segment(first, count) = y * inverse_sd_[row];
        d.noalias() -= K_.col(row) * y;
      }
      if (of_latent != &tangent) {
        of_latent = &tangent;
        latent = tangent.B(Eigen::indexing::all, path_.dofs);
      }
      moved.noalias() = tangent.A * d.topRows(ns);
      moved.noalias() += latent * d.middleRows(ns, nf);
      for (const Index dof : dofs) moved.noalias() += tangent.B.col(dof) * F.row(dof);
      d.topRows(ns) = moved;
      d.bottomRows(nf + 1) = rho_.asDiagonal() * d.bottomRows(nf + 1);
    }
  }
}

MatrixXd Whitening::Of(const std::vector<const Column*>& columns) const {
  const Index count = std::ssize(columns);
  MatrixXd out(rows(), count);
  ParallelFor(static_cast<int>((count + kTogether - 1) / kTogether), [&](int chunk) {
    const Index first = chunk * kTogether;
    ForwardInto(columns, first, std::min(kTogether, count - first), out);
  });
  return out;
}

std::vector<Whitening::Transposed> Whitening::TransposedTimes(const MatrixXd& u) const {
  const Index n = K_.rows();
  const Index nf = path_.dof_count();
  const Index ns = n - nf - 1;
  const Index nv = path_.tangents.front().B.cols();
  std::vector<Transposed> all(static_cast<std::size_t>(u.cols()));
  const auto chunks = static_cast<int>((u.cols() + kTogether - 1) / kTogether);
  ParallelFor(chunks, [&](int chunk) {
    const Index first = chunk * kTogether;
    const Index count = std::min(kTogether, u.cols() - first);
    for (Index j = 0; j < count; ++j) {
      Transposed& one = all[static_cast<std::size_t>(first + j)];
      one.forces = MatrixXd::Zero(nv, path_.samples());
      one.readings = MatrixXd::Zero(path_.sensors(), path_.samples());
    }
    MatrixXd l(n, count);
    MatrixXd moved(n, count);
    MatrixXd F(nv, count);
    Eigen::RowVectorXd y(count);
    for (std::size_t record = path_.first.size(); record-- > 0;) {
      l.setZero();
      for (Index k = path_.EndOf(record); k-- > path_.first[record];) {
        const TickTangent& tangent = path_.At(k);
        F.noalias() = tangent.B.transpose() * l.topRows(ns);
        moved.topRows(ns).noalias() = tangent.A.transpose() * l.topRows(ns);
        for (Index j = 0; j < nf; ++j) {
          moved.row(ns + j) = F.row(path_.dofs[static_cast<std::size_t>(j)]);
        }
        moved.row(n - 1).setZero();
        moved.bottomRows(nf + 1) += rho_.asDiagonal() * l.bottomRows(nf + 1);
        l = moved;
        const Tick& tick = ticks_[static_cast<std::size_t>(k)];
        for (Index row = tick.end; row-- > tick.first;) {
          const Reading& reading = readings_[static_cast<std::size_t>(row)];
          y = u.row(row).segment(first, count) * inverse_sd_[row];
          y.noalias() -= K_.col(row).transpose() * l;
          l.noalias() += C_.col(row) * y;
          if (reading.late) {
            F.noalias() += tangent.D.row(reading.sensor).transpose() * y;
          }
          for (Index j = 0; j < count; ++j) {
            all[static_cast<std::size_t>(first + j)].readings(reading.sensor,
                                                              reading.sample) += y[j];
          }
        }
        for (Index j = 0; j < count; ++j) {
          all[static_cast<std::size_t>(first + j)].forces.col(k) = F.col(j);
        }
      }
    }
  });
  return all;
}

double Whitening::Transposed::Times(const Column& column) const {
  double sum = 0.0;
  for (const auto& [dof, signal] : column.forces) sum += forces.row(dof).dot(signal);
  for (const auto& [sensor, signal] : column.readings) {
    sum += readings.row(sensor).dot(signal);
  }
  return sum;
}

}  // namespace mjdiag
