#pragma once
// The noise that a filter with latent forces (force_filter.h) takes a machine to have, of
// readings and of the model.

#include <Eigen/Core>

namespace mjdiag {

/// Readings have white noise, and a clock of their own: all are of a moment t that is off the
/// tick's by a stationary error, as loggers have them that a system schedules,
///
///   y[k] = h(x[k]) + y' t[k] + reading n[k],    t[k+1] = rho_t t[k] + ...
///
/// What a model lacks at a joint is a force of two parts: a stationary one with a size and a
/// memory,
///
///   w[k+1] = rho w[k] + sqrt(1 - rho^2) size n[k],     rho = exp(-T / memory),
///
/// and a white one that is held over a tick. What is missing is never known to be smooth: the
/// spectrum of the first, 2 size^2 memory where it is slow, does not fall below a hundredth of
/// that, or what is quick, of which next to nothing was missing, would tell the values of laws
/// that are wrong where they last. The variance of what is white is
///
///   white^2 + floor size^2 memory / T,     floor = 0.02.
struct FilterNoise {
  Eigen::VectorXd reading;    ///< ny [unit of each sensor]
  double clock = 0.0;         ///< standard deviation of t [s]
  double clock_memory = 0.0;  ///< [s]
  Eigen::VectorXd size;       ///< nf [N, N m]
  Eigen::VectorXd memory;     ///< nf [s]
  Eigen::VectorXd white;      ///< nf [N, N m]

  double floor = 0.02;
  /// Variances of what is white in ticks of T, nf.
  Eigen::VectorXd WhiteVariance(double tick) const {
    return white.cwiseAbs2() + floor / tick * size.cwiseAbs2().cwiseProduct(memory);
  }
};

}  // namespace mjdiag
