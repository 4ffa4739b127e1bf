#include "mjdiag/plugin/replay/recorded_inputs.h"

namespace mjdiag {

using Eigen::Index;

RecordedInputs::RecordedInputs(const Machine& machine, const MeasuredRun& run)
    : run_(run),
      ticks_(run.ticks()),
      substeps_(machine.rates().substeps / static_cast<int>(ticks_)) {
  Index i = 0;
  for (const ActuatorSetup& actuator : machine.channels().actuators) {
    courses_.emplace_back(actuator.hold, run.EveryInput().row(i++).transpose(),
                          substeps_);
  }
}

void RecordedInputs::Tick(std::span<const double> /*outputs*/,
                          std::span<double> inputs) noexcept {
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    inputs[i] = run_.inputs(static_cast<Index>(i), tick_);
  }
  now_ = tick_;
  if (goes_on_) ++tick_;
}

double RecordedInputs::Above(std::size_t actuator, int substep) const noexcept {
  if (ticks_ == 1) return courses_[actuator].Above(now_, substep);
  const Index tick = now_ * ticks_ + substep / substeps_;
  const auto i = static_cast<Index>(actuator);
  return run_.finer_inputs(i, tick) - run_.inputs(i, now_) +
         courses_[actuator].Above(tick, substep % substeps_);
}

bool RecordedInputs::IsOn(std::size_t actuator) const noexcept {
  return run_.on.size() == 0 || run_.on(static_cast<Index>(actuator), now_) != 0.0;
}

}  // namespace mjdiag
