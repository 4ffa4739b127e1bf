#include "mjdiag/plugin/design/number_learner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "mjdiag/diagnosis/twin/information.h"
#include "mjdiag/plugin/design/machine_twin.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/noise_level.h"
#include "mjdiag/signals/record.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Of the largest information of a direction, what rounding leaves of another.
constexpr double kRounding = 1e-15;
/// A step of logarithms that is large compared with rounding.
constexpr double kLeastStep = 1e-4;

/// The plant with these logarithms of factors in it.
Machine WithNumbers(const Machine& machine, const UncertaintyOptions& options,
                    const VectorXd& theta) {
  const UncertainMachine uncertain = MakeUncertainMachine(machine, options);
  NumberFactors factors;
  for (Index i = 0; i < theta.size(); ++i) {
    factors.emplace_back(
        FindModelParameter(machine.plant(),
                           uncertain.unknowns[static_cast<std::size_t>(i)].name),
        std::exp(theta[i]));
  }
  return machine.WithNumbers(factors);
}

}  // namespace

VectorXd MeasuredReadings(const MatrixXd& outputs, Index sensor) {
  const VectorXd all = outputs.row(sensor);
  const SampleMask measured = !all.array().isNaN();
  return measured.all() ? all : Kept(all, measured);
}

NumberLearner::NumberLearner(const Machine& machine, const VectorXd& noise,
                             const std::vector<RunSamples>& runs, bool linear,
                             const UncertaintyOptions& beside, const VectorXd& before)
    : before_(before), own_(VectorXd::Zero(before.size())) {
  UncertaintyOptions options = beside;
  options.friction = !linear;
  const Machine with = WithNumbers(machine, options, before).WithSensorNoise(noise);
  for (const RunSamples& run : runs) {
    MachineTwin twin = MakeTwin(with, linear, options);
    const Index n = before.size();
    unknowns_.assign(twin.unknowns.begin(), twin.unknowns.begin() + n);
    known_ = CovarianceOf(PriorOf(unknowns_));
    gains_ = twin.twin->gains();
    passes_.push_back(std::make_shared<RunPass>(std::move(twin.twin), run.outputs,
                                                run.inputs, PriorOf(twin.unknowns)));
  }
  H_ = known_;
}

MatrixXd NumberLearner::Root() const {
  // By its modes in units of its diagonal: those that hardly anything is known of are
  // as well found as the others.
  const ScaledEigenPairs modes = ScaledEigenDecomposition(H_);
  const VectorXd information =
      modes.values.cwiseMax(kRounding * modes.values.maxCoeff());
  return modes.scale.cwiseInverse().asDiagonal() * modes.vectors *
         information.cwiseSqrt().cwiseInverse().asDiagonal();
}

void NumberLearner::Learn(std::size_t gain, bool rough) {
  constexpr int kMostPasses = 12;
  // Squared, in standard deviations of the estimate.
  const double near = rough ? 100.0 : 0.1;
  double before = std::numeric_limits<double>::infinity();
  // A logarithm moves no farther at once.
  constexpr double kLongest = 0.5;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    ++done_;
    said_.resize(passes_.size());
    ParallelFor(static_cast<int>(passes_.size()), [&](int i) {
      const auto at = static_cast<std::size_t>(i);
      said_[at] = passes_[at]->About(own_, gain);
    });
    MatrixXd H = known_;
    VectorXd g = -known_ * theta();
    // Errors that are left count as noise: far from the solution, what is hardly known
    // must not be bent to explain them.
    for (const RunInformation& said : said_) {
      H += said.H / std::max(1.0, said.nis);
      g += said.g / std::max(1.0, said.nis);
    }
    H_ = H;
    VectorXd change = CovarianceOf(H) * g;
    diverged_ = !change.allFinite();
    if (diverged_) return;
    const double squared = change.dot(g);
    const double farthest = change.cwiseAbs().maxCoeff();
    if (farthest > kLongest) change *= kLongest / farthest;
    // Nor does it help to go on where only rounding is left.
    if (squared < near || (farthest < kLeastStep && squared > 0.5 * before)) break;
    before = squared;
    own_ += change;
  }
}

double NumberLearner::Excess() const {
  if (diverged_) return std::numeric_limits<double>::infinity();
  double excess = 0.0;
  for (const RunInformation& said : said_) excess = std::max(excess, said.excess);
  return excess;
}

double NumberLearner::Nis() const {
  double sum = 0.0;
  for (const RunInformation& said : said_) sum += said.nis;
  return sum / static_cast<double>(said_.size());
}

VectorXd NumberLearner::Noise() const {
  VectorXd noise = VectorXd::Zero(gains_.front().covariance.rows());
  for (const RunInformation& said : said_) {
    for (Index i = 0; i < noise.size(); ++i) {
      noise[i] += NoiseLevel(MeasuredReadings(said.innovations, i), 1) /
                  static_cast<double>(said_.size());
    }
  }
  return noise;
}

SoftestLearner LearnSoftest(
    NumberLearner learner, const std::function<NumberLearner(const VectorXd&)>& about,
    double excess, const std::function<bool(std::size_t gain, int passes)>& goes_on) {
  const std::size_t stiffest = learner.stiffest();
  SoftestLearner found{std::move(learner), stiffest, 0};
  // At once, or step by step.
  for (std::size_t next = 0; found.gain > 0; next = found.gain - 1) {
    NumberLearner softer = about(found.learner.theta());
    softer.Learn(next, true);
    found.passes += softer.passes();
    if (softer.Excess() <= excess) {
      found.learner = std::move(softer);
      found.gain = next;
    } else if (next + 1 == found.gain) {
      break;
    }
    if (goes_on && !goes_on(found.gain, found.passes)) break;
  }
  return found;
}

}  // namespace mjdiag
