#include "mjdiag/discovery/comparison/derived.h"

#include "mjdiag/discovery/comparison/mismatch.h"
#include "mjdiag/signals/butterworth.h"
#include "mjdiag/signals/derivative.h"
#include "mjdiag/signals/zero_phase.h"

namespace mjdiag {
namespace {

Eigen::VectorXd LowPassed(const Eigen::VectorXd& x, double sample_time,
                          const CompareSetup& compare) {
  if (compare.low_pass_order == 0) return x;
  return FilterZeroPhase(
      DigitalButterworth(FilterKind::kLowPass, compare.low_pass_order,
                         compare.low_pass_cutoff, sample_time),
      x);
}

}  // namespace

Record DeriveChannels(const Record& record, const std::vector<std::string>& positions,
                      const CompareSetup& compare) {
  const double step = record.sample_time();
  Record derived(step, record.start_time());
  for (const std::string& name : positions) {
    const Channel& position = record.At(name);
    const Eigen::VectorXd velocity =
        CentralDifference(LowPassed(position.samples, step, compare), step);
    const Eigen::VectorXd acceleration = CentralDifference(velocity, step);
    derived.Add(
        {name + "_velocity", position.unit + "/s", velocity, position.measured});
    derived.Add({name + "_acceleration", position.unit + "/s^2", acceleration,
                 position.measured});
  }
  for (const CompareSetup::Derived& force : compare.forces) {
    if (const Channel* actuator = record.Find(force.channel)) {
      derived.Add({force.name, force.unit, force.factor * actuator->samples,
                   actuator->measured});
    }
  }
  return derived;
}

std::vector<DerivedMismatch> MeasureDerived(const Record& measured,
                                            const Record& simulated,
                                            Eigen::Index skip) {
  std::vector<DerivedMismatch> result;
  for (const Channel& y : measured.channels()) {
    const Channel& yhat = simulated.At(y.name);
    result.push_back({y.name, y.unit, Rms(MismatchOf(y, yhat, skip)),
                      RelativeErrorPercent(y, yhat, skip)});
  }
  return result;
}

}  // namespace mjdiag
