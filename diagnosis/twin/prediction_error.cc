#include "mjdiag/diagnosis/twin/prediction_error.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

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
/// Of a motion of a few periods (TwinShape).
constexpr double kUsualCurvature = 3.0;
/// While the twin is pulled along, a block that is more surprising counts less, in
/// inverse proportion: a joint came loose a little sooner than the twin's.
constexpr double kRobust = 4.0;
constexpr double kMostSurprising = 32.0;

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
      checkpoints_(twin_->states()),
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
  const bool less = gain_ > said_.gain || seen_ < said_.until;
  if (blocks_ == 0 || (same && less && !exhausted_)) return;
  said_.began = true;
  said_.sure = kUsualCurvature * SecondOrder() < 1.0;
  said_.information = information_;
  said_.theta = theta_;
  said_.prior = prior_;
  said_.surprise = surprise_.recent();
  said_.phase_origin = phase_origin_;
  said_.since = segment_.first.origin;
  said_.until = seen_;
  said_.gain = gain_;
}

void PredictionErrorEstimator::Retract() noexcept {
  said_.gain = covariances_.size() - 1;
  said_.until = 0;
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
  StartInMotion();
  return true;
}

void PredictionErrorEstimator::StartInMotion() noexcept {
  Retract();
  Beginning& first = segment_.first;
  first.at_rest = false;
  first.settling = twin_->gains().back().settling;
  reading_ = kept_.outputs(0);
  twin_->StateAt(reading_, first.settling_state);
  first.state = first.settling_state;
  segment_.now = first;
  StartOver(Finest() > 0 ? covariances_.size() - 1 : 0, nominal_);
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
  if (blocks_ == 0) return;
  if (Checkpoint* at = checkpoints_.At(seen_)) twin_->ReadState(at->state);
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

}  // namespace mjdiag
