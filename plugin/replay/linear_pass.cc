#include "mjdiag/plugin/replay/linear_pass.h"

#include <algorithm>
#include <cmath>

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void LinearPass::Take(Index sensor, bool late, Index k) {
  if (path_.late[static_cast<std::size_t>(sensor)] != late) return;
  if (!path_.counts(sensor, k)) return;
  double deviance = 0.0;
  if (inflation != nullptr) {
    kalman.TakeWeighted(sensor, late, path_.innovations(sensor, k),
                        path_.speeds(sensor, k), (*inflation)(sensor, k));
  } else {
    deviance = kalman.Take(sensor, late, path_.innovations(sensor, k),
                           path_.speeds(sensor, k));
  }
  if (at_reading) at_reading(sensor, k, late, deviance);
}

void LinearPass::Over(Index first, Index count) {
  const Index nf = path_.dof_count();
  const Index n = path_.pulled.rows();
  const ForceKalman along(path_.dofs, path_.noise, path_.sample_time);
  const VectorXd forgets = kalman.rho() - along.rho();
  // The record that the samples are of.
  const auto record = static_cast<std::size_t>(
      std::ranges::upper_bound(path_.first, first) - path_.first.begin() - 1);
  kalman.Start(path_.starts[record].sd);
  for (Index k = first; k < first + count; ++k) {
    if (at_tick) at_tick(k);
    kalman.MoveTo(path_.At(k));
    for (Index i = 0; i < path_.sensors(); ++i) Take(i, false, k);
    kalman.z -= path_.pulled.col(k);
    if (k + 1 < first + count) {
      for (Index i = 0; i < path_.sensors(); ++i) Take(i, true, k + 1);
    }
    kalman.z -= path_.pulled_late.col(k);
    if (at_advance) at_advance(k);
    kalman.Advance();
    // The path forgot by its own memory.
    kalman.z.segment(n - nf - 1, nf) +=
        forgets.head(nf).cwiseProduct(path_.forces.col(k));
    kalman.z[n - 1] += forgets[nf] * path_.clock[k];
  }
}

std::vector<FilterGains> GainsAlong(const FilterPath& path, const FilterNoise& noise,
                                    Index first, Index count) {
  const Index nf = path.dof_count();
  const Index n = path.pulled.rows();
  std::vector<FilterGains> gains(static_cast<std::size_t>(count));
  LinearPass pass(path, noise);
  FilterGains* kept = nullptr;
  pass.at_tick = [&](Index k) {
    kept = &gains[static_cast<std::size_t>(k - first)];
    kept->K = MatrixXd::Zero(n, path.sensors());
    kept->S = VectorXd::Ones(path.sensors());
    kept->e = VectorXd::Zero(path.sensors());
    kept->P = pass.kalman.P.bottomRows(nf + 1);
    // The path's own force before the readings, and what the filter adds to it.
    kept->force = path.forces.col(k) +
                  (pass.kalman.z - path.pulled.col(k) - path.pulled_late.col(k))
                      .segment(n - nf - 1, nf);
  };
  pass.at_reading = [&](Index sensor, Index, bool, double) {
    kept->K.col(sensor) = pass.kalman.gain;
    kept->S[sensor] = pass.kalman.variance;
    kept->e[sensor] = pass.kalman.last_innovation;
  };
  pass.Over(first, count);
  return gains;
}

ReadingScores Score(const FilterPath& path, const FilterNoise& noise, Index first,
                    Index count, const MatrixXd* inflation) {
  const Index ny = path.sensors();
  ReadingScores scores{VectorXd::Zero(ny), VectorXd::Zero(ny)};
  VectorXd taken = VectorXd::Zero(ny);
  LinearPass pass(path, noise);
  pass.inflation = inflation;
  pass.at_reading = [&](Index sensor, Index, bool, double deviance) {
    scores.deviance[sensor] += deviance;
    scores.variance[sensor] += std::log(pass.kalman.variance);
    taken[sensor] += 1.0;
  };
  pass.Over(first, count);
  scores.variance = (scores.variance.array() / taken.array().max(1.0)).exp();
  return scores;
}

}  // namespace mjdiag
