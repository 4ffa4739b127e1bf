#include "mjdiag/diagnosis/twin/run_pass.h"

#include <algorithm>
#include <utility>

#include "mjdiag/diagnosis/twin/run_start.h"
#include "mjdiag/signals/decompositions.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// A block that is more surprising counts less, in inverse proportion: a joint came
/// loose a little sooner than the twin's.
constexpr double kRobustBlock = 4.0;

}  // namespace

RunPass::RunPass(std::unique_ptr<Twin> twin, const MatrixXd& outputs,
                 const MatrixXd& inputs, const MatrixXd& prior)
    : twin_(std::move(twin)),
      run_(outputs.rows(), inputs.rows(), outputs.cols()),
      prior_(prior),
      known_(CovarianceOf(prior)) {
  for (Index k = 0; k < outputs.cols(); ++k) {
    run_.Add({outputs.col(k).data(), static_cast<std::size_t>(outputs.rows())},
             {inputs.col(k).data(), static_cast<std::size_t>(inputs.rows())});
  }
  const Index n = twin_->unknowns() - twin_->start_unknowns();
  VectorXd theta = VectorXd::Zero(twin_->unknowns());
  RunStart start(twin_->outputs(), twin_->block(), twin_->unknowns());
  at_rest_ = run_.added() > twin_->block() &&
             start.BeganAtRest(*twin_, run_, theta, n, prior_);
  numbers_ = VectorXd::Zero(n);
  start_ = start_step_ = VectorXd::Zero(twin_->start_unknowns());
  start_by_numbers_ = MatrixXd::Zero(twin_->start_unknowns(), n);
}

std::size_t RunPass::Finest() const {
  return at_rest_ || twin_->start_unknowns() > 0
             ? 0
             : std::min<std::size_t>(1, twin_->gains().size() - 1);
}

void RunPass::Begin(const VectorXd& numbers, std::size_t gain) {
  VectorXd theta(twin_->unknowns());
  theta << numbers, VectorXd::Zero(twin_->start_unknowns());
  twin_->UseGain(gain);
  if (at_rest_) return twin_->Start(theta);
  VectorXd state(twin_->states());
  twin_->StateAt(run_.outputs(0), state);
  if (gain == 0 && twin_->start_unknowns() > 0) {
    // It goes with the numbers as the last pass said.
    start_ += start_step_ + start_by_numbers_ * (numbers - numbers_);
    theta.tail(start_.size()) = start_;
  }
  twin_->Start(theta, state);
}

RunInformation RunPass::About(const VectorXd& numbers, std::size_t gain) {
  const Index n = numbers.size();
  const Index block = twin_->block();
  const bool with_start = !at_rest_ && gain == 0;
  const bool settles = !at_rest_ && gain > 0;
  const Index from = settles ? twin_->gains().back().settling : 0;
  Begin(numbers, settles ? twin_->gains().size() - 1 : gain);
  numbers_ = numbers;

  const Index active = with_start ? twin_->unknowns() : n;
  Information information(twin_->unknowns(), twin_->outputs());
  VectorXd away = VectorXd::Zero(twin_->unknowns());
  away.head(n) = -numbers;
  if (with_start) away.tail(start_.size()) = -start_;
  information.Start(active, known_, away);
  std::size_t pull = settles ? twin_->gains().size() - 1 : gain;
  Index softer_at = from;
  const MatrixXd of_tick = twin_->gains()[gain].covariance;

  RunInformation said;
  Surprise surprise(twin_->outputs());
  VectorXd reading(twin_->outputs());
  VectorXd sum = VectorXd::Zero(twin_->outputs());
  said.innovations.resize(twin_->outputs(), run_.added());
  said.misfit = 0.0;
  Index blocks = 0;
  for (Index k = 0; k < run_.added(); ++k) {
    twin_->Predict(reading);
    said.innovations.col(k) = run_.outputs(k) - reading;
    sum += said.innovations.col(k);
    twin_->Step(run_.inputs(k), said.innovations.col(k));
    if ((k + 1) % block != 0) continue;
    const MatrixXd& psi = twin_->EndBlock();
    sum /= static_cast<double>(block);
    if (k >= from) {
      MatrixXd covariance =
          twin_->gains()[pull].covariance / static_cast<double>(block);
      const double squares = information.Surprise(psi, sum, covariance);
      surprise.Add(squares);
      said.worst_block = std::max(said.worst_block, squares);
      said.worst_stretch = std::max(said.worst_stretch, surprise.recent());
      said.misfit += squares;
      ++blocks;
      if (gain > 0) covariance *= std::max(1.0, squares / kRobustBlock);
      information.Add(psi, sum, covariance);
    }
    sum.setZero();
    if (pull > gain && k >= softer_at) {
      twin_->UseGain(--pull);
      softer_at = k + twin_->gains()[pull].settling;
    }
  }
  said.misfit /= static_cast<double>(std::max<Index>(1, blocks));
  said.innovations =
      said.innovations.rightCols(std::max<Index>(0, run_.added() - from)).eval();
  Reduce(information, said);
  return said;
}

void RunPass::Reduce(const Information& information, RunInformation& said) {
  const Index n = numbers_.size();
  const Index s = information.active() - n;
  said.H = information.H().topLeftCorner(n, n) - known_.topLeftCorner(n, n);
  said.g = information.g().head(n) + known_.topLeftCorner(n, n) * numbers_;
  if (s == 0) return;
  const MatrixXd across = information.H().topRightCorner(n, s);
  const MatrixXd own = information.H().block(n, n, s, s);
  start_by_numbers_ = -Solve(own, MatrixXd(across.transpose()));
  start_step_ = Solve(own, MatrixXd(information.g().segment(n, s)));
  said.H += across * start_by_numbers_;
  said.g += start_by_numbers_.transpose() * information.g().segment(n, s);
}

}  // namespace mjdiag
