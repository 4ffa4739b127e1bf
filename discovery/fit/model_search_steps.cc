// Which physics steps the run of a model search knows (physics_steps.h).

#include <algorithm>
#include <cstdio>
#include <optional>
#include <utility>
#include <vector>

#include "mjdiag/discovery/fit/converged_model.h"
#include "mjdiag/discovery/fit/model_search.h"
#include "mjdiag/discovery/regression/moves.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Steps that are known cost nothing; a share of them is a number.
double PriceOf(double without) {
  constexpr double kPriceOfShare = 2.0;
  return without == 0.0 || without == 1.0 ? 0.0 : kPriceOfShare;
}

}  // namespace

// By first order, which of steps is exact. Values make up for steps as far as they can, so that
// both are asked at once: with W what values do, r what is left and o what other steps do,
// the share p of o is least squares behind a projection,
//
//   p = o^T M r / o^T M o,    M = I - W (W^T W + L)^-1 W^T,
//
// L what is known of the values.
ModelSearch::StepsBehind ModelSearch::LikelySteps(const Standing& standing,
                                                  std::size_t noise) const {
  const Whitening& map = standing.whitenings.behind[noise];
  std::vector<const Column*> columns;
  std::vector<double> sd, mean;
  for (const Term& term : standing.exact.terms) {
    for (std::size_t i = 0; i < term.columns.size(); ++i) {
      columns.push_back(&term.columns[i]);
      sd.push_back(term.sd[static_cast<Eigen::Index>(i)]);
      mean.push_back(term.mean[static_cast<Eigen::Index>(i)]);
    }
  }
  const auto count = std::ssize(columns);
  columns.push_back(&standing.exact.other_steps);
  const MatrixXd whitened = map.Of(columns);
  const auto W = whitened.leftCols(count);
  const VectorXd other = whitened.col(count);
  double bend = other.squaredNorm();
  double slope = other.dot(map.left());
  if (count > 0) {
    const VectorXd known = VectorXd::Map(sd.data(), count).cwiseAbs2().cwiseInverse();
    const MatrixXd H = MatrixXd(W.transpose() * W) + MatrixXd(known.asDiagonal());
    const VectorXd both = W.transpose() * other;
    const VectorXd made_up = H.ldlt().solve(both);
    bend -= made_up.dot(both);
    slope -= made_up.dot(W.transpose() * map.left() +
                         known.cwiseProduct(VectorXd::Map(mean.data(), count)));
  }
  StepsBehind likeliest{steps_, 0.0};
  // Of steps that values make up for nothing is known.
  constexpr double kSeen = 1e-6;
  if (!(bend > kSeen * other.squaredNorm())) return likeliest;
  // As far as there are steps to take away, or to give back.
  const double whole = steps_.Other().without - steps_.without;
  const auto gain = [&](double without) {
    const double part = (without - steps_.without) / whole;
    return 2.0 * part * slope - part * part * bend - PriceOf(without) +
           PriceOf(steps_.without);
  };
  const double least = steps_.without + whole * slope / bend;
  for (const double without : {0.0, 1.0, std::clamp(least, 0.0, 1.0)}) {
    if (gain(without) > likeliest.gain) {
      likeliest = {{without, steps_.finer}, gain(without)};
    }
  }
  return likeliest;
}

/// What makes up for steps are latent forces, too: behind smaller ones other steps may be
/// likelier.
bool ModelSearch::TakeStepsBehind(const Standing& standing, std::size_t noise) {
  for (const std::size_t behind : {std::size_t{0}, noise}) {
    const StepsBehind likely = LikelySteps(standing, behind);
    if (likely.gain > kLeastGain &&
        TakeSteps(likely, standing.whitenings.noises[behind])) {
      return true;
    }
    if (noise == 0) break;
  }
  return false;
}

bool ModelSearch::TakeSteps(const StepsBehind& likely, const FilterNoise& near) {
  auto settled = SettleRivals(Beside(likely.steps), {found_.fit}, NoisesBeside(near),
                              found_.score, likely.gain);
  const double price = PriceOf(likely.steps.without) - PriceOf(steps_.without);
  const bool is_better =
      settled.front() && settled.front()->score() + price < found_.score - kLeastGain;
  if (!is_better) return false;
  SayOf(likely.steps, settled.front()->score());
  steps_ = likely.steps;
  Take(std::move(*settled.front()));
  return true;
}

// What is of second order in them is of no law: it comes before one that explains less. Asking
// takes as long as some runs, and all runs take as many times longer then.
bool ModelSearch::ChooseFinerSteps(double beat) {
  constexpr int kFiner = 4;  // 16 times less of second order
  constexpr int kFinest = 16;
  constexpr double kShareOfTime = 0.05;
  if (steps_.AreGiven() || steps_.finer == kFinest) return false;
  if (kFiner * seconds_of_run_ > kShareOfTime * (seconds_ - time_.Seconds())) {
    return false;
  }
  // What is large is not of second order.
  constexpr double kLittle = 0.1;  // of what all did
  const bool is_little =
      found_.score - beat < kLittle * (found_.nothing.deviance - found_.score);
  if (!found_.fit.model.empty() && !is_little) return false;
  // Of steps as long as those of the run nothing is left to take away.
  const double own = 1.0 - steps_.without;
  const PhysicsSteps finer{std::max(0.0, 1.0 - kFiner * own), kFiner * steps_.finer};
  FilterPath path;
  try {
    path = RunForceFilter(With(found_.fit.model, finer), run_, found_.path.dofs,
                          found_.path.starts, found_.path.noise);
  } catch (const NumericalError&) {
    return false;
  }
  // Values that make up for steps hide them: they are fitted anew.
  const bool may_hide = !found_.fit.model.empty();
  if (!may_hide && found_.path.deviance - path.deviance < kLeastGain) return false;
  ConvergedModel settled = SettleNear(Beside(finer), found_.fit, std::move(path));
  if (settled.score() > beat) return false;
  Say("finer steps: " + Difference(settled.score()));
  steps_ = finer;
  Take(std::move(settled));
  return true;
}

void ModelSearch::SayOf(PhysicsSteps steps, double score) const {
  char text[80];
  std::snprintf(text, sizeof text, "steps %.3f of %d: ", 1.0 - steps.without,
                steps.finer);
  Say(text + Difference(score));
}

}  // namespace mjdiag
