#pragma once
// Residual generators and prefilters at work: m filters over the same signals z = [y;
// u] with one denominator, [AB383], Eq. 15,
//
//   r_j = d(p)^-1 sum_k N_jk p^k z,   p = (z - 1) / kDeltaScale
//
// as one state space in observable form on powers of p over the cut-off, so that seven
// integrators at 50 Hz under an 8 kHz clock stay of order one. Filters made of
// polynomial coefficients in z or in seconds lose all their digits there.

#include <Eigen/Core>
#include <span>
#include <vector>

namespace mjdiag {

/// d(p): Butterworth low-pass ([AB383], Eq. 31 and 33), its poles moved to discrete
/// time by z = exp(s T).
struct Denominator {
  int order = 7;
  double cutoff = 50.0;  ///< [Hz]
};

/// m rows of numerators: coefficient of p^k is m x nz.
using Numerators = std::vector<Eigen::MatrixXd>;

/// Coefficients of the filters; build with MakeFilterBank.
struct FilterBank {
  double sample_time = 0.0;
  Eigen::VectorXd feedback;  ///< a_k, order: what each stage takes back from the last
  double gain = 0.0;         ///< g: x_k+ = x_k + g (x_k-1 - a_k x_last) + (B z)_k
  Eigen::MatrixXd B;         ///< order m x nz, stage by stage, outputs together
  Eigen::MatrixXd D;         ///< m x nz

  Eigen::Index order() const { return feedback.size(); }
  Eigen::Index outputs() const { return D.rows(); }
  Eigen::Index inputs() const { return D.cols(); }
};

/// InputError if the denominator's order is below the degree of the numerators, or its
/// cut-off is not between 0 and half the sampling rate.
FilterBank MakeFilterBank(const Numerators& numerators, const Denominator& denominator,
                          double sample_time);

/// Some of the outputs as a bank of their own.
FilterBank Outputs(const FilterBank& bank, Eigen::Index first, Eigen::Index count);

/// Covariance of the outputs, m x m, under white noise on the signals.
/// @param noise_sd  nz, standard deviation a sample of every signal
Eigen::MatrixXd OutputCovariance(const FilterBank& bank,
                                 const Eigen::VectorXd& noise_sd);

/// State matrix of the chain of stages that every output has, order x order; the output
/// takes its last state.
Eigen::MatrixXd ChainMatrix(const FilterBank& bank);

/// Response of every output to every signal at z = exp(i 2 pi f T), m x nz.
Eigen::MatrixXcd FrequencyResponse(const FilterBank& bank, double frequency);

/// Samples until the slowest transient has decayed to `fraction`.
Eigen::Index SettlingSamples(const FilterBank& bank, double fraction);

/// The bank with its states. Step does not allocate, lock or throw.
class RunningBank {
 public:
  explicit RunningBank(FilterBank bank);

  const FilterBank& bank() const { return bank_; }
  void Reset() noexcept { states_.setZero(); }
  /// From now on of the first outputs only, which go on as they were.
  void KeepFirst(Eigen::Index outputs);
  /// Takes the states that a constant z leads to: no transient follows from there.
  /// Does not allocate, lock or throw.
  void Settle(const Eigen::VectorXd& z) noexcept;
  /// Outputs of this sample, and on to the next. Valid until the next Step.
  const Eigen::VectorXd& Step(const Eigen::VectorXd& z) noexcept;

 private:
  /// The outputs from `first` on, in groups of kCount and then of less. Outputs do not
  /// touch each other, and in groups of a size that the compiler knows they stay in
  /// registers: that takes a third of the time of general matrix products.
  template <int kCount>
  void StepGroups(Eigen::Index first, const Eigen::VectorXd& z) noexcept;
  template <int kCount>
  void StepGroup(Eigen::Index first, const Eigen::VectorXd& z) noexcept;

  FilterBank bank_;
  Eigen::MatrixXd states_;  // m x order
  Eigen::MatrixXd settle_;  // (I - A)^-1 of a chain, transposed
  Eigen::VectorXd drive_;   // B z
  Eigen::VectorXd output_;
};

/// Runs the bank from rest over whole signals.
/// @param signals  nz x N
/// @return m x N
Eigen::MatrixXd FilterSignals(const FilterBank& bank, const Eigen::MatrixXd& signals);

}  // namespace mjdiag
