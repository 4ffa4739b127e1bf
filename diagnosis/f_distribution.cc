#include "mjdiag/diagnosis/f_distribution.h"

#include <Eigen/Core>
#include <unsupported/Eigen/SpecialFunctions>

namespace mjdiag {
namespace {

/// P(F > x).
double FTail(double x, double dof1, double dof2) {
  return Eigen::numext::betainc(0.5 * dof2, 0.5 * dof1, dof2 / (dof2 + dof1 * x));
}

}  // namespace

double FQuantile(double probability, double dof1, double dof2) {
  double low = 0.0;
  double high = 1.0;
  while (FTail(high, dof1, dof2) > probability && high < 1e300) high *= 2.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (FTail(middle, dof1, dof2) > probability ? low : high) = middle;
  }
  return high;
}

}  // namespace mjdiag
