#include "mjdiag/plugin/design/machine_twin.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/plugin/runtime/running_machine.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

using testing::Each;

/// A machine at work and a twin that begins beside it in mid-motion.
class TwinOfARunningMachine : public TickObserver {
 public:
  TwinOfARunningMachine(const Machine& machine, int start)
      : twin_(MakeTwinEstimator(machine, true)) {
    RunOptions run;
    run.repeat = true;
    run.observer = this;
    running_ = StartLinear(machine, DefaultMotion(machine.setup()), run);
    for (int k = 0; k < start; ++k) running_->Tick();
    listens_ = true;
  }
  void OnTick(std::span<const double> outputs,
              std::span<const double> inputs) noexcept override {
    if (listens_) twin_->Add(outputs, inputs);
  }
  void Run(int ticks) {
    for (int k = 0; k < ticks; ++k) running_->Tick();
  }
  const TwinEstimator& twin() const { return *twin_; }

 private:
  std::unique_ptr<TwinEstimator> twin_;
  std::unique_ptr<RunningMachine> running_;
  bool listens_ = false;
};

// Both are told by nearly the same readings, and what rounding leaves of their difference
// was taken for growth of all faults at once, three seconds behind these starts.
TEST(LinearTwin, DoesNotTakeAStartThatItDoesNotKnowForGrowth) {
  const Machine machine = test::Bonder();
  for (const int start : {137284, 802099}) {
    TwinOfARunningMachine run(machine, start);
    run.Run(16000);
    for (int ticks = 16000; ticks < 30000; ticks += 200) {
      run.Run(200);
      ASSERT_THAT(run.twin().Read().named, Each(false)) << start << " + " << ticks;
    }
    EXPECT_FALSE(run.twin().estimator().following());
    EXPECT_EQ(run.twin().estimator().since(), 0);
  }
}

}  // namespace
}  // namespace mjdiag
