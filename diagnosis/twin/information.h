#pragma once
// Whitened least squares, block by block, about a point theta0: a block with innovations
// e and sensitivities psi = d yp / d theta of its ticks, in units of their noise, adds
//
//   H += psi^T psi,   g += psi^T e,   and   theta = theta0 + H^-1 g
//
// is the estimate, H^-1 its covariance. It begins with what is known beforehand, H = P0^-1,
// g = P0^-1 (nominal - theta0).

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace mjdiag {

/// What rounding leaves of a direction that others explain, over the diagonal of H.
inline constexpr double kRidge = 1e-13;

/// H^-1, of unknowns of any units.
Eigen::MatrixXd CovarianceOf(const Eigen::MatrixXd& H);

class Information {
 public:
  /// @param p   unknowns
  /// @param ny  readings
  Information(Eigen::Index p, Eigen::Index ny);

  // Nothing below allocates, locks or throws.

  /// What another one of this size knows; its work space stays there.
  void Know(const Information& other) noexcept;
  /// Anew, with the first `active` unknowns.
  /// @param prior  P0^-1, p x p
  /// @param away   nominal - theta0, p
  void Start(Eigen::Index active, const Eigen::MatrixXd& prior,
             const Eigen::VectorXd& away) noexcept;

  /// How surprising it would be: the mean square of an innovation less what the estimate
  /// explains, in units of what noise and the uncertainty of the estimate let expect. 1 on
  /// average where the model is true.
  /// @param psi, e  whitened, ny rows
  double NormalizedInnovation(const Eigen::MatrixXd& psi,
                              const Eigen::VectorXd& e) noexcept;
  /// @param psi, e  whitened, any number of rows
  void Add(const Eigen::MatrixXd& psi, const Eigen::VectorXd& e) noexcept;

  /// theta - theta0, p.
  const Eigen::VectorXd& change() const { return change_; }
  /// Squared distance of the estimate from theta0, in standard deviations.
  double SquaredChange() const;
  Eigen::Index active() const { return active_; }
  const Eigen::MatrixXd& H() const { return H_; }
  const Eigen::VectorXd& g() const { return g_; }
  /// Variances of the estimate, p.
  const Eigen::VectorXd& Variance() noexcept;

  /// What was added counts that many times less, what was there before it as before.
  void Discount(const Eigen::MatrixXd& prior, const Eigen::VectorXd& away,
                double times) noexcept;
  /// theta0 becomes theta.
  void Recentre() noexcept;
  /// Of theta that is theta0, it knows that much.
  void Assume(const Eigen::MatrixXd& H) noexcept;
  /// The unknowns have walked: their covariance grows by that, p.
  void Walk(const Eigen::VectorXd& variance) noexcept;

 private:
  void Factorise() noexcept;
  void Solve() noexcept;

  Eigen::Index active_ = 0;
  Eigen::MatrixXd H_;
  Eigen::VectorXd g_, change_, variance_;
  // Work space. The factor is that of H scaled to a unit diagonal, at its last change.
  Eigen::VectorXd scale_, solution_, corrected_, whitened_;
  Eigen::MatrixXd factor_, inverse_, spread_, expected_;
  Eigen::LLT<Eigen::MatrixXd> small_;
};

}  // namespace mjdiag
