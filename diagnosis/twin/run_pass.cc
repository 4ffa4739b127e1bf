#include "mjdiag/diagnosis/twin/run_pass.h"

#include <algorithm>
#include <utility>

#include "mjdiag/diagnosis/twin/run_start.h"
#include "mjdiag/signals/decompositions.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

RunPass::RunPass(std::unique_ptr<Twin> twin, const MatrixXd& outputs,
                 const MatrixXd& inputs, const MatrixXd& prior)
    : pass_(std::move(twin)),
      run_(outputs.rows(), inputs.rows(), outputs.cols()),
      known_(CovarianceOf(prior)) {
  for (Index k = 0; k < outputs.cols(); ++k) {
    run_.Add({outputs.col(k).data(), static_cast<std::size_t>(outputs.rows())},
             {inputs.col(k).data(), static_cast<std::size_t>(inputs.rows())});
  }
  Twin& of_run = pass_.twin();
  const Index n = of_run.unknowns() - of_run.start_unknowns();
  start_.state = start_.settling = of_run.MakeState();
  measured_ = start_;
  VectorXd theta = VectorXd::Zero(of_run.unknowns());
  RunStart start(of_run.outputs(), of_run.block(), of_run.unknowns());
  if (run_.added() <= of_run.block() ||
      !start.BeganAtRest(of_run, run_, theta, of_run.first_tone(), prior)) {
    pass_.StartSettling(run_, 0, start_);
    pass_.StartMeasured(run_, 0, measured_);
  }
  numbers_ = VectorXd::Zero(n);
  start_theta_ = start_step_ = VectorXd::Zero(of_run.start_unknowns());
  start_by_numbers_ = MatrixXd::Zero(of_run.start_unknowns(), n);
}

RunInformation RunPass::About(const VectorXd& numbers, std::size_t gain) {
  const bool measured = !at_rest() && gain == 0 && pass_.twin().linear();
  PassStart& start = measured ? measured_ : start_;
  VectorXd theta = VectorXd::Zero(pass_.twin().unknowns());
  theta.head(numbers.size()) = numbers;
  if (!at_rest() && gain == 0 && start.known) {
    // The start goes with the numbers as the last pass said.
    start_theta_ += start_step_ + start_by_numbers_ * (numbers - numbers_);
    theta.tail(start_theta_.size()) = start_theta_;
  } else {
    start_theta_.setZero();
  }
  numbers_ = numbers;
  pass_.Begin(start, theta, gain, known_, VectorXd::Zero(theta.size()));
  RunInformation said;
  said.innovations.resize(run_.outputs(0).size(), run_.added());
  const Index n = numbers.size();
  const Index part = (run_.added() - start.origin) / kRunParts;
  MatrixXd H_before = known_.topLeftCorner(n, n);
  VectorXd g_before = -H_before * numbers;
  Index counted = 0;
  while (pass_.seen() < run_.added()) {
    const bool counts = pass_.seen() >= start.origin;
    pass_.Step(run_);
    if (!counts) continue;
    said.innovations.col(counted) =
        run_.outputs(pass_.seen() - 1)
            .array()
            .isNaN()
            .select(run_.outputs(pass_.seen() - 1), pass_.innovation());
    ++counted;
    if (part == 0 || counted % part != 0) continue;
    const Information& all = pass_.information();
    said.parts.push_back(
        {all.H().topLeftCorner(n, n) - H_before, all.g().head(n) - g_before});
    H_before += said.parts.back().H;
    g_before += said.parts.back().g;
  }
  said.innovations.conservativeResize(Eigen::NoChange, counted);
  said.nis = pass_.nis();
  said.excess = std::max(said.excess, pass_.excess());
  Reduce(said);
  return said;
}

void RunPass::Reduce(RunInformation& said) {
  const Information& information = pass_.information();
  const Index n = numbers_.size();
  const Index s = information.active() - n;
  said.H = information.H().topLeftCorner(n, n) - known_.topLeftCorner(n, n);
  said.g = information.g().head(n) + known_.topLeftCorner(n, n) * numbers_;
  start_step_.setZero();
  start_by_numbers_.setZero();
  if (s == 0) return;
  const MatrixXd across = information.H().topRightCorner(n, s);
  const MatrixXd own = information.H().block(n, n, s, s);
  start_by_numbers_ = -Solve(own, MatrixXd(across.transpose()));
  start_step_ = Solve(own, MatrixXd(information.g().segment(n, s)));
  said.H += across * start_by_numbers_;
  said.g += start_by_numbers_.transpose() * information.g().segment(n, s);
}

}  // namespace mjdiag
