#include "mjdiag/diagnosis/twin/prediction_error.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "mjdiag/diagnosis/statistics/distributions.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A logarithm moves no farther than this at once.
constexpr double kLongestStep = 0.5;
/// No prior becomes wider than this.
constexpr double kWidest = 0.7;
constexpr double kWidestStart = 1e3;
/// Standard deviations.
constexpr double kSure = 5.0;
constexpr Index kFirstLook = 256;
/// Ticks that are little more than a joint that has just come loose.
constexpr Index kBrief = 128;
/// Ticks between two steps of the walk while it follows: in so many a fault that grows
/// by a percent an hour moves by less than noise leaves of the best known ones.
constexpr Index kWalkEvery = 128;
/// That a machine which is constant is taken for one that wears, in one look at it.
constexpr double kNoGrowth = 1e-6;
/// By chance the NIS is not above it.
constexpr double kLooksExplained = 2.0;
/// Moves of the state take for granted that theta has always been what it is now: what has
/// grown leaves errors of the rate times the memory of the gain. Where growth is seen, that
/// is three times shorter.
constexpr std::size_t kFollowingGain = 1;
constexpr std::size_t kGrowingGain = 2;
/// And between two shifts of theta0, which cost more.
constexpr Index kShiftEvery = 512;

}  // namespace

PredictionErrorEstimator::PredictionErrorEstimator(
    std::unique_ptr<Twin> twin, std::vector<Unknown> unknowns, double sample_time,
    const PredictionErrorOptions& options)
    : pass_(std::move(twin), options.tolerated),
      unknowns_(std::move(unknowns)),
      options_(options),
      prior_covariance_(PriorOf(unknowns_)),
      kept_(pass_.twin().outputs(), pass_.twin().inputs(), options.kept),
      run_start_(pass_.twin().outputs(), pass_.twin().block(), pass_.twin().unknowns()),
      checkpoints_(pass_.twin()),
      next_look_(kFirstLook),
      said_{.information = pass_.information(),
            .drift = pass_.drift(),
            .theta = {},
            .variance = {},
            .prior = {}} {
  const auto drifting = static_cast<double>(pass_.twin().drifting().size());
  constant_ = drifting > 0.0 ? ChiSquaredQuantile(kNoGrowth, drifting) : 0.0;
  const auto p = static_cast<Index>(unknowns_.size());
  nominal_ = walk_ = VectorXd::Zero(p);
  for (Index i = 0; i < p; ++i) {
    const Unknown& unknown = unknowns_[static_cast<std::size_t>(i)];
    nominal_[i] = unknown.nominal;
    if (!unknown.wears) continue;
    walk_[i] =
        options_.wear * options_.wear * sample_time * static_cast<double>(kWalkEvery);
  }
  next_ = nominal_;
  variance_ = prior_covariance_.diagonal();
  work_ = far_ = nearest_ = VectorXd::Zero(p);
  prior_ = inverse_ = MatrixXd::Identity(p, p);
  segment_.first.state = segment_.first.settling = pass_.twin().MakeState();
  segment_.window = at_rest_ = segment_.first;
  WidenPrior();
  said_.theta = nominal_;
  said_.variance = variance_;
  said_.prior = prior_;
  said_.information.Start(p, prior_, VectorXd::Zero(p));
}

void PredictionErrorEstimator::WidenPrior() noexcept {
  // What is surely far from nominal is not held there; all else is.
  const Index started = next_.size() - pass_.twin().start_unknowns();
  inverse_ = prior_covariance_;
  for (Index i = 0; i < pass_.information().active(); ++i) {
    const double away = std::abs(next_[i] - nominal_[i]);
    if (!(away > kSure * std::sqrt(variance_[i]))) continue;
    const double width = std::min(away, i < started ? kWidest : kWidestStart);
    inverse_(i, i) = std::max(inverse_(i, i), width * width);
  }
  work_ = inverse_.diagonal().cwiseSqrt().cwiseInverse();
  inverse_ = work_.asDiagonal() * inverse_ * work_.asDiagonal();
  Eigen::Ref<MatrixXd> in_place = inverse_;
  const Eigen::LLT<Eigen::Ref<MatrixXd>> factor(in_place);
  prior_.setIdentity();
  factor.solveInPlace(prior_);
  prior_ = work_.asDiagonal() * prior_ * work_.asDiagonal();
}

const VectorXd& PredictionErrorEstimator::NextTheta() noexcept {
  next_ = pass_.theta0();
  const VectorXd& change = pass_.DiscountedChange();
  if (!change.allFinite()) return next_;
  const double farthest = Farthest(change);
  next_ += (farthest > kLongestStep ? kLongestStep / farthest : 1.0) * change;
  variance_ = pass_.information().Variance();
  WidenPrior();
  return next_;
}

void PredictionErrorEstimator::Begin(std::size_t gain, const VectorXd& theta) noexcept {
  ++returns_;
  pass_.Begin(now(), theta, gain, prior_, nominal_);
}

