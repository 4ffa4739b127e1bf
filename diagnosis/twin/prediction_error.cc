#include "mjdiag/diagnosis/twin/prediction_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Part of a standard deviation that the second order of a change may have.
constexpr double kSecondOrder = 0.1;
/// A logarithm moves no farther than this at once.
constexpr double kLongestStep = 0.5;
/// Blocks over which surprises are averaged.
constexpr double kRecent = 32.0;
/// A surprise this many standard deviations beyond what is expected is no chance.
constexpr double kNoChance = 8.0;
/// A reading within this many standard deviations of that at rest is one.
constexpr double kAtRest = 6.0;
/// Part of a first movement by which a faulty machine may differ.
constexpr double kUnlike = 1.0;
/// No prior becomes wider than this.
constexpr double kWidest = 0.7;
constexpr double kWidestStart = 1e3;
/// Standard deviations.
constexpr double kSure = 5.0;
/// Ticks a tick while it looks for the start.
constexpr int kPace = 3;
constexpr Index kFirstLook = 256;
/// Passes without a longer horizon before it is looked at more coarsely: by that much
/// in variance, and no more than that.
constexpr int kPatience = 8;
constexpr double kCoarser = 10.0;
constexpr double kCoarsest = 1e7;
/// A machine that this many passes do not explain is another one.
constexpr int kMostReturns = 150;
/// At the end of a run, until the estimate is where the twin runs.
constexpr int kLastPasses = 12;

}  // namespace

PredictionErrorEstimator::PredictionErrorEstimator(
    std::unique_ptr<Twin> twin, std::vector<Unknown> unknowns, VectorXd sensor_noise,
    double sample_time, const PredictionErrorOptions& options)
    : twin_(std::move(twin)),
      unknowns_(std::move(unknowns)),
      sample_time_(sample_time),
      options_(options),
      noise_(sensor_noise.cwiseAbs2() / static_cast<double>(twin_->block())),
      next_look_(kFirstLook),
      small_(twin_->outputs()) {
  const auto p = static_cast<Index>(unknowns_.size());
  const Index ny = twin_->outputs();
  prior_.resize(p);
  nominal_.resize(p);
  for (Index i = 0; i < p; ++i) {
    const Unknown& unknown = unknowns_[static_cast<std::size_t>(i)];
    prior_[i] = 1.0 / (unknown.prior_sd * unknown.prior_sd);
    nominal_[i] = unknown.factor ? std::log(unknown.nominal) : unknown.nominal;
  }
  kept_ = MatrixXd::Zero(ny + twin_->inputs(), options_.kept);
  last_variance_ = prior_.cwiseInverse();
  theta_ = center_ = nominal_;
  change_ = g_ = scale_ = work_ = spread_of_theta_ = VectorXd::Zero(p);
  H_ = scaled_ = inverse_ = MatrixXd::Zero(p, p);
  reading_ = innovation_ = sum_ = corrected_ = VectorXd::Zero(ny);
  weighted_ = MatrixXd::Zero(ny, p);
  spread_ = MatrixXd::Zero(p, ny);
  expected_ = MatrixXd::Zero(ny, ny);
}

void PredictionErrorEstimator::Begin() noexcept {
  if (!change_.allFinite()) change_.setZero();
  const double farthest = Farthest(change_);
  center_ += (farthest > kLongestStep ? kLongestStep / farthest : 1.0) * change_;
  theta_ = center_;
  twin_->Start(theta_, at_rest_);
  H_ = prior_.asDiagonal();
  g_ = prior_.cwiseProduct(nominal_ - center_);
  change_.setZero();
  recent_surprise_ = 1.0;
  sum_.setZero();
  unexplained_ = false;
  in_block_ = blocks_ = 0;
  seen_ = origin_;
}

void PredictionErrorEstimator::GoBack() noexcept {
  ++returns_;
  // What is surely far from nominal is not held there; all else is.
  Spread();
  for (Index i = 0; i < active_; ++i) {
    const double sd = unknowns_[static_cast<std::size_t>(i)].prior_sd;
    const double away = theta_[i] - nominal_[i];
    const double variance = spread_of_theta_[i] * spread_of_theta_[i];
    const bool sure = away * away > kSure * kSure * variance;
    const bool of_start = i >= theta_.size() - twin_->start_unknowns();
    const double widest = of_start ? kWidestStart : kWidest;
    const double width = sure ? std::min(std::abs(away), widest) : 0.0;
    prior_[i] = 1.0 / std::max(sd * sd, width * width);
  }
  Begin();
}

