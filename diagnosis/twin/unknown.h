#pragma once
// What is not known of a machine.

#include <Eigen/Core>
#include <string>

namespace mjdiag {

/// A number of the machine that is to be estimated.
struct Unknown {
  std::string name;
  double nominal = 1.0;   ///< value to begin with
  double prior_sd = 1.0;  ///< how well that is known: of theta, see `factor`
  /// The value is a factor that stays above 0. What is estimated is its logarithm,
  /// theta = ln(value), and prior_sd is of that; else theta = value.
  bool factor = false;
  /// It may change while the machine runs; else it only is not known exactly.
  bool wears = false;
};

/// amplitude * (s sin(2 pi f t) + c cos(2 pi f t)) on the commands, s and c unknown.
struct UnknownTone {
  double frequency = 0.0;     ///< [Hz]
  Eigen::VectorXd amplitude;  ///< nu, of each command
};

}  // namespace mjdiag
