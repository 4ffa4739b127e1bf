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
/// A logarithm moves no farther than this at once.
constexpr double kLongestStep = 0.5;
/// Blocks over which surprises are averaged.
constexpr double kRecent = 32.0;
/// A surprise this many standard deviations beyond what is expected is no chance.
constexpr double kNoChance = 8.0;
/// No prior becomes wider than this.
constexpr double kWidest = 0.7;
constexpr double kWidestStart = 1e3;
/// Standard deviations.
constexpr double kSure = 5.0;
/// Ticks a tick while it looks for the start.
constexpr int kPace = 3;
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
/// Ticks that such a twin looks at before it goes back.
constexpr Index kPulledLook = 1024;
constexpr int kPulledPasses = 6;
/// Blocks between two steps of the walk, and of theta0.
constexpr Index kWalkEvery = 64;

}  // namespace

PredictionErrorEstimator::PredictionErrorEstimator(
    std::unique_ptr<Twin> twin, std::vector<Unknown> unknowns, const MatrixXd& prior,
    double sample_time, const PredictionErrorOptions& options)
    : twin_(std::move(twin)),
      unknowns_(std::move(unknowns)),
      sample_time_(sample_time),
      options_(options),
      kept_(twin_->outputs(), twin_->inputs(), options.kept),
      next_look_(kFirstLook),
      run_start_(twin_->outputs(), twin_->block()),
      information_(static_cast<Index>(unknowns_.size()), twin_->outputs()) {
  const auto p = static_cast<Index>(unknowns_.size());
  const Index ny = twin_->outputs();
  const auto block = static_cast<double>(twin_->block());
  nominal_ = walk_ = VectorXd::Zero(p);
  prior_covariance_ = MatrixXd::Zero(p, p);
  for (Index i = 0; i < p; ++i) {
    const Unknown& unknown = unknowns_[static_cast<std::size_t>(i)];
    nominal_[i] = unknown.factor ? std::log(unknown.nominal) : unknown.nominal;
    prior_covariance_(i, i) = unknown.prior_sd * unknown.prior_sd;
    if (!unknown.wears) continue;
    walk_[i] = options_.wear * options_.wear * sample_time_ * block *
               static_cast<double>(kWalkEvery);
  }
  if (prior.size() > 0) prior_covariance_ = prior;
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
  segment_.state = segment_.settling_state = VectorXd::Zero(twin_->states());
  checkpoints_.assign(kCheckpoints, {-1, segment_.state});
  WidenPrior();
}

void PredictionErrorEstimator::WidenPrior() noexcept {
  // What is surely far from nominal is not held there; all else is.
  const Index started = theta_.size() - twin_->start_unknowns();
  inverse_ = prior_covariance_;
  for (Index i = 0; i < active(); ++i) {
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
  if (active() > 0 && change.allFinite()) {
    const double farthest = Farthest(change);
    center_ += (farthest > kLongestStep ? kLongestStep / farthest : 1.0) * change;
  }
  const Index started = twin_->start_unknowns();
  const bool settles = Settles();
  // Nothing is known beyond the state that a settled twin had at the origin.
  if (settles || settled_) center_.tail(started).setZero();
  settled_ = settles;
  theta_ = center_;
  pull_ = settles && !segment_.at_rest ? covariances_.size() - 1 : gain_;
  twin_->UseGain(pull_);
  if (segment_.at_rest) {
    twin_->Start(theta_);
  } else if (settles) {
    twin_->Start(theta_, segment_.settling_state);
  } else {
    twin_->Start(theta_, segment_.state);
  }
  seen_ = settles ? segment_.settling_from : segment_.origin;
  phase_origin_ = seen_;
  softer_at_ = seen_ + twin_->gains()[pull_].settling;
  work_ = nominal_ - center_;
  information_.Start(theta_.size() - (segment_.at_rest || settles ? started : 0),
                     prior_, work_);
  surprise_ = block_surprise_ = 1.0;
  sum_.setZero();
  in_block_ = blocks_ = 0;
}

void PredictionErrorEstimator::GoBack() noexcept {
  ++returns_;
  Variance();
  WidenPrior();
  Begin();
}

void PredictionErrorEstimator::Add(std::span<const double> outputs,
                                   std::span<const double> inputs) noexcept {
  kept_.Add(outputs, inputs);
  if (active() == 0 && !FindStart()) return;
  ProcessKept();
  if (seen_ < kept_.added()) ProcessKept();
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
    if (run_start_.BeganAtRest(*twin_, kept_, work_, FirstTone())) {
      Begin();
      return true;
    }
  }
  const Index settled = twin_->gains().back().settling;
  const auto looked =
      settled + static_cast<Index>(std::lround(options_.looking / sample_time_));
  if (kept_.added() < looked) return false;
  segment_.origin =
      QuietestTick(kept_, settled, looked, twin_->block(), covariances_.front());
  segment_.at_rest = false;
  segment_.settling_from = 0;
  reading_ = kept_.outputs(0);
  twin_->StateAt(reading_, segment_.settling_state);
  // Beside the machine by its stiffest gain, until it has forgotten how it began.
  gain_ = covariances_.size() - 1;
  next_look_ = segment_.origin + kPulledLook;
  Begin();
  return true;
}

Index PredictionErrorEstimator::FirstTone() const noexcept {
  Index end = theta_.size() - twin_->start_unknowns();
  while (end > 0 && !unknowns_[static_cast<std::size_t>(end - 1)].factor) --end;
  return end;
}

