#include "mjdiag/discovery/sets/likelihood.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Of the control rate. Beyond it an observer follows the noise of its sensors.
constexpr double kFastest = 0.15;
constexpr double kStep = 3.0;

std::vector<double> BandwidthsDownTo(double slowest, double rate) {
  std::vector<double> bandwidths;
  for (double hertz = kFastest * rate; hertz > 1.5 * slowest; hertz /= kStep) {
    bandwidths.push_back(hertz);
  }
  bandwidths.push_back(slowest);
  return bandwidths;
}

}  // namespace

ObserverLadder::ObserverLadder(const DiscoveryProblem& problem) {
  const Machine& machine = problem.machine();
  const VectorXd& r = problem.observer().noise_sd;
  // A machine that leaves its rest does not stay beside slower ones.
  const std::shared_ptr<const FollowingGain>& following = problem.observer().following;
  const double slowest =
      following ? problem.observer().bandwidth : SlowestBandwidth(problem.run());
  bandwidths_ = BandwidthsDownTo(slowest, machine.rates().control);
  for (const double hertz : bandwidths_) {
    Observer observer = DesignObserver(machine, problem.run(), r, hertz,
                                       following ? following->path : nullptr);
    const VectorXd S = observer.innovation_covariance.diagonal();
    observer.innovation_sd = S.cwiseSqrt();
    logarithms_.push_back(S.cwiseQuotient(r.cwiseAbs2()).array().log());
    problems_.push_back(DiscoveryProblem(machine, std::move(observer), problem.run(),
                                         problem.skip(), problem.train())
                            .Charging(problem.work())
                            .Doubting(problem.numbers()));
  }
  const double ticks = problem.MeasuredValues(problem.skip(), problem.train()) /
                       static_cast<double>(r.size());
  noise_ = ticks * (logarithms_.back().sum() + static_cast<double>(r.size()));
}

ObserverLadder ObserverLadder::WithSubsteps(int substeps) const {
  const DiscoveryProblem& slowest = problems_.back();
  const Machine machine = slowest.machine().WithSubsteps(substeps);
  return ObserverLadder(DiscoveryProblem(machine, slowest.observer(), slowest.run(),
                                         slowest.skip(), slowest.train())
                            .Charging(slowest.work())
                            .Doubting(InStepsOf(machine, slowest.numbers())));
}

double ObserverLadder::Deviance(std::size_t rung, const VectorXd& residual, Index first,
                                Index last) const {
  const DiscoveryProblem& problem = problems_[rung];
  const Index channels = logarithms_[rung].size();
  const double ticks =
      problem.MeasuredValues(first, last) / static_cast<double>(channels);
  return ticks * logarithms_[rung].sum() +
         residual.segment(channels * first, channels * (last - first)).squaredNorm();
}

double ObserverLadder::Deviance(std::size_t rung, const VectorXd& residual) const {
  return Deviance(rung, residual, problems_[rung].skip(), problems_[rung].train());
}

double ObserverLadder::HeldOut(std::size_t rung, const VectorXd& residual) const {
  return Deviance(rung, residual, problems_[rung].train(),
                  problems_[rung].run().samples());
}

}  // namespace mjdiag
