#include "mjdiag/diagnosis/twin/prediction_error.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A change by less than that, in standard deviations that an unknown has where all
/// others are known, needs no other pass.
constexpr double kMoved = 0.3;
/// Nor does one of which the second order is less than that.
constexpr double kCurved = 0.1;
/// A logarithm moves no farther than this at once.
constexpr double kLongestStep = 0.5;
/// No prior becomes wider than this.
constexpr double kWidest = 0.7;
constexpr double kWidestStart = 1e3;
/// Standard deviations.
constexpr double kSure = 5.0;
constexpr Index kFirstLook = 256;
/// Passes without a longer horizon before it is looked at more coarsely.
constexpr int kPatience = 3;
/// A machine that this many passes do not explain is another one.
constexpr int kMostReturns = 150;
/// At the end of a run, until the estimate is where the twin runs.
constexpr int kLastPasses = 12;
/// A machine explained for that long has changed if it is not any more, which as many
/// passes have to confirm.
constexpr Index kLongExplained = 1024;
constexpr Index kSame = 64;  // ticks
constexpr int kConfirmed = 1;
/// Ticks between kept states, and how many. A change shows within so many of them.
constexpr Index kCheckpoint = 128;
constexpr std::size_t kCheckpoints = 16;
constexpr Index kUnnoticed = 256;
/// Blocks before the surprise in which the change was there already.
constexpr Index kNoticed = 2;
/// While the twin is pulled along, a block that is more surprising counts less, in
/// inverse proportion: a joint came loose a little sooner than the twin's.
constexpr double kRobust = 4.0;
constexpr double kMostSurprising = 32.0;
/// On average over recent blocks, that is none that came loose.
constexpr double kSurprisingThroughout = 8.0;
/// Ticks that such a twin looks at before it goes back, and at first.
constexpr Index kPulledLook = 1024;
constexpr Index kFirstGuess = 128;
constexpr int kPulledPasses = 6;
/// Blocks between two steps of the walk, and of theta0.
constexpr Index kWalkEvery = 64;

}  // namespace

PredictionErrorEstimator::PredictionErrorEstimator(
    std::unique_ptr<Twin> twin, std::vector<Unknown> unknowns, double sample_time,
    const PredictionErrorOptions& options)
    : twin_(std::move(twin)),
      unknowns_(std::move(unknowns)),
      sample_time_(sample_time),
      options_(options),
      kept_(twin_->outputs(), twin_->inputs(), options.kept),
      next_look_(kFirstLook),
      look_(kFirstGuess),
      run_start_(twin_->outputs(), twin_->block(), twin_->unknowns()),
      information_(static_cast<Index>(unknowns_.size()), twin_->outputs()),
      surprise_(twin_->outputs()),
      said_{.information = information_, .theta = {}, .variance = {}, .prior = {}} {
  const auto p = static_cast<Index>(unknowns_.size());
  const Index ny = twin_->outputs();
  const auto block = static_cast<double>(twin_->block());
  nominal_ = walk_ = VectorXd::Zero(p);
  prior_covariance_ = PriorOf(unknowns_);
  for (Index i = 0; i < p; ++i) {
    const Unknown& unknown = unknowns_[static_cast<std::size_t>(i)];
    nominal_[i] = unknown.nominal;
    if (!unknown.wears) continue;
    walk_[i] = options_.wear * options_.wear * sample_time_ * block *
               static_cast<double>(kWalkEvery);
  }
  for (const TwinGain& gain : twin_->gains()) {
    covariances_.emplace_back(gain.covariance / block);
  }
  covariance_ = covariances_.front();
  proven_.assign(covariances_.size(), nominal_);
  is_proven_.assign(covariances_.size(), false);
  theta_ = center_ = nominal_;
  variance_ = prior_covariance_.diagonal();
  work_ = VectorXd::Zero(p);
  prior_ = inverse_ = MatrixXd::Identity(p, p);
  reading_ = innovation_ = sum_ = VectorXd::Zero(ny);
  segment_.first.state = segment_.first.settling_state =
      VectorXd::Zero(twin_->states());
  segment_.now = segment_.first;
  checkpoints_.assign(kCheckpoints, {-1, segment_.first.state});
  WidenPrior();
  said_.theta = theta_;
  said_.variance = variance_;
  said_.prior = prior_;
  work_.setZero();
  said_.information.Start(p, prior_, work_);
}