void PredictionErrorEstimator::Add(std::span<const double> outputs,
                                   std::span<const double> inputs) noexcept {
  auto slot = kept_.col(added_ % options_.kept);
  std::copy(outputs.begin(), outputs.end(), slot.begin());
  std::copy(inputs.begin(), inputs.end(),
            slot.begin() + static_cast<Index>(outputs.size()));
  ++added_;
  if (active_ == 0 && !FindStart()) return;
  ProcessKept();
  if (seen_ < added_) ProcessKept();
}

bool PredictionErrorEstimator::FindStart() noexcept {
  if (added_ < twin_->block()) return false;
  if (added_ == twin_->block() && BeganAtRest()) {
    at_rest_ = true;
    active_ = theta_.size() - twin_->start_unknowns();
    Begin();
    return true;
  }
  const auto settled =
      static_cast<Index>(std::lround(options_.settling / sample_time_));
  const auto looked =
      settled + static_cast<Index>(std::lround(options_.looking / sample_time_));
  if (added_ < looked) return false;
  if (added_ == looked) {
    origin_ = QuietestTick(settled, looked);
    corrected_ = kept_.col(0).head(reading_.size());
    twin_->Start(theta_, true);
    twin_->Place(corrected_);
    seen_ = 0;
  }
  // Beside the machine by its gain, until it has forgotten how it began.
  for (int i = 0; i < kPace && seen_ < origin_; ++i) {
    const auto slot = kept_.col(seen_);
    twin_->Predict(reading_);
    innovation_ = slot.head(reading_.size()) - reading_;
    twin_->Step({slot.data() + reading_.size(),
                 static_cast<std::size_t>(slot.size() - reading_.size())},
                innovation_);
    if (++seen_ % twin_->block() == 0) twin_->EndBlock();
  }
  if (seen_ < origin_) return false;
  twin_->Remember();
  at_rest_ = false;
  active_ = theta_.size();
  Begin();
  return true;
}

bool PredictionErrorEstimator::BeganAtRest() noexcept {
  twin_->Start(theta_, true);
  twin_->Predict(reading_);
  corrected_ = reading_;
  innovation_.setZero();
  bool at_rest = true;
  for (Index k = 0; k < added_; ++k) {
    const auto slot = kept_.col(k);
    if (k > 0) twin_->Predict(reading_);
    for (Index i = 0; i < reading_.size(); ++i) {
      const double sd = std::sqrt(noise_[i] * static_cast<double>(twin_->block()));
      const double moved = std::abs(reading_[i] - corrected_[i]);
      if (std::abs(slot[i] - reading_[i]) > kAtRest * sd + kUnlike * moved) {
        at_rest = false;
      }
    }
    twin_->Step({slot.data() + reading_.size(),
                 static_cast<std::size_t>(slot.size() - reading_.size())},
                innovation_);
  }
  return at_rest;
}

Index PredictionErrorEstimator::QuietestTick(Index from, Index to) const noexcept {
  const Index block = twin_->block();
  Index quietest = from - from % block;
  double least = std::numeric_limits<double>::infinity();
  for (Index k = quietest; k < to; k += block) {
    double moved = 0.0;
    for (Index i = 0; i < noise_.size(); ++i) {
      const double way = kept_(i, k) - kept_(i, k - block);
      moved += way * way / noise_[i];
    }
    if (moved < least) {
      least = moved;
      quietest = k;
    }
  }
  return quietest;
}

void PredictionErrorEstimator::CatchUp() noexcept {
  while (active_ == 0 && seen_ < origin_) FindStart();
  if (active_ == 0) return;
  while (seen_ < added_) ProcessKept();
  for (int i = 0; i < kLastPasses && added_ <= options_.kept; ++i) {
    if (inflation_ > 1.0) {
      inflation_ = std::max(1.0, inflation_ / kCoarser);
    } else if (!WorthGoingBack()) {
      break;
    }
    GoBack();
    while (seen_ < added_) ProcessKept();
  }
}

void PredictionErrorEstimator::ProcessKept() noexcept {
  const auto slot = kept_.col(seen_ % options_.kept);
  const auto ny = static_cast<std::size_t>(twin_->outputs());
  Process({slot.data(), ny},
          {slot.data() + ny, static_cast<std::size_t>(kept_.rows()) - ny});
  if (added_ > options_.kept || in_block_ != 0 || returns_ >= kMostReturns) {
    return;
  }
  if (unexplained_) {
    // The horizon that is explained grows from pass to pass. Where it does not, the
    // machine is looked at more coarsely first: a course of sticking and slipping that
    // is told to the last digit can be told in one way only.
    if (4 * (seen_ - origin_) > 5 * farthest_seen_) {
      farthest_seen_ = seen_ - origin_;
      stuck_ = 0;
    } else if (++stuck_ > kPatience) {
      farthest_seen_ = 0;
      stuck_ = 0;
      if (inflation_ > kCoarsest) return;
      inflation_ *= kCoarser;
    }
    return GoBack();
  }
  if (seen_ < added_ || seen_ < next_look_) return;
  next_look_ = added_ + added_ / 2;
  if (inflation_ > 1.0) {
    inflation_ = std::max(1.0, inflation_ / kCoarser);
    farthest_seen_ = 0;
    stuck_ = 0;
    return GoBack();
  }
  if (WorthGoingBack()) GoBack();
}

