#pragma once
// Fault magnitudes by regression of the residuals on the prefiltered signals,
//
//   r_t = sum_i phi_i,t f_i + n_t,   f^ = (G^T G)^-1 G^T r
//
// ([AB383], Eq. 25 and 26) one sample at a time, with exponential forgetting if
// wanted: G^T G and G^T r are summed, and solved on request. Without forgetting that is
// the batch estimate.
//
// The noise n of the residuals is coloured: white sensor noise w behind the residual
// filter, xi+ = A xi + B w, n = C xi + D w. Ordinary least squares stays unbiased, but
// its usual standard errors would be far too small. The exact covariance of the
// estimate,
//
//   Cov f^ = (G^T G)^-1 E[m m^T] (G^T G)^-1,   m = G^T n,
//
// is carried along by the recursion of the joint covariance of m and xi: with
// m+ = l m + g_t n_t for the forgetting factor l,
//   M+ = l^2 M + l (Y g^T + g Y^T) + g N g^T,  Y = X C^T,  N = C S C^T + D Q D^T
//   X+ = l X A^T + g E[n xi+^T]
// where S is the covariance of xi, M that of m, X = E[m xi^T] and E[n xi+^T]^T =
// A S C^T + B Q D^T. Filters that start at rest have S = 0 first, S+ = A S A^T + B Q
// B^T: the noise of the residual has yet to build up.

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "mjdiag/diagnosis/residuals/filter_bank.h"
#include "mjdiag/signals/state_space.h"

namespace mjdiag {

/// The noise of n residuals at the rate at which they are regressed.
struct ResidualNoise {
  Eigen::MatrixXd A;       ///< from one regressed sample to the next, ns x ns
  Eigen::MatrixXd C;       ///< n x ns
  Eigen::MatrixXd state;   ///< stationary S, ns x ns
  Eigen::MatrixXd drive;   ///< what that adds to S: sum_j A^j B Q B^T A^jT
  Eigen::MatrixXd direct;  ///< D Q D^T, n x n
  Eigen::MatrixXd carry;   ///< A^(decimation-1) B Q D^T, ns x n
};

/// Of the first `residuals` outputs of a bank, every `decimation`-th sample.
/// @param noise_sd  nz, of every signal
ResidualNoise MakeResidualNoise(const FilterBank& bank, Eigen::Index residuals,
                                const Eigen::VectorXd& noise_sd, int decimation);

struct FaultEstimate {
  Eigen::VectorXd value;       ///< nf, deviation from the point of design
  Eigen::MatrixXd covariance;  ///< nf x nf
};

class FaultEstimator {
 public:
  /// @param faults      nf
  /// @param at_rest     the filters start with the first sample; else they have run for
  ///                    long and their noise is stationary
  /// @param forgetting  lambda: weight of a squared residual against the next one,
  ///                    0 < lambda <= 1
  FaultEstimator(Eigen::Index faults, ResidualNoise noise, double forgetting,
                 bool at_rest = false);

  /// The filters have run for long: their noise is stationary from here on.
  void AssumeStationary() noexcept;

  /// One regressed sample. Does not allocate, lock or throw.
  /// @param residuals   n
  /// @param regressors  nf x n, phi of every fault for every residual
  void Add(const Eigen::Ref<const Eigen::VectorXd>& residuals,
           const Eigen::Ref<const Eigen::MatrixXd>& regressors) noexcept;

  /// f^ so far into `value`; all 0 while the regression is rank deficient. Does not
  /// allocate, lock or throw.
  void Solve(Eigen::Ref<Eigen::VectorXd> value) noexcept;

  /// Value and covariance. NumericalError if the regression is rank deficient:
  /// Inseparable() says which faults are why.
  FaultEstimate Estimate() const;

  /// The faults that carry the direction that the data leave undetermined, by index;
  /// empty if they determine all.
  std::vector<Eigen::Index> Inseparable() const;

  Eigen::Index samples() const { return samples_; }

 private:
  void UpdateNoise() noexcept;
  void BuildUp() noexcept;
  /// Of all residuals together, when stationary.
  double Variance() const noexcept;

  ResidualNoise noise_;
  double forgetting_;
  Eigen::Index samples_ = 0;
  Eigen::MatrixXd information_;  // G^T G
  Eigen::VectorXd right_;        // G^T r
  Eigen::MatrixXd spread_;       // M, nf x nf
  Eigen::MatrixXd memory_;       // X, nf x ns
  bool building_up_;             // S is not stationary yet
  Eigen::MatrixXd state_;        // S
  Eigen::MatrixXd output_;       // N
  Eigen::MatrixXd ahead_;        // E[xi+ n^T]
  // From the variance of the residual to that at rest.
  double left_ = std::numeric_limits<double>::infinity();
  // Work space, so that nothing allocates.
  Eigen::MatrixXd state_C_;     // S C^T
  Eigen::MatrixXd next_state_;  // A S
  Eigen::MatrixXd next_memory_;
  Eigen::MatrixXd from_memory_;  // Y, nf x n
  Eigen::MatrixXd weighted_;     // g N, nf x n
  Eigen::MatrixXd scaled_;       // nf x nf
  Eigen::VectorXd scale_;
  Eigen::VectorXd solution_;
};

}  // namespace mjdiag
