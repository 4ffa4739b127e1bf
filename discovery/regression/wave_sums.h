#pragma once
// Sums over a run of a signal times waves of many evenly spaced periods or frequencies,
//
//   s_m = sum over k of g_k exp(i (angle_k + m increment_k)),   m = 0 .. count - 1
//
// by one fast Fourier transform of the signal spread over the increments (non-uniform FFT of
// type 1: L. Greengard, J.-Y. Lee, "Accelerating the nonuniform fast Fourier transform", SIAM
// Review 46(3), 2004), right to 1e-3 of what noise of the signal's size sums up to.

#include <Eigen/Core>

namespace mjdiag {

Eigen::VectorXcd WaveSums(const Eigen::VectorXd& g, const Eigen::VectorXd& angle,
                          const Eigen::VectorXd& increment, Eigen::Index count);

}  // namespace mjdiag
