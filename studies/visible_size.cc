#include "mjdiag/studies/visible_size.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "mjdiag/discovery/fitting/cause_fit.h"
#include "mjdiag/discovery/fitting/screening_in_place.h"
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
    for (Index k = 0; k < z.size(); ++k) {
      const DoubtedNumber& number = problem.numbers()[static_cast<std::size_t>(k)];
      z[k] = std::clamp(z[k], number.Least(), number.Most());
    }
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

/// The candidate that is of the kind of a cause and at its place.
std::optional<std::size_t> PlaceOf(const std::vector<Candidate>& candidates,
                                   const Cause& cause) {
  const auto place = std::ranges::find_if(candidates, [&](const Candidate& candidate) {
    return SameKind({candidate.effect, candidate.site, {}}, cause);
  });
  if (place == candidates.end()) return std::nullopt;
  return static_cast<std::size_t>(place - candidates.begin());
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
  const auto place = PlaceOf(candidates, *simpler);
  if (!place) return kInfinity;
  const DiscoveryProblem quiet = WithQuietRunOf(machine.With(ChangesOf({cause})));
  return LeftBy(quiet, candidates, {{Bounded(candidates, {*place, simpler->values})}});
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

double VisibleSize::ShownBesideOtherLaws(const std::vector<Cause>& all,
                                         std::size_t one) const {
  const DiscoveryProblem quiet =
      WithQuietRunOf(problem_.machine().With(ChangesOf(all)));
  const std::vector<Candidate> candidates = ListCandidates(problem_.machine());
  FittedModel truth;
  truth.numbers = VectorXd::Zero(numbers_.cols());
  for (const Cause& cause : all) {
    const auto place = PlaceOf(candidates, cause);
    if (!place) return std::numeric_limits<double>::infinity();
    truth.causes.push_back({*place, cause.values});
  }
  const CauseFit fit = FitCauses(quiet, candidates, truth, {.iterations = 0});
  const Screening screening = ScreenInPlace(quiet, candidates, fit, {one}, 1);
  const auto best = std::ranges::find_if(screening.starts, [&](const Start& start) {
    return !Has(fit.causes, start.cause.candidate) &&
           !Indistinguishable(CauseOf(candidates, start.cause), all[one]);
  });
  if (best == screening.starts.end()) return std::numeric_limits<double>::infinity();
  // The first order, by which it is found, is off by a share of what large causes do.
  FittedModel other = ModelWithout(fit, {one});
  other.causes.push_back(Bounded(candidates, best->cause));
  return LeftBy(quiet, candidates, other);
}

double VisibleSize::LeftBy(const DiscoveryProblem& quiet,
                           const std::vector<Candidate>& candidates,
                           const FittedModel& model) const {
  const auto fit =
      TryFit(quiet, candidates, model,
             {.iterations = 12, .tolerance = 1e-4, .jacobian = false, .secant = true});
  if (!fit) return std::numeric_limits<double>::infinity();
  return (FittedValues(quiet) * fit->train + fit->numbers.squaredNorm()) / inflation_;
}

}  // namespace mjdiag
