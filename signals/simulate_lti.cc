#include "mjdiag/signals/simulate_lti.h"

#include <algorithm>
#include <string>
#include <utility>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;

/// result += matrix * vector, column by column: Eigen's own product may take temporary
/// memory from the heap.
void AddProduct(const Eigen::MatrixXd& matrix, const double* vector,
                Eigen::Ref<Eigen::VectorXd> result) noexcept {
  for (Index j = 0; j < matrix.cols(); ++j) result += vector[j] * matrix.col(j);
}

}  // namespace

LtiStepper::LtiStepper(StateSpace discrete) : system_(std::move(discrete)) {
  RequireShapes(system_);
  if (!(system_.sample_time > 0.0)) {
    throw InputError("simulation", "the system is continuous", "a discrete system");
  }
  state_ = Eigen::VectorXd::Zero(system_.states());
  next_ = state_;
}

void LtiStepper::Reset(std::span<const double> state) noexcept {
  std::copy_n(state.data(), state_.size(), state_.data());
}

void LtiStepper::Step(std::span<const double> input,
                      std::span<double> output) noexcept {
  Eigen::Map<Eigen::VectorXd> y(output.data(), system_.outputs());
  y.setZero();
  AddProduct(system_.C, state_.data(), y);
  AddProduct(system_.D, input.data(), y);
  next_.setZero();
  AddProduct(system_.A, state_.data(), next_);
  AddProduct(system_.B, input.data(), next_);
  state_.swap(next_);
}

Eigen::MatrixXd SimulateLti(const StateSpace& discrete, const Eigen::MatrixXd& inputs,
                            const Eigen::VectorXd& initial) {
  LtiStepper stepper(discrete);
  if (inputs.rows() != discrete.inputs()) {
    throw InputError("simulation", std::to_string(inputs.rows()) + " input signals",
                     std::to_string(discrete.inputs()));
  }
  if (initial.size() != 0 && initial.size() != discrete.states()) {
    throw InputError("simulation",
                     "an initial state of " + std::to_string(initial.size()),
                     std::to_string(discrete.states()) + " numbers");
  }
  if (initial.size() != 0) {
    stepper.Reset({initial.data(), static_cast<std::size_t>(initial.size())});
  }
  Eigen::MatrixXd outputs(discrete.outputs(), inputs.cols());
  for (Index k = 0; k < inputs.cols(); ++k) {
    stepper.Step({inputs.col(k).data(), static_cast<std::size_t>(inputs.rows())},
                 {outputs.col(k).data(), static_cast<std::size_t>(outputs.rows())});
    if (!outputs.col(k).allFinite()) {
      throw NumericalError("simulation: the output is not finite at sample " +
                           std::to_string(k));
    }
  }
  return outputs;
}

}  // namespace mjdiag
