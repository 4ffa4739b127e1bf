#pragma once
// A curve y(x) with uncertainties in words: the simplest of a list of forms that
// describes it, by weighted least squares and Schwarz's criterion
//
//   n log(max(chi^2 / n, 1, (1 % of the curve's own chi^2) / n)) + k log n -> min
//
// for n points and k parameters, of forms with a constant plus
//   nothing | x | sign x | sign x and x | x, x^2 | x, x^2, x^3 | |x|^p | sign(x) |x|^p
//   | tanh(x / w) | max(0, x - a) | max(0, a - x) | 1 inside a..b | sine of period p
// Forms with sign and powers are tried only if x has both signs. Below 1 % of the curve
// no form is better than another: real laws are not that simple.

#include <Eigen/Core>
#include <string>

namespace mjdiag {

struct CurveShape {
  std::string words;      ///< "linear", "step at zero", ..., "no simple form"
  double period = 0.0;    ///< [unit of x], else 0
  double exponent = 0.0;  ///< of a power, else 0
};

/// @param x, y, sd  at least one point, x ascending, sd > 0
/// @param unit      of x; of time [s] a period is given as a frequency, too
CurveShape DescribeCurve(const Eigen::VectorXd& x, const Eigen::VectorXd& y,
                         const Eigen::VectorXd& sd, const std::string& unit);

}  // namespace mjdiag
