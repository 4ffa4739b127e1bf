#include "mjdiag/plugin/replay/recorded_inputs.h"

namespace mjdiag {

using Eigen::Index;

RecordedInputs::RecordedInputs(const Machine& machine, const MeasuredRun& run)
    : run_(run) {
  Index i = 0;
  for (const ActuatorSetup& actuator : machine.channels().actuators) {
    courses_.emplace_back(actuator.hold, run.inputs.row(i++).transpose(),
                          machine.rates().substeps);
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
  return courses_[actuator].Above(now_, substep);
}

bool RecordedInputs::IsOn(std::size_t actuator) const noexcept {
  return run_.on.size() == 0 || run_.on(static_cast<Index>(actuator), now_) != 0.0;
}

}  // namespace mjdiag
