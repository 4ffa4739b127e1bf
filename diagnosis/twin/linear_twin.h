#pragma once
// The twin of a linear machine,
//
//   M q'' + D q' + K q = Gamma (u + w) + f,   y = b^T q + rest
//
// on the exact map of a control tick (TickModel), with unknown tones w in the commands.
// M, D, K, Gamma and f are affine in numbers of the machine, each of them a product of
// unknown factors. The derivative of a step of h, v' = v + h a, is exact too:
//
//   (M + h D) dv' = M dv - h K dq + h (dGamma u + df - dM a - dD v' - dK q)
//
// so that a number of the machine is a force of the acceleration, the velocity at the end
// and the position at the start of every step.
//
// Sensitivities go a block of d ticks of n steps at a time. With F = A - L C of a tick,
// P_s the response at the end of a tick to a force in its step s, and forces f of a unit
// of a number,
//
//   S[k+d] = F^d S[k] + sum_j sum_s F^(d-1-j) P_s f[k+j, s]
//   d yp[k+i] = C F^i S[k] + sum_(j<i) sum_s C F^(i-1-j) P_s f[k+j, s]

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <span>
#include <vector>

#include "mjdiag/diagnosis/model/delta_form.h"
#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "mjdiag/diagnosis/twin/model_part.h"
#include "mjdiag/diagnosis/twin/moved_rest.h"
#include "mjdiag/diagnosis/twin/twin.h"
#include "mjdiag/signals/wide_product.h"

namespace mjdiag {

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
  void Start(const Eigen::VectorXd& theta, const TwinState& state,
             Eigen::Index tick) noexcept override;
  void StateAt(const Eigen::VectorXd& reading, TwinState& state) noexcept override;
  void Predict(Eigen::VectorXd& reading) noexcept override;
  void Step(std::span<const double> inputs,
            const Eigen::VectorXd& innovation) noexcept override;
  const Eigen::MatrixXd& EndBlock() noexcept override;
  void Shift(const Eigen::VectorXd& change) noexcept override;
  void Drifted(const Eigen::VectorXd& rates) noexcept override;

 private:
  /// One entry of M, D or K of a number: a force on a coordinate, proportional to what
  /// another one does.
  enum class Motion { kAcceleration, kVelocity, kPosition };
  struct Entry {
    Eigen::Index number;
    Eigen::Index on;
    Motion motion;
    Eigen::Index of;
    double coefficient;
  };
  /// Entries of a number on one coordinate.
  struct Moving {
    std::size_t first, end;  ///< of entries_
  };
  /// A direction in which a unit of a number, or of a tone, pushes all through a tick,
  /// times a command or, without one, for itself.
  struct Held {
    Eigen::Index column;  ///< of block_
    Eigen::VectorXd direction;
    Eigen::Index input;
  };
  static constexpr Eigen::Index kNoInput = -1;

  /// Rows of the readings of a block.
  Eigen::Index seen() const { return outputs() * block(); }
  void AddEntries(Eigen::Index number, Motion motion, const Eigen::MatrixXd& part);
  void AddSources();
  void AddTerms();
  void Reset() noexcept;
  void MakeMaps() noexcept;
  void MakeStep() noexcept;
  void MakeTick() noexcept;
  /// Forces of units in the step between those states, as rows of the map of a tick.
  void MakeMoving(Eigen::Index row, const Eigen::MatrixXd& before,
                  const Eigen::MatrixXd& after) noexcept;
  void LiftSensitivities() noexcept;
  void LiftDrift() noexcept;
  /// What the forces of this tick leave in the block.
  void Push() noexcept;

  UncertainModel model_;
  Eigen::MatrixXd C_;       // ny x 2 nq
  Eigen::MatrixXd place_;   // of coordinates by readings, nq x ny
  Eigen::VectorXd values_;  // of the numbers

  MovedRest moved_rest_;
  std::vector<Entry> entries_;  // of a Moving in a row
  // What pushes in a tick, in the order of sources: what moves, step by step, what the
  // tick holds, then the tones.
  std::vector<Moving> moving_;
  std::vector<Held> held_, tone_held_;

  // Maps at theta_.
  Eigen::MatrixXd M_, D_, K_, Gamma_, left_side_;
  Eigen::VectorXd f_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::MatrixXd A_step_, B_step_;  // of a step, less the identity; of the commands
  Eigen::MatrixXd pulse_step_;       // of forces on every coordinate
  Eigen::VectorXd constant_;         // of f, a step
  // Of [x; u; 1] at the start of a tick: how far x has moved before a step and after it;
  // how far in the tick, above the forces of what moves.
  Eigen::MatrixXd before_, after_, tick_;       // tick_ in whole registers
  Eigen::MatrixXd F_, power_, base_, scratch_;  // A - L C, F^d
  Eigen::MatrixXd carry_;                // all C F^i above F^d, in whole registers
  Eigen::VectorXd carried_;              // carry_ times a column
  std::vector<Eigen::MatrixXd> pulses_;  // P_s
  Eigen::MatrixXd pulse_;                // their sum
  Eigen::MatrixXd sources_;              // what a unit of each leaves in its tick
  /// In a tick j of a block: what later ticks see of it, 0 or C F^(i-1-j) P, above what it
  /// leaves at the end, F^(d-1-j) P, (ny d + 2 nq, in whole registers) x sources.
  std::vector<Eigen::MatrixXd> left_;

  // The run.
  Eigen::Index in_block_ = 0;
  Eigen::VectorXd start_, end_;  // of a tick: [x; u; 1], tick_ of it
  /// What a unit of every number, and tone, has left in a block: in its readings, and below
  /// that at its end.
  Eigen::MatrixXd block_;
  /// How strong every source is in a tick, those of tones by their sines and cosines, and
  /// which columns of left_ these are times of, and of block_ they go to.
  Eigen::VectorXd weights_;
  std::vector<WideTerm> terms_;
  Eigen::MatrixXd S_next_, sensitivity_;
  Eigen::MatrixXd S_rate_next_;
};

}  // namespace mjdiag
