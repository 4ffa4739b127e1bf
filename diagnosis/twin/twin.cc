#include "mjdiag/diagnosis/twin/twin.h"

#include <utility>

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

std::vector<Index> DriftingOf(const std::vector<Unknown>& unknowns) {
  std::vector<Index> drifting;
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    if (!unknowns[i].wears || !(unknowns[i].reach > 0.0)) continue;
    drifting.push_back(static_cast<Index>(i));
  }
  return drifting;
}

Twin::Twin(const TwinShape& shape, std::vector<TwinGain> gains,
           std::vector<UnknownTone> tones, double sample_time,
           std::vector<Index> drifting)
    : theta_(VectorXd::Zero(shape.unknowns)),
      tones_(std::move(tones), sample_time),
      u_(VectorXd::Zero(shape.inputs)),
      x_(VectorXd::Zero(shape.states)),
      S_(Eigen::MatrixXd::Zero(shape.states, shape.unknowns)),
      drifting_(std::move(drifting)),
      S_rate_(
          Eigen::MatrixXd::Zero(shape.states, static_cast<Index>(drifting_.size()))),
      drift_(Eigen::MatrixXd::Zero(shape.outputs * shape.block, S_rate_.cols())),
      sample_time_(sample_time),
      shape_(shape),
      gains_(std::move(gains)) {}

double Twin::Logarithm(const std::vector<Index>& factors) const noexcept {
  double sum = 0.0;
  for (const Index factor : factors) sum += theta_[factor];
  return sum;
}

void Twin::Begin(const VectorXd& theta, bool at_rest, Index tick) noexcept {
  theta_ = theta;
  acting_ = unknowns() - (at_rest ? start_unknowns() : 0);
  tones_.Start(tick);
  S_rate_.setZero();
  drift_.setZero();
  drift_time_ = 0.0;
}

void Twin::Place(const TwinState& state, const Eigen::MatrixXd& directions) noexcept {
  const Index machine = unknowns() - start_unknowns();
  x_ = state.x;
  // What is unknown of this start has no part in that of the other run.
  for (Index i = 0; i < machine; ++i) {
    x_ += (theta_[i] - state.theta[i]) * state.S.col(i);
  }
  x_.noalias() += directions * theta_.tail(start_unknowns());
  S_.leftCols(machine) = state.S.leftCols(machine);
  S_.rightCols(start_unknowns()) = directions;
}

void Twin::Command(std::span<const double> inputs) noexcept {
  u_ = VectorXd::Map(inputs.data(), u_.size());
  tones_.AddTo(u_, theta_.segment(first_tone(), 2 * tones_.count()));
}

}  // namespace mjdiag
