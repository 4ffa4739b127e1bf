#pragma once
// Drives a machine with what was recorded, sample by sample or at any one of them.

#include <span>
#include <vector>

#include "mjdiag/plugin/machine/input_course.h"
#include "mjdiag/plugin/machine/stepper.h"
#include "mjdiag/plugin/replay/tracking.h"

namespace mjdiag {

class RecordedInputs final : public TickControl {
 public:
  /// The run has to outlive it.
  RecordedInputs(const Machine& machine, const MeasuredRun& run);

  /// Every tick is that sample of the run, until told otherwise.
  void StayAt(Eigen::Index sample) {
    tick_ = sample;
    goes_on_ = false;
  }
  void Tick(std::span<const double> outputs,
            std::span<double> inputs) noexcept override;
  double Above(std::size_t actuator, int substep) const noexcept override;
  bool IsOn(std::size_t actuator) const noexcept override;

 private:
  const MeasuredRun& run_;
  std::vector<InputCourse> courses_;
  Eigen::Index ticks_;  // of a sample
  int substeps_;        // of such a tick
  Eigen::Index tick_ = 0;
  Eigen::Index now_ = 0;
  bool goes_on_ = true;
};

}  // namespace mjdiag