void PredictionErrorEstimator::ProcessKept() noexcept {
  const bool ended = StepTwin();
  sum_ += innovation_;
  if (!ended) return;
  Regress();
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
  if (seen_ <= segment_.origin) {  // it settles
    sum_.setZero();
    if (seen_ == segment_.origin) twin_->ReadState(segment_.state);
    return;
  }
  covariance_ = covariances_[pull_];
  sum_ /= static_cast<double>(twin_->block());
  block_surprise_ = information_.Surprise(psi, sum_, covariance_);
  if (gain_ > 0) {
    covariance_ *= std::max(1.0, block_surprise_ / kRobust);
    block_surprise_ = std::min(block_surprise_, kMostSurprising);
  }
  surprise_ += (block_surprise_ - surprise_) / kRecent;
  information_.Add(psi, sum_, covariance_);
  theta_ = center_ + information_.change();
  sum_.setZero();
  ++blocks_;
}

bool PredictionErrorEstimator::Surprised() const noexcept {
  if (gain_ > 0) return !(surprise_ < kSurprisingThroughout);
  const double by_chance = std::sqrt(2.0 / static_cast<double>(twin_->outputs()));
  return !(block_surprise_ < 1.0 + 3.0 * kNoChance * by_chance) ||
         !(surprise_ < 1.0 + kNoChance * by_chance / std::sqrt(kRecent / 2.0));
}

void PredictionErrorEstimator::Reconsider() noexcept {
  if (!Pulled() && Surprised()) return Unexplained();
  if (seen_ < kept_.added() || seen_ < next_look_) return;
  next_look_ =
      Pulled() ? kept_.added() + kPulledLook : kept_.added() + kept_.added() / 2;
  if (Pulled() && WorthGoingBack() && ++pulled_passes_ <= kPulledPasses) {
    GoBack();
  } else if (!LookMoreFinely() && WorthGoingBack()) {
    GoBack();
  }
}

void PredictionErrorEstimator::Unexplained() noexcept {
  // Beside a machine that it had nothing to learn of any more.
  if (seen_ == kept_.added() && !WorthGoingBack() && TryChange()) return;
  const Index horizon = seen_ - segment_.origin;
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
  segment_.explained = segment_.surprised = 0;
  segment_.stuck = segment_.same = 0;
  const std::size_t stiffest = covariances_.size() - 1;
  exhausted_ = gain_ == stiffest || returns_ >= kMostReturns;
  if (exhausted_) return;
  gain_ = is_proven_[gain_ + 1] ? gain_ + 1 : stiffest;
  pulled_passes_ = 0;
  next_look_ = is_proven_[gain_] ? kept_.added() + kept_.added() / 2
                                 : kept_.added() + kPulledLook;
  center_ = is_proven_[gain_] ? proven_[gain_] : nominal_;
  theta_ = center_;
  information_.Recentre();
  GoBack();
}

bool PredictionErrorEstimator::LookMoreFinely() noexcept {
  if (gain_ == Finest()) return false;
  segment_.explained = segment_.surprised = 0;
  segment_.stuck = segment_.same = 0;
  pulled_passes_ = 0;
  proven_[gain_] = theta_;
  is_proven_[gain_] = true;
  --gain_;
  GoBack();
  return true;
}

bool PredictionErrorEstimator::TryChange() noexcept {
  if (Pulled() || seen_ - segment_.origin < kLongExplained) return false;
  const Checkpoint* from = nullptr;
  for (const Checkpoint& checkpoint : checkpoints_) {
    if (checkpoint.tick < segment_.origin || checkpoint.tick > seen_ - kUnnoticed ||
        checkpoint.tick <= kept_.first()) {
      continue;
    }
    if (from == nullptr || checkpoint.tick > from->tick) from = &checkpoint;
  }
  if (from == nullptr) return false;
  segment_.at_rest = false;
  segment_.settling_from = from->tick;
  segment_.settling_state = from->state;
  segment_.state = from->state;
  segment_.origin = seen_ - kNoticed * twin_->block();
  segment_.explained = segment_.surprised = 0;
  segment_.stuck = segment_.same = 0;
  returns_ = pulled_passes_ = 0;
  std::fill(is_proven_.begin(), is_proven_.end(), false);
  gain_ = covariances_.size() - 1;
  next_look_ = segment_.origin + kPulledLook;
  center_ = theta_;
  information_.Recentre();
  WidenPrior();
  Begin();
  return true;
}

std::size_t PredictionErrorEstimator::Finest() const noexcept {
  const bool known = segment_.at_rest || twin_->start_unknowns() > 0;
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
    const bool worth = WorthGoingBack() && ++pulled_passes_ <= kLastPasses;
    if (worth) {
      GoBack();
    } else if (gain_ == Finest() || gain_ == failed + 1) {
      break;
    } else {
      LookMoreFinely();
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
  if (active() == 0) {
    while (kept_.added() > 0 && !FindStart()) {
      if (segment_.at_rest) return;  // too short to find a start in it
    }
  }
  PassesToTheEnd();
}

double PredictionErrorEstimator::Farthest(const VectorXd& change) const noexcept {
  double farthest = 0.0;
  for (Index i = 0; i < change.size(); ++i) {
    if (unknowns_[static_cast<std::size_t>(i)].factor) {
      farthest = std::max(farthest, std::abs(change[i]));
    }
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
  return moved > kMoved * kMoved;
}

}  // namespace mjdiag
