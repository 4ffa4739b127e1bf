#include "mjdiag/discovery/regression/whitening.h"

#include <algorithm>
#include <utility>

#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Columns that go through the run side by side: their deviations stay in the cache.
constexpr Index kTogether = 32;

void ForwardInto(const FilterPath& path, const KeptGains& gains,
                 const std::vector<const Column*>& columns, Index first, Index count,
                 MatrixXd& out) {
  const Index n = gains.K.rows();
  const Index nf = path.dof_count();
  const Index ns = n - nf - 1;
  const Index nv = path.tangents.front().B.cols();
  MatrixXd d(n, count);
  MatrixXd moved(ns, count);
  MatrixXd F = MatrixXd::Zero(nv, count);
  MatrixXd H = MatrixXd::Zero(path.sensors(), count);
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
  for (std::size_t record = 0; record < path.first.size(); ++record) {
    d.setZero();
    for (Index k = path.first[record]; k < path.EndOf(record); ++k) {
      const TickTangent& tangent = path.At(k);
      for (Index j = 0; j < count; ++j) {
        for (const auto& [dof, signal] :
             columns[static_cast<std::size_t>(first + j)]->forces) {
          F(dof, j) = signal[k];
        }
      }
      const KeptGains::Tick& tick = gains.ticks[static_cast<std::size_t>(k)];
      for (Index row = tick.first; row < tick.end; ++row) {
        const KeptGains::Reading& reading =
            gains.readings[static_cast<std::size_t>(row)];
        y.noalias() = gains.C.col(row).transpose() * d;
        if (reading.late) y += tangent.D.row(reading.sensor) * F;
        if (any_reading) {
          for (Index j = 0; j < count; ++j) {
            for (const auto& [sensor, signal] :
                 columns[static_cast<std::size_t>(first + j)]->readings) {
              if (sensor == reading.sensor) y[j] += signal[reading.sample];
            }
          }
        }
        out.row(row).segment(first, count) = y * gains.inverse_sd[row];
        d.noalias() -= gains.K.col(row) * y;
      }
      if (of_latent != &tangent) {
        of_latent = &tangent;
        latent = tangent.B(Eigen::indexing::all, path.dofs);
      }
      moved.noalias() = tangent.A * d.topRows(ns);
      moved.noalias() += latent * d.middleRows(ns, nf);
      for (const Index dof : dofs) moved.noalias() += tangent.B.col(dof) * F.row(dof);
      for (Index j = 0; j < count; ++j) {
        for (const auto& [state, signal] :
             columns[static_cast<std::size_t>(first + j)]->states) {
          moved(state, j) += signal[k];
        }
      }
      d.topRows(ns) = moved;
      d.bottomRows(nf + 1) = gains.rho.asDiagonal() * d.bottomRows(nf + 1);
    }
  }
}

}  // namespace

MatrixXd WhitenedAlong(const FilterPath& path, const KeptGains& gains,
                       const std::vector<const Column*>& columns) {
  const Index count = std::ssize(columns);
  MatrixXd out(gains.rows(), count);
  ParallelFor(static_cast<int>((count + kTogether - 1) / kTogether), [&](int chunk) {
    const Index first = chunk * kTogether;
    ForwardInto(path, gains, columns, first, std::min(kTogether, count - first), out);
  });
  return out;
}

Whitening::Whitening(const FilterPath& path, KeptGains gains)
    : path_(path), gains_(std::move(gains)) {}

std::vector<Whitening::Transposed> Whitening::TransposedTimes(const MatrixXd& u) const {
  const Index n = gains_.K.rows();
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
      one.forces = MatrixXd::Zero(path_.samples(), nv);
      one.readings = MatrixXd::Zero(path_.samples(), path_.sensors());
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
        moved.bottomRows(nf + 1) += gains_.rho.asDiagonal() * l.bottomRows(nf + 1);
        l = moved;
        const KeptGains::Tick& tick = gains_.ticks[static_cast<std::size_t>(k)];
        for (Index row = tick.end; row-- > tick.first;) {
          const KeptGains::Reading& reading =
              gains_.readings[static_cast<std::size_t>(row)];
          y = u.row(row).segment(first, count) * gains_.inverse_sd[row];
          y.noalias() -= gains_.K.col(row).transpose() * l;
          l.noalias() += gains_.C.col(row) * y;
          if (reading.late) {
            F.noalias() += tangent.D.row(reading.sensor).transpose() * y;
          }
          for (Index j = 0; j < count; ++j) {
            all[static_cast<std::size_t>(first + j)].readings(reading.sample,
                                                              reading.sensor) += y[j];
          }
        }
        for (Index j = 0; j < count; ++j) {
          all[static_cast<std::size_t>(first + j)].forces.row(k) = F.col(j).transpose();
        }
      }
    }
  });
  return all;
}

}  // namespace mjdiag
