#pragma once
// Runs a discrete linear system x[k+1] = A x[k] + B u[k], y[k] = C x[k] + D u[k]: over
// whole signals, or one step at a time inside a control callback.

#include <Eigen/Core>
#include <span>

#include "mjdiag/signals/state_space.h"

namespace mjdiag {

/// One step at a time. Step and Reset do not allocate, lock or throw.
class LtiStepper {
 public:
  /// Starts at x[0] = 0. InputError if the system is not discrete or its shapes do not
  /// fit.
  explicit LtiStepper(StateSpace discrete);

  const StateSpace& system() const { return system_; }
  const Eigen::VectorXd& state() const { return state_; }
  /// Back to x[0] = 0.
  void Reset() noexcept { state_.setZero(); }
  /// Back to that state, n numbers.
  void Reset(std::span<const double> state) noexcept;
  /// y[k] from u[k], and on to x[k+1].
  /// @param input   m numbers
  /// @param output  p numbers, written; may not overlap the input
  void Step(std::span<const double> input, std::span<double> output) noexcept;

 private:
  StateSpace system_;
  Eigen::VectorXd state_;
  Eigen::VectorXd next_;
};

/// The response to whole signals.
/// @param discrete  n states, m inputs, p outputs
/// @param inputs    m x N, one column a sample
/// @param initial   x[0], n; empty: 0
/// @return outputs, p x N
/// InputError if the shapes do not fit; NumericalError with the sample at which an
/// output is not finite.
Eigen::MatrixXd SimulateLti(const StateSpace& discrete, const Eigen::MatrixXd& inputs,
                            const Eigen::VectorXd& initial = {});

}  // namespace mjdiag
