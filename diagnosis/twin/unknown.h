#pragma once
// What is not known of a machine.

#include <Eigen/Core>
#include <string>
#include <vector>

namespace mjdiag {

/// A coordinate of theta, which is estimated.
struct Unknown {
  std::string name;
  double nominal = 0.0;   ///< to begin with
  double prior_sd = 1.0;  ///< how well that is known
  /// How much of a logarithm of a number of the machine a unit of it is: 1 where it is
  /// one, theta = ln(factor); 0 where what it does is linear in it.
  double reach = 0.0;
  /// It may change while the machine runs; else it only is not known exactly.
  bool wears = false;
};

/// Covariance of what is known of them beforehand.
inline Eigen::MatrixXd PriorOf(const std::vector<Unknown>& unknowns) {
  Eigen::VectorXd sd(static_cast<Eigen::Index>(unknowns.size()));
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    sd[static_cast<Eigen::Index>(i)] = unknowns[i].prior_sd;
  }
  return sd.cwiseAbs2().asDiagonal();
}

/// amplitude * (s sin(2 pi f t) + c cos(2 pi f t)) on the commands, s and c unknown.
struct UnknownTone {
  double frequency = 0.0;     ///< [Hz]
  Eigen::VectorXd amplitude;  ///< nu, of each command
};

}  // namespace mjdiag
