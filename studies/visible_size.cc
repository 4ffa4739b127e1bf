#include "mjdiag/studies/visible_size.h"

#include <algorithm>
#include <limits>

#include "mjdiag/discovery/fitting/cause_fit.h"
#include "mjdiag/discovery/screening/screening.h"
#include "mjdiag/discovery/selection/model_choice.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

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
  return problem.Doubting(DoubtsOf(machine));
}

/// What numbers, and others in any amount, leave of innovations.
struct Explained {
  VectorXd z;
  VectorXd left;  ///< of the innovations
  double square() const { return left.squaredNorm() + z.squaredNorm(); }
};

/// min over z, a of |r - J z - R a|^2 + |z|^2 by Gauss and Newton with one J: numbers that
/// are far off do not act in proportion.
Explained Explain(const DiscoveryProblem& problem, const MatrixXd& J,
                  const MatrixXd& R) {
  constexpr int kSteps = 3;
  MatrixXd A = MatrixXd::Zero(J.rows() + J.cols(), J.cols() + R.cols());
  A.topLeftCorner(J.rows(), J.cols()) = J;
  A.bottomLeftCorner(J.cols(), J.cols()).setIdentity();
  A.topRightCorner(J.rows(), R.cols()) = R;
  VectorXd b = VectorXd::Zero(A.rows());
  const auto solve = [&](const VectorXd& r, const VectorXd& z) {
    b << r, z;
    return VectorXd(LeastSquares(A, b));
  };
  VectorXd z = VectorXd::Zero(J.cols());
  VectorXd r = problem.Residual({});
  VectorXd step = solve(r, z);
  // To first order: what the numbers make up for by themselves counts.
  Explained best{-step.head(J.cols()), r - A.topRows(J.rows()) * step};
  double last = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kSteps; ++i) {
    z -= step.head(J.cols());
    z = z.cwiseMax(-kFarthestNumber).cwiseMin(kFarthestNumber);
    try {
      r = problem.Residual(problem.WithNumbers({}, z));
    } catch (const NumericalError&) {
      break;
    }
    step = solve(r, z);
    const Explained now{z, r - R * step.tail(R.cols())};
    if (!(now.square() < last)) break;
    last = now.square();
    if (last < best.square()) best = now;
  }
  return best;
}

}  // namespace

VisibleSize::VisibleSize(const Machine& machine, int substeps, const Excitation& motion,
                         std::uint64_t seed)
    : motion_(motion),
      problem_(PoseOwnMotion(machine, motion, seed)),
      observed_(problem_.MotionOf(problem_.Nominal())),
      numbers_(problem_.RoughNumberJacobian({}, {})) {
  const DiscoveryProblem finer = WithQuietRunOf(machine.WithSubsteps(substeps));
  const VectorXd left = Explain(finer, numbers_, NoOthers()).left;
  const double square = left.squaredNorm() / static_cast<double>(left.size());
  if (square < 1.0) return;
  inflation_ = Inflation(square, IndependentShare(problem_, left));
}

Scales VisibleSize::ScalesAt(const Site& site) const {
  const Machine& machine = problem_.machine();
  const SiteMotion at{machine.plant(), machine.linear(), observed_, site};
  return ScalesOf(at);
}

DiscoveryProblem VisibleSize::WithQuietRunOf(const Machine& measured) const {
  RunOptions quiet;
  quiet.noise_scale = 0.0;
  const Record record = Simulate(measured, motion_, quiet);
  return problem_.WithRun(ToMeasuredRun(measured.setup(), record));
}

VectorXd VisibleSize::Innovations(const Cause& cause) const {
  return WithQuietRunOf(problem_.machine().With(ChangesOf({cause}))).Residual({});
}

double VisibleSize::Shown(const Cause& cause, const MatrixXd& beside) const {
  const Machine changed = problem_.machine().With(ChangesOf({cause}));
  return Explain(WithQuietRunOf(changed), numbers_, beside).square() / inflation_;
}

double VisibleSize::ShownBesideSimplerLaw(const Cause& cause) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto simpler = cause.effect->Simpler(cause);
  if (!simpler) return kInfinity;
  const Machine& machine = problem_.machine();
  const std::vector<Candidate> candidates = AllSites(machine);
  const auto law = std::ranges::find_if(candidates, [&](const Candidate& candidate) {
    return SameKind({candidate.effect, candidate.site, {}}, *simpler);
  });
  if (law == candidates.end()) return kInfinity;
  const auto place = static_cast<std::size_t>(law - candidates.begin());
  const DiscoveryProblem quiet = WithQuietRunOf(machine.With(ChangesOf({cause})));
  const auto fit =
      TryFit(quiet, candidates, {{Bounded(candidates, {place, simpler->values})}},
             {.iterations = 12, .tolerance = 1e-4, .jacobian = false, .secant = true});
  if (!fit) return kInfinity;
  return (FittedValues(quiet) * fit->train + fit->numbers.squaredNorm()) / inflation_;
}

double VisibleSize::ShownBesideOtherLaws(const Cause& cause) const {
  const DiscoveryProblem quiet =
      WithQuietRunOf(problem_.machine().With(ChangesOf({cause})));
  const std::vector<Candidate> candidates = ListCandidates(problem_.machine());
  const auto run = quiet.Linearised({});
  const auto& [track, dynamics] = *run;
  FittedModel nominal;
  nominal.numbers = VectorXd::Zero(numbers_.cols());
  const Screening screening = Screen(quiet, candidates, quiet.MotionOf(track), dynamics,
                                     quiet.Residual({}), numbers_, nominal, 1);
  for (const Start& start : screening.starts) {  // best first
    if (Indistinguishable(CauseOf(candidates, start.cause), cause)) continue;
    return (screening.rest - start.gain) / inflation_;
  }
  return screening.rest / inflation_;
}

}  // namespace mjdiag
