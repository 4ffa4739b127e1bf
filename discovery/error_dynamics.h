#pragma once
// What an error of the model leaves in the innovations of an observer (observer.h), to
// first order along the observed motion. With the linear tick model, a generalised
// force f that the model lacks and an error d of the readings,
//
//   xt[k+1] = (A - L C) xt[k] + B_f f[k] - L d[k],     e[k] = C xt[k] + d[k] + noise
//
// f is held over a tick. Dry friction that the plant has makes A and B change with
// time: a joint that sticks at tick k keeps its place, takes no force and passes none
// on, so its velocity is struck from the equations of that tick. Everything that
// screening needs is linear in f and d; what it finds is fitted on the nonlinear plant
// afterwards.
//
// To be fast, the equations step over blocks of ticks, over which f and d are averaged;
// responses are block averages times the root of the block length, so that they compare
// with innovations that are averaged in the same way (Averaged) and white noise keeps
// its variance.

#include <Eigen/Core>
#include <vector>

#include "mjdiag/diagnosis/mechanical_model.h"
#include "mjdiag/discovery/observer.h"

namespace mjdiag {

/// Which joints stick at every sample, nq x samples of 0 and 1.
using Sticking = Eigen::Matrix<unsigned char, Eigen::Dynamic, Eigen::Dynamic>;

class ErrorDynamics {
 public:
  /// @param sticking  of every sample
  /// @param block     samples a block
  ErrorDynamics(const MechanicalModel& model, const Observer& observer, double step,
                int substeps, const Sticking& sticking, Eigen::Index block);

  /// Innovations divided by innovation_sd, ny x samples, stacked as one column per
  /// signal: (ny blocks) x signals, sensor index fastest.
  /// @param entry    generalised force per unit of each signal, nq x signals
  /// @param forces   samples x signals, at most as many samples as `sticking` has
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
  /// The equations while a certain set of joints sticks.
  struct Mode {
    Eigen::MatrixXd F;  // (A - L C)^block
    Eigen::MatrixXd B;  // of unit forces on every joint
    Eigen::MatrixXd L;  // of unit errors of every sensor
  };
  const Mode& At(Eigen::Index block) const {
    return modes_[mode_of_[static_cast<std::size_t>(block)]];
  }

  Eigen::MatrixXd SeenMean() const;

  std::vector<Mode> modes_;
  std::vector<std::size_t> mode_of_;  // of every block
  Eigen::Index block_;
  Eigen::MatrixXd C_;  // over innovation_sd
  Eigen::VectorXd weight_;
};

/// Averages of blocks of `block` samples times sqrt(block); columns are signals stacked
/// sample by sample with `channels` values each. What does not fill a block is left
/// out.
Eigen::MatrixXd Averaged(const Eigen::MatrixXd& stacked, Eigen::Index channels,
                         Eigen::Index block);

}  // namespace mjdiag
