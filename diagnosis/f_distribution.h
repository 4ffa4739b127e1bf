#pragma once
// Fisher's F distribution: that of the ratio of two estimates of the same variance or
// density, each as a chi-squared variable divided by its degrees of freedom.

namespace mjdiag {

/// The x that F exceeds with that probability.
/// @param probability  between 0 and 1
/// @param dof1, dof2   degrees of freedom of numerator and denominator, > 0
double FQuantile(double probability, double dof1, double dof2);

}  // namespace mjdiag
