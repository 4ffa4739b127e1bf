#pragma once
// The twin of a linear machine,
//
//   M q'' + D q' + K q = Gamma (u + w) + f,   y = b^T q + rest
//
// on the exact map of a control tick (TickModel), with unknown tones w in the commands.
// M, D, K, Gamma and f are affine in numbers of the machine, each of them a product of
// unknown factors. State and sensitivities are those of that map; a tick's force of an
// unknown is taken with the mean acceleration, velocity and position of the tick.
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

/// What a number of the machine adds to the model where it is what it should be; empty
/// matrices: nothing.
struct ModelPart {
  Eigen::MatrixXd M;      ///< nq x nq
  Eigen::MatrixXd D;      ///< nq x nq
  Eigen::MatrixXd K;      ///< nq x nq
  Eigen::MatrixXd Gamma;  ///< nq x nu
  Eigen::VectorXd force;  ///< nq, beyond what holds the machine at its nominal rest
  /// Its unknown factors.
  std::vector<Eigen::Index> factors;
};

/// A linear machine and what is not known of it.
struct UncertainModel {
  MechanicalModel nominal;
  TickTiming timing;
  Eigen::VectorXd rest;  ///< readings at rest, ny
  /// Factors, two of each tone, and those of the state at the start.
  std::vector<Unknown> unknowns;
  std::vector<ModelPart> parts;
  std::vector<UnknownTone> tones;
  Eigen::MatrixXd start;  ///< deviation from rest of a unit of each, 2 nq x n
};

/// Coordinates of least elastic energy that give a unit of each reading, nq x ny.
Eigen::MatrixXd PlacementOf(const MechanicalModel& model);

/// Deviations from rest that any motion of that energy E [J] may have left, columns of
/// a root of their covariance: velocities E M^-1, positions E (K + M w^2)^-1 with a
/// frequency w far below those of the machine, for what nothing holds.
Eigen::MatrixXd StartDirections(const MechanicalModel& model, double energy);

class LinearTwin final : public Twin {
 public:
  /// @param gains  at least one, L of 2 nq x ny
  /// @param block  d
  LinearTwin(const UncertainModel& model, std::vector<TwinGain> gains,
             Eigen::Index block);

  void UseGain(std::size_t gain) noexcept override;
  void Start(const Eigen::VectorXd& theta) noexcept override;
  void Start(const Eigen::VectorXd& theta,
             const Eigen::VectorXd& state) noexcept override;
  void StateAt(const Eigen::VectorXd& reading,
               Eigen::VectorXd& state) noexcept override;
  void ReadState(Eigen::VectorXd& state) const noexcept override { state = x_; }
  void Predict(Eigen::VectorXd& reading) noexcept override;
  void Step(std::span<const double> inputs,
            const Eigen::VectorXd& innovation) noexcept override;
  const Eigen::MatrixXd& EndBlock() noexcept override;
  void Shift(const Eigen::VectorXd& change) noexcept override;

 private:
  void Reset() noexcept;
  void MakeMaps() noexcept;
  void LiftSensitivities() noexcept;
  double Signal(const Lever& lever) const noexcept;

  UncertainModel model_;
  Eigen::MatrixXd C_;     // ny x 2 nq
  Eigen::MatrixXd mean_;  // C / d
  LeverArms arms_;
  Eigen::MatrixXd place_;   // of coordinates by readings, nq x ny
  Eigen::VectorXd values_;  // of the numbers

  // Maps at theta_.
  Eigen::MatrixXd M_, D_, K_, Gamma_, left_;
  Eigen::VectorXd f_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::MatrixXd A_;                     // of a tick
  Eigen::MatrixXd B_;                     // of the commands
  Eigen::MatrixXd force_;                 // of forces on every coordinate
  Eigen::VectorXd constant_;              // of f
  Eigen::MatrixXd F_, power_, scratch_;   // A - L C, F^d
  std::vector<Eigen::MatrixXd> carried_;  // F^(d-1-j) B E
  Eigen::MatrixXd seen_;                  // (1/d) sum_j C F^j
  std::vector<Eigen::MatrixXd> seen_of_;  // of the forces of tick j

  // The run.
  Eigen::Index in_block_ = 0;
  Eigen::VectorXd x_, next_;
  Eigen::MatrixXd S_, S_next_, S_drive_;
  Eigen::MatrixXd seen_drive_, sensitivity_;
};

}  // namespace mjdiag
