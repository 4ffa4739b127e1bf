#pragma once
// The recursive prediction error method [Ljung83] on a twin. Innovations are averaged
// over blocks, e, with their sensitivities psi = d mean(yp) / d theta about the point
// theta0 at which the twin runs; a block adds
//
//   H += psi^T W psi,   g += psi^T W e,   and   theta = theta0 + H^-1 g
//
// is the estimate, H^-1 its covariance: whitened least squares, because the innovations
// of the true twin are white. W is the inverse variance of a block's mean of the sensor
// noise. Far from theta0 that is not exact, and the twin goes back:
//
// - It keeps the last readings. Where a block is surprising, that is larger than noise
//   and the uncertainty of the estimate let expect, or the estimate has moved so far that
//   the second order would be seen, it starts anew at the first of them from the better
//   theta, and catches up with the machine at twice its pace. H and g are formed again,
//   about a point that is nearer. That is the method of Gauss and Newton on a horizon
//   that grows with what is explained; each pass squares the error that is left.
// - Where the horizon does not grow any more, the noise is taken as larger for a while.
// - What the data do not move is held at nominal by its prior; what is surely elsewhere
//   is not.
//
// A run that does not begin at rest begins, for the estimator, at a tick at which the
// machine is quiet, in the state that a twin has there which was pulled towards the
// readings until then, with that state among the unknowns.

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "mjdiag/diagnosis/twin/twin.h"

namespace mjdiag {

struct PredictionErrorOptions {
  double forgetting = 0.0;    ///< [s] time constant; 0: none
  double settling = 0.05;     ///< [s] of a twin that is pulled, at least
  double looking = 0.25;      ///< [s] after that in which a quiet tick is looked for
  Eigen::Index kept = 32768;  ///< readings that it can go back to
};

class PredictionErrorEstimator {
 public:
  /// @param sensor_noise  sd of a reading, ny, > 0
  PredictionErrorEstimator(std::unique_ptr<Twin> twin, std::vector<Unknown> unknowns,
                           Eigen::VectorXd sensor_noise, double sample_time,
                           const PredictionErrorOptions& options);

  /// One control tick. Does not allocate, lock, throw or do I/O.
  void Add(std::span<const double> outputs, std::span<const double> inputs) noexcept;
  /// At the end of a run: whatever readings it has yet to catch up with.
  void CatchUp() noexcept;

  /// theta now, p.
  const Eigen::VectorXd& theta() const { return theta_; }
  /// H of what it has seen, prior and all, p x p.
  const Eigen::MatrixXd& information() const { return H_; }
  /// Unknowns that are estimated: all, or all but those of the start.
  Eigen::Index active() const { return active_; }
  bool at_rest() const { return at_rest_; }
  /// The part of H that was there before any data, its diagonal, p.
  const Eigen::VectorXd& prior() const { return prior_; }
  /// Standard deviations of theta, p; of the start 0 if it was at rest. Does not
  /// allocate.
  const Eigen::VectorXd& Spread() noexcept;
  /// Squares of those that Spread has found last; before that, of the priors.
  const Eigen::VectorXd& LastVariance() const { return last_variance_; }
  const std::vector<Unknown>& unknowns() const { return unknowns_; }
  /// Mean over recent blocks of the squared innovations over what noise and the
  /// uncertainty of the estimate let expect of them: 1 where the twin explains them.
  double surprise() const { return inflation_ * recent_surprise_; }
  double inflation() const { return inflation_; }
  Eigen::Index horizon() const { return farthest_seen_; }
  Eigen::Index samples() const { return added_; }
  Eigen::Index seen() const { return seen_; }
  int returns() const { return returns_; }

 private:
  void Begin() noexcept;
  void Process(std::span<const double> outputs,
               std::span<const double> inputs) noexcept;
  void ProcessKept() noexcept;
  void Regress() noexcept;
  /// Whether a run has begun: at rest at once, else at a tick at which the machine is
  /// quiet, where a pulled twin knows its state best.
  bool FindStart() noexcept;
  bool BeganAtRest() noexcept;
  Eigen::Index QuietestTick(Eigen::Index from, Eigen::Index to) const noexcept;
  /// H scaled to a unit diagonal; overwrites scaled_.
  Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> Factorise() noexcept;
  void GoBack() noexcept;
  double Farthest(const Eigen::VectorXd& change) const noexcept;
  bool WorthGoingBack() const noexcept;

  std::unique_ptr<Twin> twin_;
  std::vector<Unknown> unknowns_;
  double sample_time_;
  PredictionErrorOptions options_;
  Eigen::VectorXd noise_;  // variance of a block's mean
  Eigen::VectorXd prior_;  // 1 / prior_sd^2
  Eigen::VectorXd nominal_;

  Eigen::MatrixXd kept_;     // ny + nu x kept, a ring
  Eigen::Index origin_ = 0;  // tick at which passes start
  Eigen::Index added_ = 0;
  Eigen::Index seen_ = 0;
  Eigen::Index next_look_;
  int returns_ = 0;

  Eigen::VectorXd center_;  // theta0
  Eigen::VectorXd theta_;
  Eigen::VectorXd change_;  // theta - theta0
  Eigen::MatrixXd H_;
  Eigen::VectorXd g_;
  bool at_rest_ = true;
  Eigen::Index active_ = 0;  // unknowns, those of the start if it was not at rest
  double recent_surprise_ = 1.0;
  bool unexplained_ = false;
  Eigen::Index farthest_seen_ = 0;
  int stuck_ = 0;
  double inflation_ = 1.0;  // of the variances of the noise
  Eigen::Index in_block_ = 0;
  Eigen::Index blocks_ = 0;
  Eigen::VectorXd reading_, innovation_, sum_, corrected_;
  Eigen::MatrixXd weighted_, spread_, expected_;
  Eigen::LLT<Eigen::MatrixXd> small_;
  Eigen::VectorXd scale_;
  Eigen::MatrixXd scaled_, inverse_;
  Eigen::VectorXd spread_of_theta_, last_variance_;
  mutable Eigen::VectorXd work_;
};

}  // namespace mjdiag
