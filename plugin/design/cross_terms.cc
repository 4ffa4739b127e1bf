#include "mjdiag/plugin/design/cross_terms.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/plugin/design/monitor_observer.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A leak is known to a tenth or so, as it goes with squares of deviations. One that is
/// small beside the estimate explains nothing, however uncertain both are.
bool Explains(double leak, const FaultVerdict& fault, double reach) {
  constexpr double kShare = 0.1;
  return std::abs(fault.deviation - leak) <=
             reach * fault.sd + kShare * std::abs(leak) &&
         std::abs(leak) > 0.5 * std::abs(fault.deviation);
}

/// Faults of the plant, by the place of their parameter.
struct Named {
  std::size_t parameter = 0;
  double deviation = 0.0;  // from healthy
};

class Simulator {
 public:
  Simulator(const DiagnosisDesign& design, const Machine& machine,
            const DiagnosedMotion& motion)
      : design_(design), machine_(machine), motion_(motion), healthy_(Estimates({})) {}

  /// D(f), a fault each.
  VectorXd EstimatesOf(const std::vector<Named>& named) const {
    return Estimates(named) - healthy_;
  }

 private:
  VectorXd Estimates(const std::vector<Named>& named) const {
    DiagnosisMonitor monitor(design_, motion_.baseline);
    monitor.RegressFrom(motion_.first_regressed);
    MonitorObserver observer(monitor);
    RunOptions options;
    options.seed = motion_.runs.seed;
    Changes changes;
    for (const Named& fault : named) {
      changes.faults.push_back(
          {design_.bank.faults[fault.parameter], 1.0 + fault.deviation});
    }
    RunWith(machine_.With(changes), motion_.excitation, observer, options,
            motion_.runs.linear);
    return monitor.estimator().Estimate().value;
  }

  const DiagnosisDesign& design_;
  const Machine& machine_;
  const DiagnosedMotion& motion_;
  VectorXd healthy_;
};

class CrossTerms {
 public:
  CrossTerms(const std::vector<FaultVerdict>& faults, std::size_t parameters)
      : faults_(faults),
        parameters_(parameters),
        reach_(
            TwoSidedNormalQuantile(kFalseFault / static_cast<double>(faults.size()))),
        leaks_(VectorXd::Zero(static_cast<Index>(faults.size()))) {}

  const std::vector<Named>& named() const { return named_; }

  bool IsNamed(std::size_t i) const {
    return std::ranges::find(named_, i, &Named::parameter) != named_.end();
  }

  bool IsCrossTerm(std::size_t i) const {
    return faults_[i].detected && !IsNamed(i) && Explains(Leak(i), faults_[i], reach_);
  }

  /// Of what cross terms do not explain, the strongest that a plant can have is named;
  /// false if there is none. Disturbances come after the parameters and are not named.
  bool NameNext() {
    std::optional<Named> next;
    double most = 0.0;
    for (std::size_t i = 0; i < parameters_; ++i) {
      const double rest = faults_[i].deviation - Leak(i);
      const double strength = std::abs(rest) / faults_[i].sd;
      if (!faults_[i].detected || IsNamed(i) || IsCrossTerm(i) || rest <= -1.0 ||
          strength <= most) {
        continue;
      }
      most = strength;
      next = Named{i, rest};
    }
    if (next) named_.push_back(*next);
    return next.has_value();
  }

  /// Takes what a run with the named faults shows; true if these have settled. Their
  /// estimates are matched by Broyden's method, in units of their standard deviations.
  bool Learn(const VectorXd& estimates) {
    leaks_ = estimates;
    const auto count = static_cast<Index>(named_.size());
    VectorXd place(count);
    VectorXd missed(count);
    for (Index k = 0; k < count; ++k) {
      const Named& fault = named_[static_cast<std::size_t>(k)];
      const FaultVerdict& seen = faults_[fault.parameter];
      place[k] = fault.deviation / seen.sd;
      missed[k] = (Leak(fault.parameter) - seen.deviation) / seen.sd;
    }
    if (place_.size() != count) {
      jacobian_ = MatrixXd::Identity(count, count);
    } else if (place != place_) {  // a parameter at its least may not have moved
      const VectorXd step = place - place_;
      jacobian_ +=
          (missed - missed_ - jacobian_ * step) * step.transpose() / step.squaredNorm();
    }
    place_ = place;
    missed_ = missed;
    const VectorXd change = -Solve(jacobian_, missed);
    bool settled = true;
    for (Index k = 0; k < count; ++k) {
      Named& fault = named_[static_cast<std::size_t>(k)];
      const double most = kLongest * std::abs(fault.deviation);
      const double sd = faults_[fault.parameter].sd;
      const double step = std::clamp(sd * change[k], -most, most);
      settled = settled && std::abs(step) < kSettled * sd;
      fault.deviation = std::max(fault.deviation + step, kLeast - 1.0);
    }
    return settled;
  }

 private:
  static constexpr double kSettled = 0.5;  // of the standard deviation
  static constexpr double kLongest = 0.5;  // a step, of the deviation
  static constexpr double kLeast = 0.01;   // of a fault parameter

  double Leak(std::size_t i) const { return leaks_[static_cast<Index>(i)]; }

  const std::vector<FaultVerdict>& faults_;
  std::size_t parameters_;
  double reach_;
  std::vector<Named> named_;
  VectorXd leaks_;
  // Of the last step: where it began, in standard deviations, what was missed there,
  // and the Jacobian of what is missed as it has been learned.
  VectorXd place_;
  VectorXd missed_;
  MatrixXd jacobian_;
};

}  // namespace

void RemoveCrossTerms(DiagnosisResult& result, const DiagnosisDesign& design,
                      const Machine& machine, const DiagnosedMotion& motion) {
  constexpr int kRuns = 16;
  CrossTerms terms(result.faults, design.bank.faults.size());
  if (!terms.NameNext()) return;
  try {
    const Simulator simulator(design, machine, motion);
    int left = kRuns;
    // Before the strong ones have settled nobody knows what is left of the weak.
    while (!terms.Learn(simulator.EstimatesOf(terms.named())) || terms.NameNext()) {
      if (--left == 0) return;
    }
  } catch (const NumericalError&) {
    return;  // a plant with such faults does not run
  }
  std::vector<FaultVerdict> faults = result.faults;
  for (std::size_t i = 0; i < faults.size(); ++i) {
    if (!terms.IsCrossTerm(i)) continue;
    faults[i].cross_term = true;
    faults[i].detected = false;
  }
  for (const Named& named : terms.named()) {
    FaultVerdict& fault = faults[named.parameter];
    const double shift = named.deviation - fault.deviation;
    fault.deviation += shift;
    fault.value += shift;
    fault.ci95 = {fault.ci95.min + shift, fault.ci95.max + shift};
  }
  result.faults = faults;
}

}  // namespace mjdiag
