#include "mjdiag/diagnosis/statistics/magnitude_interval.h"

#include <cmath>

#include "mjdiag/diagnosis/statistics/distributions.h"

namespace mjdiag {

Interval NormalInterval(double estimate, double sd, double outside) {
  const double half = TwoSidedNormalQuantile(outside) * sd;
  return {estimate - half, estimate + half};
}

Interval MagnitudeInterval(double magnitude, double sd, Eigen::Index parts,
                           double outside) {
  // From here on normal but for 1 / (2 kLarge) of its standard deviation, the second order
  // of the root.
  constexpr double kLarge = 30.0;
  if (!(magnitude < kLarge * sd)) return NormalInterval(magnitude, sd, outside);
  const auto dof = static_cast<double>(parts);
  const double seen = dof + std::pow(magnitude / sd, 2);
  const auto end = [&](double probability) {
    const double root = std::sqrt(NoncentralityOf(seen, dof, probability));
    return root == 0.0 ? 0.0 : sd * root;  // where nothing is known, too
  };
  return {end(0.5 * outside), end(1.0 - 0.5 * outside)};
}

}  // namespace mjdiag