void PredictionErrorEstimator::WidenPrior() noexcept {
  // What is surely far from nominal is not held there; all else is.
  const Index started = theta_.size() - twin_->start_unknowns();
  inverse_ = prior_covariance_;
  for (Index i = 0; i < information_.active(); ++i) {
    const double away = std::abs(theta_[i] - nominal_[i]);
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

void PredictionErrorEstimator::Begin() noexcept {
  const VectorXd& change = information_.change();
  if (information_.active() > 0 && change.allFinite()) {
    const double farthest = Farthest(change);
    center_ += (farthest > kLongestStep ? kLongestStep / farthest : 1.0) * change;
  }
  const Index started = twin_->start_unknowns();
  const bool settles = Settles();
  // Nothing is known beyond the state that a settled twin had at the origin.
  if (settles || settled_) center_.tail(started).setZero();
  settled_ = settles;
  theta_ = center_;
  const Beginning& from = segment_.now;
  pull_ = settles && !from.at_rest ? covariances_.size() - 1 : gain_;
  twin_->UseGain(pull_);
  if (from.at_rest) {
    twin_->Start(theta_);
  } else {
    twin_->Start(theta_, settles ? from.settling_state : from.state);
  }
  seen_ = settles ? from.settling_from : from.origin;
  counts_from_ =
      settles ? std::max(from.origin, from.settling_from + from.settling) : from.origin;
  phase_origin_ = seen_;
  softer_at_ = seen_ + twin_->gains()[pull_].settling;
  work_ = nominal_ - center_;
  information_.Start(theta_.size() - (from.at_rest || settles ? started : 0), prior_,
                     work_);
  surprise_.Start();
  sum_.setZero();
  in_block_ = blocks_ = 0;
}

void PredictionErrorEstimator::StartOver(std::size_t gain,
                                         const VectorXd& theta) noexcept {
  gain_ = gain;
  segment_.explained = segment_.surprised = 0;
  segment_.stuck = segment_.same = 0;
  pulled_passes_ = 0;
  next_look_ = kept_.added() + kPulledLook;
  look_ = kFirstGuess;
  center_ = theta_ = theta;
  information_.Recentre();
  GoBack();
}

void PredictionErrorEstimator::GoBack() noexcept {
  ++returns_;
  variance_ = information_.Variance();
  WidenPrior();
  Begin();
}

void PredictionErrorEstimator::Add(std::span<const double> outputs,
                                   std::span<const double> inputs) noexcept {
  kept_.Add(outputs, inputs);
  if (information_.active() == 0 && !FindStart()) return;
  ProcessKept();
  if (seen_ < kept_.added()) ProcessKept();
}

void PredictionErrorEstimator::Say() noexcept {
  const bool same = said_.began && said_.since == segment_.first.origin;
  if (blocks_ == 0 || (same && (gain_ > said_.gain || seen_ < said_.until))) return;
  said_.began = true;
  said_.information = information_;
  said_.theta = theta_;
  said_.prior = prior_;
  said_.surprise = surprise_.recent();
  said_.phase_origin = phase_origin_;
  said_.since = segment_.first.origin;
  said_.until = seen_;
  said_.gain = gain_;
}

bool PredictionErrorEstimator::StepTwin() noexcept {
  twin_->Predict(reading_);
  innovation_ = kept_.outputs(seen_) - reading_;
  twin_->Step(kept_.inputs(seen_), innovation_);
  ++seen_;
  if (++in_block_ < twin_->block()) return false;
  in_block_ = 0;
  return true;
}

bool PredictionErrorEstimator::FindStart() noexcept {
  if (kept_.added() < twin_->block()) return false;
  if (kept_.added() == twin_->block()) {
    work_ = nominal_;
    if (run_start_.BeganAtRest(*twin_, kept_, work_, twin_->first_tone(),
                               prior_covariance_)) {
      Begin();
      return true;
    }
  }
  Beginning& first = segment_.first;
  first.at_rest = false;
  first.settling = twin_->gains().back().settling;
  reading_ = kept_.outputs(0);
  twin_->StateAt(reading_, first.settling_state);
  first.state = first.settling_state;
  segment_.now = first;
  if (Finest() > 0) {
    gain_ = covariances_.size() - 1;
  }
  Begin();
  return true;
}

void PredictionErrorEstimator::ProcessKept() noexcept {
  const bool ended = StepTwin();
  sum_ += innovation_;
  if (!ended) return;
  Regress();
  if (exhausted_ || !Surprised()) Say();
  if (following()) {
    Follow();
  } else if (!exhausted_) {
    Reconsider();
  }
  if (blocks_ > 0 && seen_ % kCheckpoint == 0) {
    const auto at = static_cast<std::size_t>(seen_ / kCheckpoint) % kCheckpoints;
    checkpoints_[at].tick = seen_;
    twin_->ReadState(checkpoints_[at].state);
  }
}

void PredictionErrorEstimator::Regress() noexcept {
  const MatrixXd& psi = twin_->EndBlock();
  if (pull_ > gain_ && seen_ >= softer_at_) {
    twin_->UseGain(--pull_);
    softer_at_ = seen_ + twin_->gains()[pull_].settling;
  }
  if (seen_ <= counts_from_) {  // it settles
    sum_.setZero();
    if (seen_ == segment_.now.origin) {
      twin_->ReadState(segment_.now.state);
      if (segment_.now.origin == segment_.first.origin) {
        segment_.first.state = segment_.now.state;
      }
    }
    return;
  }
  learned_ = !WorthGoingBack();
  covariance_ = covariances_[pull_];
  sum_ /= static_cast<double>(twin_->block());
  double surprise = information_.Surprise(psi, sum_, covariance_);
  if (gain_ > 0) {
    covariance_ *= std::max(1.0, surprise / kRobust);
    surprise = std::min(surprise, kMostSurprising);
  }
  surprise_.Add(surprise);
  information_.Add(psi, sum_, covariance_);
  theta_ = center_ + information_.change();
  sum_.setZero();
  ++blocks_;
}

bool PredictionErrorEstimator::Surprised() const noexcept {
  return gain_ > 0 ? !(surprise_.recent() < kSurprisingThroughout)
                   : surprise_.NoChance();
}

void PredictionErrorEstimator::Reconsider() noexcept {
  if (!Pulled() && Surprised()) return Unexplained();
  if (Pulled() && gain_ + 1 == covariances_.size()) return Guess();
  if (seen_ < kept_.added() || seen_ < next_look_) return;
  // It catches up in as long as it goes back.
  next_look_ = kept_.added() +
               (Pulled() ? kPulledLook : 2 * (kept_.added() - segment_.now.origin));
  if (Pulled()) {
    if (!WorthGoingBack() || ++pulled_passes_ > kPulledPasses) {
      LookMoreFinely();
    } else {
      GoBack();
    }
  } else if (!WidenHorizon() && WorthGoingBack()) {
    GoBack();
  }
}

void PredictionErrorEstimator::Guess() noexcept {
  if (seen_ - counts_from_ < look_) return;
  const bool worth = WorthGoingBack() && pulled_passes_ < kPulledPasses;
  if (look_ >= kPulledLook && !worth) {
    LookMoreFinely();
    return;
  }
  if (look_ < kPulledLook) {
    look_ *= 2;
  } else {
    ++pulled_passes_;
    MoveOrigin();
  }
  if (worth) GoBack();
}

const PredictionErrorEstimator::Checkpoint* PredictionErrorEstimator::LastCheckpoint(
    Index until) const noexcept {
  const Checkpoint* last = nullptr;
  for (const Checkpoint& checkpoint : checkpoints_) {
    if (checkpoint.tick < segment_.now.origin || checkpoint.tick > until ||
        checkpoint.tick <= kept_.first()) {
      continue;
    }
    if (last == nullptr || checkpoint.tick > last->tick) last = &checkpoint;
  }
  return last;
}

void PredictionErrorEstimator::MoveOrigin() noexcept {
  if (seen_ < kept_.added()) return;
  const Checkpoint* from = LastCheckpoint(seen_ - kPulledLook - kUnnoticed);
  if (from == nullptr) return;
  Beginning& now = segment_.now;
  now.at_rest = false;
  now.settling_from = from->tick;
  now.settling = kUnnoticed;
  now.settling_state = from->state;
  now.origin = from->tick + kUnnoticed;
}

bool PredictionErrorEstimator::WidenHorizon() noexcept {
  const Beginning& first = segment_.first;
  if (segment_.now.origin == first.origin ||
      std::min(first.origin, first.settling_from) < kept_.first()) {
    return false;
  }
  segment_.now = first;
  next_look_ = kept_.added() + 2 * (kept_.added() - first.origin);
  GoBack();
  return true;
}

void PredictionErrorEstimator::Unexplained() noexcept {
  // Beside a machine that it had nothing to learn of any more.
  if (learned_ && TryChange()) return;
  const Index horizon = seen_ - segment_.now.origin;
  const bool same = std::abs(horizon - segment_.surprised) <= kSame;
  segment_.same = same ? segment_.same + 1 : 0;
  segment_.surprised = horizon;
  if (4 * horizon > 5 * segment_.explained) {
    segment_.explained = horizon;
    segment_.stuck = 0;
  } else {
    ++segment_.stuck;
    if (segment_.same >= kConfirmed && TryChange()) return;
    if (segment_.stuck > kPatience) return LookMoreCoarsely();
  }
  exhausted_ = returns_ >= kMostReturns;
  if (!exhausted_) GoBack();
}

void PredictionErrorEstimator::LookMoreCoarsely() noexcept {
  const std::size_t stiffest = covariances_.size() - 1;
  exhausted_ = gain_ == stiffest || returns_ >= kMostReturns ||
               (gain_ + 1 == stiffest && is_proven_[stiffest]);
  if (exhausted_) return;
  said_.gain = stiffest;  // what was said of it is not true
  if (is_proven_[stiffest]) return StartOver(gain_ + 1, proven_[stiffest]);
  // States of a twin that does not explain the machine are of no use.
  for (Checkpoint& checkpoint : checkpoints_) checkpoint.tick = -1;
  StartOver(stiffest, nominal_);
}

bool PredictionErrorEstimator::LookMoreFinely() noexcept {
  if (gain_ == Finest()) return false;
  proven_[gain_] = theta_;
  is_proven_[gain_] = true;
  const std::size_t stiffest = covariances_.size() - 1;
  StartOver(gain_ == stiffest ? Finest() : gain_ - 1, theta_);
  return true;
}

bool PredictionErrorEstimator::TryChange() noexcept {
  if (Pulled() || seen_ - counts_from_ < kLongExplained) return false;
  const Checkpoint* from = LastCheckpoint(seen_ - kUnnoticed);
  if (from == nullptr) return false;
  Beginning& first = segment_.first;
  first.at_rest = false;
  first.settling_from = from->tick;
  first.settling = kUnnoticed;
  first.settling_state = first.state = from->state;
  first.origin = seen_ - kNoticed * twin_->block();
  segment_.now = first;
  returns_ = 0;
  std::fill(is_proven_.begin(), is_proven_.end(), false);
  variance_ = information_.Variance();
  StartOver(covariances_.size() - 1, theta_);
  return true;
}

std::size_t PredictionErrorEstimator::Finest() const noexcept {
  const bool known = segment_.now.at_rest || twin_->start_unknowns() > 0;
  return known ? 0 : std::min<std::size_t>(1, covariances_.size() - 1);
}

void PredictionErrorEstimator::Follow() noexcept {
  if (Surprised()) {
    // The readings that it keeps begin after the origin, so only a change remains.
    exhausted_ = false;
    if (TryChange()) return;
  }
  if (blocks_ % kWalkEvery != 0) return;
  information_.Walk(walk_);
  const std::size_t soft = std::min<std::size_t>(1, covariances_.size() - 1);
  if (gain_ < soft) {
    gain_ = pull_ = soft;
    twin_->UseGain(pull_);
  }
  center_ += information_.change();
  theta_ = center_;
  twin_->Shift(information_.change());
  information_.Recentre();
}

void PredictionErrorEstimator::PassesToTheEnd() noexcept {
  while (seen_ < kept_.added()) ProcessKept();
  std::size_t failed = covariances_.size();  // gain
  for (int i = 0; i < kMostReturns && !following() && !exhausted_; ++i) {
    if (WorthGoingBack() && ++pulled_passes_ <= kLastPasses) {
      GoBack();
    } else if (gain_ != Finest() && gain_ != failed + 1) {
      LookMoreFinely();
    } else if (!WidenHorizon()) {
      break;
    }
    const std::size_t tried = gain_;
    while (seen_ < kept_.added()) ProcessKept();
    if (gain_ > tried) {
      failed = tried;
      pulled_passes_ = 0;
    }
  }
}

void PredictionErrorEstimator::CatchUp() noexcept {
  if (information_.active() > 0) PassesToTheEnd();
}

double PredictionErrorEstimator::Farthest(const VectorXd& change) const noexcept {
  double farthest = 0.0;
  for (Index i = 0; i < change.size(); ++i) {
    const double reach = unknowns_[static_cast<std::size_t>(i)].reach;
    farthest = std::max(farthest, reach * std::abs(change[i]));
  }
  return farthest;
}

bool PredictionErrorEstimator::WorthGoingBack() const noexcept {
  // Of the machine: where it started may be hard to say and does not matter.
  const Index machine = theta_.size() - twin_->start_unknowns();
  const VectorXd& change = information_.change();
  double moved = 0.0;
  for (Index i = 0; i < machine; ++i) {
    moved = std::max(moved, change[i] * change[i] * information_.H()(i, i));
  }
  moved = std::sqrt(moved);
  return moved > kMoved && moved * twin_->curvature() * Farthest(change) > kCurved;
}

}  // namespace mjdiag