void PredictionErrorEstimator::Process(std::span<const double> outputs,
                                       std::span<const double> inputs) noexcept {
  twin_->Predict(reading_);
  innovation_ =
      VectorXd::Map(outputs.data(), static_cast<Index>(outputs.size())) - reading_;
  sum_ += innovation_;
  innovation_.setZero();
  twin_->Step(inputs, innovation_);
  ++seen_;
  if (++in_block_ < twin_->block()) return;
  in_block_ = 0;
  Regress();
}

void PredictionErrorEstimator::Regress() noexcept {
  const MatrixXd& psi = twin_->EndBlock();
  const Index ny = sum_.size();
  sum_ /= static_cast<double>(twin_->block());
  ++blocks_;
  const auto seen = psi.leftCols(active_);
  auto change = change_.head(active_);
  // How surprising the block is: its innovations less what the estimate explains, in
  // units of what noise and the uncertainty of the estimate let expect.
  corrected_ = sum_;
  corrected_.noalias() -= seen * change;
  {
    auto spread = spread_.topRows(active_);
    const auto factor = Factorise();
    spread = scale_.head(active_).asDiagonal() * seen.transpose();
    factor.solveInPlace(spread);
    spread = scale_.head(active_).asDiagonal() * spread;
    expected_.noalias() = seen * spread;
  }
  expected_.diagonal() += inflation_ * noise_;
  small_.compute(expected_);
  reading_ = corrected_;
  small_.solveInPlace(reading_);
  const double surprise = corrected_.dot(reading_) / static_cast<double>(ny);
  recent_surprise_ += (surprise - recent_surprise_) / kRecent;

  weighted_.leftCols(active_) =
      (inflation_ * noise_).cwiseInverse().asDiagonal() * seen;
  H_.topLeftCorner(active_, active_).noalias() +=
      weighted_.leftCols(active_).transpose() * seen;
  g_.head(active_).noalias() += weighted_.leftCols(active_).transpose() * sum_;
  sum_.setZero();
  {
    const auto factor = Factorise();
    auto solution = work_.head(active_);
    solution = scale_.head(active_).cwiseProduct(g_.head(active_));
    factor.solveInPlace(solution);
    change = scale_.head(active_).cwiseProduct(solution);
    theta_ = center_ + change_;
  }
  const double by_chance = std::sqrt(2.0 / static_cast<double>(ny));
  unexplained_ =
      !(surprise < 1.0 + 3.0 * kNoChance * by_chance) ||
      !(recent_surprise_ < 1.0 + kNoChance * by_chance / std::sqrt(kRecent / 2.0));
}

Eigen::LLT<Eigen::Ref<MatrixXd>> PredictionErrorEstimator::Factorise() noexcept {
  // What rounding leaves of a direction that others explain.
  constexpr double kRidge = 1e-13;
  auto scale = scale_.head(active_);
  scale = H_.diagonal().head(active_).cwiseSqrt().cwiseInverse();
  Eigen::Ref<MatrixXd> scaled = scaled_.topLeftCorner(active_, active_);
  scaled = scale.asDiagonal() * H_.topLeftCorner(active_, active_) * scale.asDiagonal();
  scaled.diagonal().array() += kRidge;
  return Eigen::LLT<Eigen::Ref<MatrixXd>>(scaled);
}

const VectorXd& PredictionErrorEstimator::Spread() noexcept {
  auto inverse = inverse_.topLeftCorner(active_, active_);
  inverse.setIdentity();
  Factorise().solveInPlace(inverse);
  for (Index i = 0; i < active_; ++i) {
    last_variance_[i] = scale_[i] * scale_[i] * inverse(i, i);
    spread_of_theta_[i] = std::sqrt(last_variance_[i]);
  }
  return spread_of_theta_;
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
  const double square = std::max(0.0, change_.dot(g_));
  const auto p = static_cast<double>(active_);
  return square > p + 4.0 * std::sqrt(2.0 * p) ||
         Farthest(change_) * std::sqrt(square) > kSecondOrder;
}

}  // namespace mjdiag
