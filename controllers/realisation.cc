#include "mjdiag/controllers/realisation.h"

#include "mjdiag/signals/error.h"

namespace mjdiag {

StateSpace Realise(const DiscreteCompensator& compensator, double sample_time) {
  const auto& b = compensator.numerator;
  const auto& a = compensator.denominator;
  if (a.empty() || b.empty() || b.size() > a.size() || a.front() == 0.0) {
    throw InputError("compensator", "empty or improper",
                     "a numerator no longer than the denominator");
  }
  const auto order = static_cast<Eigen::Index>(a.size()) - 1;
  // Numerator aligned with the denominator's powers, both over the leading coefficient.
  Eigen::VectorXd numerator = Eigen::VectorXd::Zero(order + 1);
  const auto shorter = static_cast<Eigen::Index>(b.size());
  numerator.tail(shorter) = Eigen::VectorXd::Map(b.data(), shorter) / a.front();
  const Eigen::VectorXd denominator =
      Eigen::VectorXd::Map(a.data(), order + 1) / a.front();

  StateSpace system;
  system.sample_time = sample_time;
  system.A = Eigen::MatrixXd::Zero(order, order);
  system.B = Eigen::MatrixXd::Zero(order, 1);
  system.C = Eigen::MatrixXd::Zero(1, order);
  system.D = Eigen::MatrixXd::Constant(1, 1, numerator[0]);
  if (order == 0) return system;
  system.A.row(0) = -denominator.tail(order).transpose();
  system.A.diagonal(-1).setOnes();
  system.B(0, 0) = 1.0;
  system.C =
      (numerator.tail(order) - numerator[0] * denominator.tail(order)).transpose();
  return system;
}

DiscreteCompensator LinearFeedback(const NestedLoops& gains, double sample_time) {
  const double damping = gains.velocity_gain / (2.0 * sample_time);
  return {{gains.position_gain * gains.velocity_gain + damping, 0.0, -damping},
          {1.0, 0.0, 0.0}};
}

}  // namespace mjdiag
