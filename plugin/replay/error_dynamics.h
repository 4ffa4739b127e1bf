#pragma once
// What an error of the model leaves in the innovations of an observer (observer.h), to
// first order along the observed motion. With a generalised force f that the model
// lacks and an error d of the readings,
//
//   xt[k+1] = (A_k - L C) xt[k] + B_k f[k] - L d[k],     e[k] = C xt[k] + d[k] + noise
//
// f is held over a tick. A_k and B_k are the first order of the nonlinear tick where the run
// is (tangent.h).
//
// To be fast, the equations step over blocks of ticks, over which f and d are averaged;
// responses are block averages times the root of the block length, so that they compare
// with innovations that are averaged in the same way (Averaged) and white noise keeps
// its variance.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/plugin/plant/tangent.h"
#include "mjdiag/plugin/replay/observer.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {

class ErrorDynamics {
 public:
  /// @param block  samples a block
  ErrorDynamics(const Observer& observer, Eigen::Index block);

  /// Another record: what comes has nothing to do with what was.
  void Begin();
  /// The next tick of the run.
  /// @param measured  which sensors were, ny; empty: all. The others do not pull
  /// @param counted   which of them show anything; empty: as `measured`
  void Add(const TickTangent& tick, const SampleMask& measured = {},
           const SampleMask& counted = {});
  /// Whole blocks so far.
  Eigen::Index blocks() const { return static_cast<Eigen::Index>(blocks_.size()); }

  /// Innovations divided by innovation_sd, ny x samples, stacked as one column per
  /// signal: (ny blocks) x signals, sensor index fastest.
  /// @param entry    generalised force per unit of each signal, nq x signals
  /// @param forces   samples x signals, at most as many samples as ticks were added
  Eigen::MatrixXd OfForces(const Eigen::MatrixXd& entry,
                           const Eigen::MatrixXd& forces) const;
  /// The same of errors of one sensor. @param errors  samples x signals
  Eigen::MatrixXd OfReadings(Eigen::Index sensor, const Eigen::MatrixXd& errors) const;
  /// The adjoint: what a force at every joint, or an error of every reading, would
  /// have in common with scaled innovations. With H f = OfForces, H^T e.
  struct Adjoint {
    Eigen::MatrixXd forces;    ///< blocks x nq
    Eigen::MatrixXd readings;  ///< blocks x ny
  };
  Adjoint AdjointOf(const Eigen::VectorXd& innovations) const;
  Eigen::Index block() const { return block_; }
  /// 1 / innovation_sd
  const Eigen::VectorXd& weight() const { return weight_; }

 private:
  struct Block {
    Eigen::MatrixXd F;  // product of A_k - L C
    Eigen::MatrixXd B;  // of unit forces on every joint
    Eigen::MatrixXd L;  // of unit errors of every sensor
    /// Share of its ticks in which a sensor shows something, ny; empty: all of them.
    Eigen::VectorXd seen{};
  };
  /// drive(x', k) adds what drives block k, seen(y, k) what the readings show of it
  /// beside the states.
  template <typename Drive, typename Seen>
  Eigen::MatrixXd Respond(Eigen::Index blocks, Eigen::Index signals, const Drive& drive,
                          const Seen& seen) const;
  /// What a block shows of the sum of the states at its ends.
  Eigen::MatrixXd SeenMean() const;
  void Add(const Eigen::MatrixXd& F, const Eigen::MatrixXd& B,
           const Eigen::MatrixXd& L);
  /// Takes sensors that do not count at this tick out of the open block.
  void Miss(const SampleMask& counted);

  std::vector<Block> blocks_;
  Block open_;  // not yet whole
  Eigen::Index in_open_ = 0;
  Eigen::Index block_;
  Observer observer_;
  Eigen::MatrixXd C_;  // over innovation_sd
  Eigen::MatrixXd LC_;
  Eigen::VectorXd weight_;
};

/// Averages of blocks of `block` samples times sqrt(block); columns are signals stacked
/// sample by sample with `channels` values each. What does not fill a block is left
/// out.
Eigen::MatrixXd Averaged(const Eigen::MatrixXd& stacked, Eigen::Index channels,
                         Eigen::Index block);

}  // namespace mjdiag
