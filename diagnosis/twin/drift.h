#pragma once
// Faults that grow in the course of a pass. The estimate takes the machine as constant, and
// what a fault that grows leaves of the innovations would be explained by others that are
// not there. Beside it, therefore, what the readings say of the rates r at which unknowns
// grow is added up, theta(t) = theta + r t, without a part in the estimate:
//
//   H_r += psi_r^T psi_r,   H_x += psi^T psi_r,   g_r += psi_r^T e
//
// with psi_r = d yp / d r, in units of the noise of e. Where they say that r is not 0,
// phi = theta + r t, of now, is what remains of the estimate with r unknown,
//
//   B = H_x - t H_d,   M = H_r - t (H_x,d + H_x,d^T) + t^2 H_dd + P_r^-1,   b = g_r
//   H* = H - B M^-1 B^T,   phi = -H*^-1 B M^-1 b,   r = M^-1 (b - B^T phi)
//
// about the estimate, d the columns of what grows; the fit is better by b^T r, which is
// chi-squared where nothing grows.

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "mjdiag/diagnosis/twin/information.h"

namespace mjdiag {

/// Standard deviation of a rate at which a logarithm grows, of which nothing is known
/// beforehand [1/s].
inline constexpr double kRateSpread = 0.1;

class Drift {
 public:
  /// @param drifting  places of those that may grow among p unknowns
  Drift(Eigen::Index p, std::vector<Eigen::Index> drifting);

  // Nothing below allocates, locks or throws.

  void Know(const Drift& other) noexcept;
  void Start() noexcept;
  /// One block, whitened. @param psi, psi_r  of as many rows as e; p or more columns, and r
  void Add(const Eigen::MatrixXd& psi, const Eigen::MatrixXd& psi_r,
           const Eigen::VectorXd& e, Eigen::Index active) noexcept;
  /// phi, r and H* after t seconds.
  /// @param estimate  of the same blocks
  /// @param rate_sd   that rates may have [1/s]
  void Solve(const Information& estimate, double t, double rate_sd) noexcept;

  // As solved last.
  /// phi less the estimate, p.
  const Eigen::VectorXd& change() const { return change_; }
  const Eigen::VectorXd& rates() const { return rates_; }            ///< r [1/s]
  const Eigen::MatrixXd& information() const { return remaining_; }  ///< H*, p x p
  double gain() const { return gain_; }                              ///< b^T r

  const std::vector<Eigen::Index>& drifting() const { return drifting_; }

 private:
  std::vector<Eigen::Index> drifting_;
  Eigen::MatrixXd H_r_, H_x_;
  Eigen::VectorXd g_r_;
  Eigen::VectorXd change_, rates_;
  Eigen::MatrixXd remaining_;
  double gain_ = 0.0;
  // Work space.
  Eigen::MatrixXd B_, by_, M_, factor_;
  Eigen::VectorXd b_, scale_, solved_;
};

}  // namespace mjdiag
