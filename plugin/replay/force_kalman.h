#pragma once
// The covariance and the deviation of a filter with latent forces, z = [x; w; t], from one
// tick to the next (force_filter.h). Where the machine stays what it is the covariance comes
// to an end: from then on gains are kept, and a tick costs a product with A.

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "mjdiag/plugin/plant/tangent.h"
#include "mjdiag/plugin/replay/filter_noise.h"

namespace mjdiag {

class ForceKalman {
 public:
  /// Readings further off count linearly (P. J. Huber, "Robust Estimation of a Location
  /// Parameter", Ann. Math. Statist. 35, 1964): beyond 4 standard deviations noise is seen
  /// once in 16,000 readings. With z = e / sqrt(S) such a reading has the variance
  /// S |z| / 4, so that it pulls as one at 4 standard deviations does, however far it is;
  /// with one that grows as z^2 the filter, and -2 ln L with it, would jump with its noise.
  static constexpr double kCorner = 4.0;

  /// @param dofs  those with a latent force
  ForceKalman(const std::vector<Eigen::Index>& dofs, const FilterNoise& noise,
              double sample_time);

  /// A record begins. @param sd  of the state
  void Start(const Eigen::VectorXd& sd);
  /// The tick that comes has that tangent.
  void MoveTo(const TickTangent& tangent);

  /// Takes a reading.
  /// @param sensor      which
  /// @param late        reads at the end of the tick, and the white force of it
  /// @param innovation  measured less read where the deviation is 0
  /// @param speed       of the reading
  /// @return its part of -2 ln L
  double Take(Eigen::Index sensor, bool late, double innovation, double speed);
  /// The same, with a weight that somebody else has decided: of that many times its
  /// variance.
  void TakeWeighted(Eigen::Index sensor, bool late, double innovation, double speed,
                    double inflation);
  /// To the next tick.
  void Advance();

  Eigen::VectorXd z;  ///< ns + nf + 1
  Eigen::MatrixXd P;
  /// Of the last reading that was taken.
  Eigen::VectorXd gain;
  double variance = 0.0;   ///< S, larger where the reading was cut
  double inflation = 1.0;  ///< by as much
  double last_innovation = 0.0;
  /// What it is of z: reading = c^T z + noise.
  const Eigen::VectorXd& c() const { return c_; }

  /// Of the latent forces, and of the clock behind them: nf + 1.
  const Eigen::VectorXd& rho() const { return rho_; }

 private:
  /// P is not what it was a tick ago: it makes up for what was taken with kept gains.
  void Unsettle();
  void Expect(Eigen::Index sensor, bool late, double innovation, double speed);
  void Correct(Eigen::Index sensor);

  std::vector<Eigen::Index> dofs_;
  const FilterNoise& noise_;
  Eigen::VectorXd rho_;
  Eigen::VectorXd variance_;  // stationary, of [w; t]
  Eigen::VectorXd white_;     // variances, nf
  Eigen::VectorXd renewal_;   // of it what is new in a tick
  const TickTangent* tangent_ = nullptr;
  Eigen::MatrixXd B_, D_;  // of the latent forces and of the clock, which has none
  Eigen::MatrixXd Q_;      // of the white forces, ns x ns
  Eigen::MatrixXd top_;
  Eigen::VectorXd c_, Pc_;
  double S_ = 0.0;
  double R_ = 0.0;
  bool known_ = false;  // its gain, from the tick before
  /// Whether P is what it was a tick ago, and the readings of a tick with their gains then.
  bool steady_ = false;
  bool moved_ = true;       // tangent, or what was read, since the last tick
  Eigen::VectorXd before_;  // diagonal of P
  std::vector<Eigen::Index> taken_, taken_before_;
  Eigen::MatrixXd gains_;
  Eigen::VectorXd variances_;
};

}  // namespace mjdiag