void PredictionErrorEstimator::Add(std::span<const double> outputs,
                                   std::span<const double> inputs) noexcept {
  kept_.Add(outputs, inputs);
  if (!pass_.began()) {
    if (kept_.added() < pass_.twin().block()) return;
    FindStart();
  }
  ProcessKept();
  if (!CaughtUp()) ProcessKept();
}

void PredictionErrorEstimator::FindStart() noexcept {
  work_ = nominal_;
  if (run_start_.BeganAtRest(pass_.twin(), kept_, work_, pass_.twin().first_tone(),
                             prior_covariance_)) {
    looked_at_rest_ = true;
    pass_.Begin(segment_.first, nominal_, 0, prior_, nominal_);
  } else {
    StartInMotion();
  }
}

void PredictionErrorEstimator::ProcessKept() noexcept {
  const bool added = pass_.Step(kept_);
  if (pass_.seen() % pass_.twin().block() != 0 || pass_.blocks() == 0) return;
  if (Checkpoint* at = checkpoints_.At(pass_.seen())) {
    pass_.twin().ReadState(at->state);
  }
  if (!added) return;
  if (exhausted_ || !RejectsItsInnovations()) Say();
  if (following()) {
    Follow();
  } else if (!exhausted_) {
    Reconsider();
  }
  learned_ = Bias() < 1.0;
}

void PredictionErrorEstimator::Say() noexcept {
  const bool same = said_.began && said_.since == segment_.since;
  const bool brief = !pass_.twin().linear() && pass_.ticks() < kBrief;
  const bool sure = !brief && Bias() < 1.0;
  const bool less =
      gain() > said_.gain || pass_.seen() < said_.until || (said_.sure && !sure);
  // While it follows there is nothing finer that could stand.
  if (pass_.blocks() == 0 || (same && less && !exhausted_ && !FollowsNow())) return;
  said_.began = true;
  said_.sure = sure;
  said_.information.Know(pass_.information());
  said_.drifts = pass_.drifts();
  said_.drift_time = pass_.drift_time();
  if (said_.drifts) said_.drift.Know(pass_.drift());
  said_.theta = pass_.theta();
  said_.prior = prior_;
  said_.recent_nis = pass_.normalized().recent() / options_.tolerated;
  said_.since = segment_.since;
  said_.until = pass_.seen();
  said_.gain = gain();
}

void PredictionErrorEstimator::Retract() noexcept {
  said_.gain = pass_.stiffest();
  said_.sure = false;
  said_.until = 0;
}

void PredictionErrorEstimator::Follow() noexcept {
  if (RejectsItsInnovations()) {
    // The readings that it keeps begin after the origin, so only a change remains.
    exhausted_ = false;
    if (TryChange()) return;
  }
  // Moves of theta0 about which little is known yet would leave sensitivities of another
  // machine.
  if (!FollowsNow()) return;
  if (pass_.drifts()) {
    segment_.grows = segment_.grows || SeesGrowth();
    // As a walk of that wear would have it, evenly.
    pass_.TakeDrift(options_.wear / std::sqrt(pass_.drift_time()));
    Say();
  }
  if (pass_.ticks() % kWalkEvery != 0) return;
  pass_.information().Walk(walk_);
  if (pass_.ticks() % kShiftEvery != 0) return;
  const std::size_t soft =
      std::min(segment_.grows ? kGrowingGain : kFollowingGain, pass_.stiffest());
  if (gain() < soft) pass_.Soften(soft);
  pass_.Shift();
}

bool PredictionErrorEstimator::SeesGrowth() noexcept {
  // What the pass does not explain is no growth, either.
  return options_.exact && pass_.nis() < kLooksExplained &&
         pass_.DriftGain(kRateSpread) > constant_;
}

double PredictionErrorEstimator::Farthest(const VectorXd& change) const noexcept {
  double farthest = 0.0;
  for (Index i = 0; i < change.size(); ++i) {
    const double reach = unknowns_[static_cast<std::size_t>(i)].reach;
    farthest = std::max(farthest, reach * std::abs(change[i]));
  }
  return farthest;
}

double PredictionErrorEstimator::Bias() const noexcept {
  /// Standard deviations that an unknown has where all others are known: less is none.
  constexpr double kMoved = 0.3;
  // Of the machine: where it started may be hard to say and does not matter.
  const Index machine = nominal_.size() - pass_.twin().start_unknowns();
  const Information& information = pass_.information();
  const VectorXd& change = information.change();
  double moved = 0.0;
  for (Index i = 0; i < machine; ++i) {
    moved = std::max(moved, change[i] * change[i] * information.H()(i, i));
  }
  if (!(moved > kMoved * kMoved)) return 0.0;
  return pass_.twin().curvature() * std::sqrt(moved) * Farthest(change);
}

bool PredictionErrorEstimator::RejectsItsInnovations() const noexcept {
  return (gain() == 0 || following()) && pass_.normalized().NoChance();
}

}  // namespace mjdiag
