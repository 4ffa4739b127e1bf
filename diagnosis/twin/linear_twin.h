#pragma once
// The twin of a linear machine,
//
//   M q'' + D(theta) q' + K(theta) q = Gamma(theta) (u + w),   y = b^T q + rest
//
// on the exact map of a control tick (TickModel), with unknown tones w in the commands:
// D, K and Gamma are affine in the values of the unknowns. Its state and sensitivities
// are those of that map; a tick's force of an unknown is taken with the mean velocity
// and position of the tick.
//
// Sensitivities go a block of d ticks at a time. With F = A - L C and forces
// B E s[j], E the directions of the levers and s their signals,
//
//   S[k+d] = F^d S[k] + sum_j F^(d-1-j) B E s[k+j]
//   d mean(yp) = (1/d) sum_j C F^j S[k] + (1/d) sum_j sum_(i>j) C F^(i-1-j) B E s[k+j]

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <span>
#include <vector>

#include "mjdiag/diagnosis/model/delta_form.h"
#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "mjdiag/diagnosis/twin/lever.h"
#include "mjdiag/diagnosis/twin/twin.h"

namespace mjdiag {

/// What a unit of an unknown's value adds to the model; empty matrices: nothing.
struct ModelSlope {
  Eigen::MatrixXd D;      ///< nq x nq
  Eigen::MatrixXd K;      ///< nq x nq
  Eigen::MatrixXd Gamma;  ///< nq x nu
};

/// amplitude * (s sin(2 pi f t) + c cos(2 pi f t)) on the commands, s and c unknown.
struct UnknownTone {
  double frequency = 0.0;     ///< [Hz]
  Eigen::VectorXd amplitude;  ///< nu, of each command
};

/// A linear machine and what is not known of it.
struct UncertainModel {
  MechanicalModel nominal;
  TickTiming timing;
  Eigen::VectorXd rest;  ///< readings at rest, ny
  /// Of the model, two of each tone, and those of the state at the start.
  std::vector<Unknown> unknowns;
  std::vector<ModelSlope> slopes;  ///< of the unknowns of the model
  std::vector<UnknownTone> tones;
  Eigen::MatrixXd start;  ///< deviation from rest of a unit of each, 2 nq x n
};

/// Deviations from rest that any motion of that energy E [J] may have left, columns of
/// a root of their covariance: velocities E M^-1, positions E (K + M w^2)^-1 with a
/// frequency w far below those of the machine, for what nothing holds.
/// Coordinates of least elastic energy that give a unit of each reading, nq x ny.
Eigen::MatrixXd PlacementOf(const MechanicalModel& model);

Eigen::MatrixXd StartDirections(const MechanicalModel& model, double energy);

class LinearTwin final : public Twin {
 public:
  /// @param gain   L, 2 nq x ny
  /// @param block  d
  LinearTwin(const UncertainModel& model, const Eigen::MatrixXd& gain,
             Eigen::Index block);

  Eigen::Index outputs() const override { return C_.rows(); }
  Eigen::Index inputs() const override { return u_.size(); }
  Eigen::Index unknowns() const override { return theta_.size(); }
  Eigen::Index start_unknowns() const override { return start_directions_.cols(); }
  Eigen::Index block() const override { return block_; }

  void Start(const Eigen::VectorXd& theta, bool at_rest) noexcept override;
  void Place(const Eigen::VectorXd& reading) noexcept override;
  void Remember() noexcept override;
  void Predict(Eigen::VectorXd& reading) noexcept override;
  void Step(std::span<const double> inputs,
            const Eigen::VectorXd& innovation) noexcept override;
  const Eigen::MatrixXd& EndBlock() noexcept override;
  void Shift(const Eigen::VectorXd& change) noexcept override;

 private:
  void MakeMaps() noexcept;
  double Value(Eigen::Index unknown) const;

  UncertainModel model_;
  Eigen::MatrixXd L_;
  Eigen::Index block_;
  Eigen::MatrixXd C_;     // ny x 2 nq
  Eigen::MatrixXd mean_;  // C / d
  LeverArms arms_;
  Eigen::MatrixXd place_;             // of coordinates by readings, nq x ny
  Eigen::VectorXd remembered_;        // deviation from rest, 2 nq
  Eigen::MatrixXd start_directions_;  // of the state, by a standard deviation
  Eigen::Index active_ = 0;           // columns of S that are in use
  Eigen::VectorXd theta_;
  Eigen::VectorXd slope_;  // d value / d theta

  // Maps at theta_.
  Eigen::MatrixXd M_, D_, K_, Gamma_, left_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::MatrixXd A_;                     // of a tick
  Eigen::MatrixXd B_;                     // of the commands
  Eigen::MatrixXd force_;                 // of forces on every coordinate
  Eigen::MatrixXd F_, power_, scratch_;   // A - L C, F^d
  std::vector<Eigen::MatrixXd> carried_;  // F^(d-1-j) B E
  Eigen::MatrixXd seen_;                  // (1/d) sum_j C F^j
  std::vector<Eigen::MatrixXd> seen_of_;  // of the forces of tick j

  // The run.
  Eigen::Index in_block_ = 0;
  Eigen::VectorXd x_, next_, u_;
  Eigen::VectorXd phase_;  // sine and cosine of every tone now
  Eigen::VectorXd turn_;   // of a tick
  Eigen::MatrixXd S_, S_next_, S_drive_;
  Eigen::MatrixXd seen_drive_, sensitivity_;
};

}  // namespace mjdiag
