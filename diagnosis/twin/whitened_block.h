#pragma once
// The innovations of a block of ticks and what they are sensitive to, in units of their
// noise: with S = L L^T the covariance of a tick's innovation e[k] of ny readings,
//
//   e_w[k] = L^-1 e[k],   psi_w[k] = L^-1 d yp[k] / d theta
//
// so that all rows of a block have one weight. A reading that was not measured has rows of
// zeros; S is that of the others then.

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace mjdiag {

class WhitenedBlock {
 public:
  /// @param ny, ticks  readings, and how often in a block
  /// @param p, rates   unknowns, and those that may grow
  WhitenedBlock(Eigen::Index ny, Eigen::Index ticks, Eigen::Index p,
                Eigen::Index rates);

  // Nothing below allocates, locks or throws.

  /// Of no tick.
  void Start() noexcept;
  /// The next tick.
  /// @param innovation  ny; of what was not measured it is of no account
  /// @param reading     ny, NaN where it was not measured
  void Add(const Eigen::VectorXd& innovation,
           const Eigen::Ref<const Eigen::VectorXd>& reading) noexcept;
  bool full() const { return ticks_ * measured_.size() == e_.size(); }
  /// Whether any reading was measured.
  bool any() const { return measured_.maxCoeff() > 0.0; }

  /// Of a full one.
  /// @param psi         d yp / d theta, tick below tick, ny ticks x p
  /// @param active      unknowns that are looked at
  /// @param rates       d yp / d rate, ny ticks x rates; null where nobody looks at it
  /// @param covariance  S, ny x ny
  void Whiten(const Eigen::MatrixXd& psi, Eigen::Index active,
              const Eigen::MatrixXd* rates, const Eigen::MatrixXd& covariance) noexcept;
  /// It counts that many times less.
  void Discount(double times) noexcept;

  const Eigen::VectorXd& e() const { return e_; }
  const Eigen::MatrixXd& psi() const { return psi_; }      ///< ny ticks x p
  const Eigen::MatrixXd& rates() const { return rates_; }  ///< ny ticks x rates
  /// Sums over the ticks in which each reading was measured, over the root of how many
  /// there are: what is slow against a block shows there best. Of unit noise, ny and
  /// ny x p.
  const Eigen::VectorXd& slow_e() const { return slow_e_; }
  const Eigen::MatrixXd& slow_psi() const { return slow_psi_; }

 private:
  void WhitenTick(Eigen::Index tick) noexcept;

  Eigen::Index active_ = 0, growing_ = 0;  // columns that are looked at

  Eigen::Index ticks_ = 0;
  Eigen::VectorXd measured_;  // how often each reading was, ny
  Eigen::VectorXd e_;
  Eigen::MatrixXd psi_, rates_;
  Eigen::VectorXd there_;  // 1 where a row was measured, else 0
  Eigen::VectorXd slow_e_;
  Eigen::MatrixXd slow_psi_;
  // Work space: S of a tick, and its L.
  Eigen::MatrixXd covariance_, root_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

}  // namespace mjdiag
