#include "mjdiag/studies/visible_size.h"

#include "mjdiag/discovery/selection/model_choice.h"
#include "mjdiag/signals/decompositions.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

DiscoveryProblem PoseOwnMotion(const Machine& machine, const Excitation& motion,
                               std::uint64_t seed) {
  RunOptions noisy;
  noisy.seed = seed;
  DiscoveryProblem problem =
      PoseProblem(machine, Simulate(machine, motion, noisy), 1.0, 0.0);
  std::vector<DoubtedNumber> numbers;
  for (const PlantNumber& number : PlantNumbers(machine.plant())) {
    numbers.push_back({number, DoubtOf(machine.plant(), number)});
  }
  numbers.push_back(LatenessOf(machine));
  return problem.Doubting(std::move(numbers));
}

/// What of b is left beside the columns of R in any amount and those of J as far as
/// numbers may be off, with what that costs below.
VectorXd LeftOf(const VectorXd& b, const MatrixXd& J, const MatrixXd& R) {
  MatrixXd A = MatrixXd::Zero(J.rows() + J.cols(), J.cols() + R.cols());
  A.topLeftCorner(J.rows(), J.cols()) = J;
  A.bottomLeftCorner(J.cols(), J.cols()).setIdentity();
  A.topRightCorner(J.rows(), R.cols()) = R;
  VectorXd left = VectorXd::Zero(A.rows());
  left.head(b.size()) = b;
  left -= A * LeastSquares(A, left);
  return left;
}

}  // namespace

VisibleSize::VisibleSize(const Machine& machine, int substeps, const Excitation& motion,
                         std::uint64_t seed)
    : motion_(motion),
      problem_(PoseOwnMotion(machine, motion, seed)),
      observed_(problem_.MotionOf(problem_.Nominal())),
      numbers_(problem_.RoughNumberJacobian({}, {})) {
  const VectorXd left = LeftOf(Beside(machine.WithSubsteps(substeps)), numbers_,
                               MatrixXd(numbers_.rows(), 0))
                            .head(numbers_.rows());
  const double square = left.squaredNorm() / static_cast<double>(left.size());
  if (square < 1.0) return;
  inflation_ = Inflation(square, IndependentShare(problem_, left));
}

Scales VisibleSize::ScalesAt(const Site& site) const {
  const Machine& machine = problem_.machine();
  const SiteMotion at{machine.plant(), machine.linear(), observed_, site};
  return ScalesOf(at);
}

VectorXd VisibleSize::Innovations(const Cause& cause) const {
  return Beside(problem_.machine().With(ChangesOf({cause})));
}

VectorXd VisibleSize::Beside(const Machine& measured) const {
  RunOptions quiet;
  quiet.noise_scale = 0.0;
  const Record record = Simulate(measured, motion_, quiet);
  return problem_.WithRun(ToMeasuredRun(measured.setup(), record)).Residual({});
}

std::vector<double> VisibleSize::Shown(const std::vector<VectorXd>& innovations) const {
  std::vector<double> shown;
  for (std::size_t own = 0; own < innovations.size(); ++own) {
    MatrixXd others(numbers_.rows(), static_cast<Index>(innovations.size()) - 1);
    Index column = 0;
    for (std::size_t i = 0; i < innovations.size(); ++i) {
      if (i != own) others.col(column++) = innovations[i];
    }
    shown.push_back(LeftOf(innovations[own], numbers_, others).squaredNorm() /
                    inflation_);
  }
  return shown;
}

}  // namespace mjdiag
