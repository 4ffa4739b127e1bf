#include "mjdiag/plugin/effects/regressor_signals.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mjdiag/signals/simulate_lti.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

double Range(const VectorXd& x) { return x.maxCoeff() - x.minCoeff(); }

std::vector<double> LogGrid(double least, double most, int count) {
  std::vector<double> grid;
  grid.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    grid.push_back(least *
                   std::pow(most / least, static_cast<double>(i) / (count - 1)));
  }
  return grid;
}

double Sign(double x) { return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0; }

VectorXd Direction(const VectorXd& velocity) {
  const double slow = velocity.cwiseAbs().maxCoeff() / 200.0;
  if (slow == 0.0) return VectorXd::Zero(velocity.size());
  return (velocity / slow).array().tanh();
}

VectorXd Follow(const VectorXd& q, double length) {
  VectorXd z = VectorXd::Zero(q.size());
  for (Index k = 1; k < q.size(); ++k) {
    const double step = q[k] - q[k - 1];
    const double end = std::copysign(length, step);
    z[k] = end + (z[k - 1] - end) * std::exp(-std::abs(step) / length);
  }
  return z;
}

VectorXd Delayed(const VectorXd& u) {
  VectorXd late(u.size());
  late[0] = u[0];
  late.tail(u.size() - 1) = u.head(u.size() - 1);
  return late;
}

VectorXd Lagged(const VectorXd& u, double time_constant) {
  const double ratio = 1.0 / time_constant;
  const double decay = std::exp(-ratio);
  const double mean = -std::expm1(-ratio) / ratio;
  VectorXd lagged(u.size());
  double state = u[0];
  for (Index k = 0; k < u.size(); ++k) {
    lagged[k] = u[k] + (state - u[k]) * mean;
    state = u[k] + (state - u[k]) * decay;
  }
  return lagged;
}

VectorXd AppendagePull(const VectorXd& q, double frequency, double damping_ratio,
                       double sample_time) {
  // Enough steps a sample for the velocity-first Euler to be accurate.
  constexpr int kSubsteps = 4;
  const double h = sample_time / kSubsteps;
  const double omega = 2.0 * std::numbers::pi * frequency;
  VectorXd pull(q.size());
  double x = q[0];
  double velocity = 0.0;
  for (Index k = 0; k < q.size(); ++k) {
    const double next = k + 1 < q.size() ? q[k + 1] : q[k];
    const double v = (next - q[k]) / sample_time;
    double sum = 0.0;
    for (int i = 0; i < kSubsteps; ++i) {
      const double now = q[k] + v * h * i;
      const double force =
          omega * omega * (x - now) + 2.0 * damping_ratio * omega * (velocity - v);
      sum += force;
      velocity -= h * force;
      x += h * velocity;
    }
    pull[k] = sum / kSubsteps;
  }
  return pull;
}

VectorXd MotionWithSpring(MechanicalModel model, Index joint, double added,
                          const VectorXd& q, double sample_time, double step) {
  const VectorXd entry = VectorXd::Unit(model.M.rows(), joint);
  model.K(joint, joint) += added;
  model.Gamma = entry;
  model.b = entry;
  const StateSpace tick =
      TickModel(model, step, static_cast<int>(std::lround(sample_time / step)));
  return q + SimulateLti(tick, -added * q.transpose()).row(0).transpose();
}

Eigen::MatrixXd CentralDifferences(const Eigen::MatrixXd& x, double sample_time) {
  const Index n = x.cols();
  Eigen::MatrixXd derivative(x.rows(), n);
  for (Index k = 0; k < n; ++k) {
    const Index before = std::max<Index>(k - 1, 0);
    const Index after = std::min<Index>(k + 1, n - 1);
    const double span = std::max<double>(1.0, static_cast<double>(after - before));
    derivative.col(k) = (x.col(after) - x.col(before)) / (span * sample_time);
  }
  return derivative;
}

}  // namespace mjdiag
