#include "mjdiag/studies/visible_size.h"

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
  return problem.Doubting(std::move(numbers));
}

}  // namespace

VisibleSize::VisibleSize(const Machine& machine, const Excitation& motion,
                         std::uint64_t seed)
    : motion_(motion),
      problem_(PoseOwnMotion(machine, motion, seed)),
      observed_(problem_.MotionOf(problem_.Nominal())),
      numbers_(problem_.RoughNumberJacobian({}, {})) {}

Scales VisibleSize::ScalesAt(const Site& site) const {
  const Machine& machine = problem_.machine();
  const SiteMotion at{machine.plant(), machine.linear(), observed_, site};
  return ScalesOf(at);
}

VectorXd VisibleSize::Innovations(const Cause& cause) const {
  const Machine& machine = problem_.machine();
  RunOptions quiet;
  quiet.noise_scale = 0.0;
  const Record record = Simulate(machine.With(ChangesOf({cause})), motion_, quiet);
  return problem_.WithRun(ToMeasuredRun(machine.setup(), record)).Residual({});
}

std::vector<double> VisibleSize::Shown(const std::vector<VectorXd>& innovations) const {
  const Index rows = numbers_.rows();
  const Index numbers = numbers_.cols();
  const Index others = static_cast<Index>(innovations.size()) - 1;
  std::vector<double> shown;
  for (std::size_t own = 0; own < innovations.size(); ++own) {
    MatrixXd A = MatrixXd::Zero(rows + numbers, numbers + others);
    A.topLeftCorner(rows, numbers) = numbers_;
    A.bottomLeftCorner(numbers, numbers).setIdentity();
    Index column = numbers;
    for (std::size_t i = 0; i < innovations.size(); ++i) {
      if (i != own) A.col(column++).head(rows) = innovations[i];
    }
    VectorXd b = VectorXd::Zero(rows + numbers);
    b.head(rows) = innovations[own];
    shown.push_back((b - A * LeastSquares(A, b)).squaredNorm());
  }
  return shown;
}

}  // namespace mjdiag
