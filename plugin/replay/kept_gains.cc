#include "mjdiag/plugin/replay/kept_gains.h"

#include <cmath>
#include <functional>

#include "mjdiag/plugin/machine/tick_map.h"
#include "mjdiag/plugin/replay/linear_pass.h"
#include "mjdiag/plugin/replay/recorded_inputs.h"
#include "mjdiag/plugin/replay/shared_bodies.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd OverdispersionAlong(const FilterPath& path) {
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

KeptGains KeepGains(const FilterPath& path) {
  return KeepGains(path, path.noise, OverdispersionAlong(path));
}

KeptGains KeepGains(const FilterPath& path, const FilterNoise& noise,
                    const MatrixXd& inflation) {
  KeptGains kept;
  kept.ticks.resize(static_cast<std::size_t>(path.samples()));
  const Index n = path.pulled.rows();
  const Index rows = path.counts.count();
  kept.K.resize(n, rows);
  kept.C.resize(n, rows);
  kept.inverse_sd.resize(rows);
  kept.left.resize(rows);
  Index row = 0;
  for (std::size_t record = 0; record < path.first.size(); ++record) {
    LinearPass pass(path, noise);
    pass.inflation = &inflation;
    pass.at_tick = [&](Index k) {
      kept.ticks[static_cast<std::size_t>(k)].first = row;
    };
    pass.at_reading = [&](Index sensor, Index sample, bool late, double) {
      kept.readings.push_back({sensor, sample, late});
      kept.K.col(row) = pass.kalman.gain;
      kept.C.col(row) = pass.kalman.c();
      kept.inverse_sd[row] = 1.0 / std::sqrt(pass.kalman.variance);
      kept.left[row] = pass.kalman.last_innovation * kept.inverse_sd[row];
      kept.log_determinant += std::log(pass.kalman.variance);
      ++row;
    };
    pass.at_advance = [&](Index k) {
      kept.ticks[static_cast<std::size_t>(k)].end = row;
    };
    const Index first = path.first[record];
    pass.Over(first, path.EndOf(record) - first);
    kept.rho = pass.kalman.rho();
  }
  // Readings of the end of a tick before the first one of a record are taken by nobody.
  kept.K.conservativeResize(n, row);
  kept.C.conservativeResize(n, row);
  kept.inverse_sd.conservativeResize(row);
  kept.left.conservativeResize(row);
  return kept;
}

namespace {

/// @param after_tick  called with the map and the sample after every tick
VectorXd RunAlong(const Machine& machine, const MeasuredRun& run,
                  const FilterPath& path, const KeptGains& gains,
                  const std::vector<Machine>& others,
                  const std::function<void(const TickMap&, Index)>& after_tick) {
  VectorXd left(gains.rows());
  const Index nf = path.dof_count();
  const Index ns = path.pulled.rows() - nf - 1;
  ParallelFor(static_cast<int>(path.first.size()), [&](int number) {
    const auto record = static_cast<std::size_t>(number);
    const Machine during = DuringRecord(run.records[record], machine);
    TickMap map(during);
    map.TellPushesOf(DuringRecord(run.records[record], others));
    const mjModel& model = map.model();
    RecordedInputs inputs(during, run);
    PlantState state = map.Begun(path.starts[record].state);
    const SharedBodies bodies(map, path);
    VectorXd latent = VectorXd::Zero(nf);
    VectorXd applied = VectorXd::Zero(model.nv);
    VectorXd z(ns + nf + 1);
    VectorXd read, ended;
    double clock = 0.0;
    const Index first = path.first[record];
    for (Index k = first; k < path.EndOf(record); ++k) {
      const Index tick = run.TickOf(k);
      const TickTangent& tangent = path.At(k);
      read = map.Read(state, tick);
      z.setZero();
      Index row = gains.ticks[static_cast<std::size_t>(k)].first;
      const Index end = gains.ticks[static_cast<std::size_t>(k)].end;
      const auto take = [&](bool late, const VectorXd& expected) {
        for (; row < end && gains.readings[static_cast<std::size_t>(row)].late == late;
             ++row) {
          const KeptGains::Reading& reading =
              gains.readings[static_cast<std::size_t>(row)];
          const double e = run.outputs(reading.sensor, reading.sample) -
                           expected[reading.sensor] -
                           path.speeds(reading.sensor, reading.sample) * clock -
                           gains.C.col(row).dot(z);
          left[row] = e * gains.inverse_sd[row];
          z += e * gains.K.col(row);
        }
      };
      take(false, read);
      state = Moved(model, state, bodies.Pulled(z));
      latent += z.segment(ns, nf);
      clock += z[ns + nf];
      applied(path.dofs) = latent;
      inputs.StayAt(k);
      const TickMap::Result& ticked = map.Run(state, applied, tick, inputs);
      if (ticked.diverged) throw NumericalError("fit: the run diverges");
      if (after_tick) after_tick(map, k);
      PlantState next = ticked.state;
      z.setZero();
      if (row < end) {
        ended = ticked.reading;
        take(true, ended);
        VectorXd moved = tangent.A * z.head(ns);
        for (Index j = 0; j < nf; ++j) {
          moved += tangent.B.col(path.dofs[static_cast<std::size_t>(j)]) * z[ns + j];
        }
        next = Moved(model, next, bodies.Pulled(moved));
        latent += z.segment(ns, nf);
        clock += z[ns + nf];
      }
      state = std::move(next);
      latent = latent.cwiseProduct(gains.rho.head(nf));
      clock *= gains.rho[nf];
    }
  });
  return left;
}

}  // namespace

VectorXd PredictAlong(const Machine& machine, const MeasuredRun& run,
                      const FilterPath& path, const KeptGains& gains) {
  return RunAlong(machine, run, path, gains, {}, {});
}

std::vector<MatrixXd> PushesAlong(const Machine& machine, const MeasuredRun& run,
                                  const FilterPath& path, const KeptGains& gains,
                                  const std::vector<Machine>& others) {
  std::vector<MatrixXd> pushes(others.size(),
                               MatrixXd::Zero(machine.plant().nv, path.samples()));
  RunAlong(machine, run, path, gains, others, [&](const TickMap& map, Index k) {
    const MatrixXd then = map.OtherPushes();
    for (std::size_t o = 0; o < others.size(); ++o) {
      pushes[o].col(k) = then.col(static_cast<Index>(o));
    }
  });
  return pushes;
}

}  // namespace mjdiag
