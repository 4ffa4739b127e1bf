#include "mjdiag/studies/excitation/tone_shares.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mjdiag/signals/decompositions.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The shares under way, with the information that they have.
class Exchange {
 public:
  Exchange(const std::vector<ToneChoice>& choices, const MatrixXd& fixed,
           const std::vector<Index>& wanted)
      : choices_(choices),
        wanted_(wanted),
        information_(fixed),
        shares_(VectorXd::Zero(static_cast<Index>(choices.size()))),
        log_sd_(LargestLogSd(fixed, wanted)) {}

  /// All that an axis has to the tone that makes the most of it.
  void Begin(std::size_t axis, double budget) {
    Step best;
    for (Index to = 0; to < shares_.size(); ++to) {
      if (At(to).axis == axis) Consider({-1, to, budget}, best);
    }
    if (best.to >= 0) Take(best);
  }

  /// The best exchange within an axis; false if there is none.
  bool Improve(std::size_t axis) {
    constexpr double kBetter = 1e-3;  // of the standard deviation
    Step best;
    for (Index from = 0; from < shares_.size(); ++from) {
      if (At(from).axis != axis || shares_[from] <= 0.0) continue;
      for (Index to = 0; to < shares_.size(); ++to) {
        if (to == from || At(to).axis != axis) continue;
        for (const double part : {1.0, 0.5, 0.25, 0.1}) {
          Consider({from, to, part * shares_[from]}, best);
        }
      }
    }
    if (best.to < 0 || best.log_sd > log_sd_ - kBetter) return false;
    Take(best);
    return true;
  }

  ToneShares Result() const { return {shares_, log_sd_}; }

 private:
  struct Step {
    Index from = -1;  ///< none: from what the axis has left
    Index to = -1;
    double share = 0.0;
    double log_sd = std::numeric_limits<double>::infinity();
  };

  const ToneChoice& At(Index i) const { return choices_[static_cast<std::size_t>(i)]; }

  MatrixXd After(const Step& step) const {
    const auto gained = [&](Index i, double share) {
      return std::pow(shares_[i] + share, 2) - std::pow(shares_[i], 2);
    };
    MatrixXd after =
        information_ + gained(step.to, step.share) * At(step.to).information;
    if (step.from >= 0)
      after += gained(step.from, -step.share) * At(step.from).information;
    return after;
  }
  void Consider(Step step, Step& best) const {
    step.log_sd = LargestLogSd(After(step), wanted_);
    if (step.log_sd < best.log_sd) best = step;
  }
  void Take(const Step& step) {
    information_ = After(step);
    shares_[step.to] += step.share;
    if (step.from >= 0)
      shares_[step.from] = std::max(0.0, shares_[step.from] - step.share);
    log_sd_ = step.log_sd;
  }

  const std::vector<ToneChoice>& choices_;
  const std::vector<Index>& wanted_;
  MatrixXd information_;
  VectorXd shares_;
  double log_sd_;
};

}  // namespace

double LargestLogSd(const MatrixXd& information, const std::vector<Index>& wanted) {
  const VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  if (!scale.allFinite()) return std::numeric_limits<double>::infinity();
  const MatrixXd inverse =
      Inverse(scale.asDiagonal() * information * scale.asDiagonal());
  double most = -std::numeric_limits<double>::infinity();
  for (const Index i : wanted) {
    if (!(inverse(i, i) >= 1.0 - 1e-6)) return std::numeric_limits<double>::infinity();
    most = std::max(most, std::log(scale[i]) + 0.5 * std::log(inverse(i, i)));
  }
  return most;
}

ToneShares ShareTones(const std::vector<ToneChoice>& choices, const MatrixXd& fixed,
                      const VectorXd& budget, const std::vector<Index>& wanted,
                      const std::function<bool()>& stop) {
  constexpr int kMostExchanges = 40;
  Exchange exchange(choices, fixed, wanted);
  const auto axes = static_cast<std::size_t>(budget.size());
  for (std::size_t axis = 0; axis < axes; ++axis) {
    const double own = budget[static_cast<Index>(axis)];
    if (own > 0.0) exchange.Begin(axis, own);
  }
  bool better = true;
  for (int i = 0; i < kMostExchanges && better && !(stop && stop()); ++i) {
    better = false;
    for (std::size_t axis = 0; axis < axes; ++axis) better |= exchange.Improve(axis);
  }
  return exchange.Result();
}

}  // namespace mjdiag
