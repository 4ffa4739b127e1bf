#include "mjdiag/watch/judge/tick_judge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mjdiag/plugin/runtime/running_machine.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

/// The linear bonder at work, watched.
class TickJudgeTest : public testing::Test, public TickObserver {
 protected:
  void SetUp() override {
    RunOptions run;
    run.repeat = true;
    run.observer = this;
    running_ = StartLinear(*machine, DefaultMotion(machine->setup()), run);
    judge_.OnNewRun();
  }

  void OnTick(std::span<const double> outputs,
              std::span<const double> inputs) noexcept override {
    values_.assign(outputs.begin(), outputs.end());
    values_.insert(values_.end(), inputs.begin(), inputs.end());
  }

  /// That many seconds of the machine.
  void Watch(double seconds) {
    for (double end = time_ + seconds; time_ < end; time_ += kTick) {
      running_->Tick();
      judge_.OnTick({1, number_++, kMissing, 1000.0 + time_}, values_);
    }
  }
  /// Ticks that never come.
  void Lose(int ticks) {
    for (int k = 0; k < ticks; ++k, time_ += kTick) running_->Tick();
    number_ += ticks;
    judge_.OnMissing(ticks);
  }
  const Finding& last() const { return looks_.back(); }
  const FaultVerdict& Fault(const std::string& name) const {
    for (const FaultVerdict& fault : last().result.faults) {
      if (fault.name == name) return fault;
    }
    throw std::runtime_error("no fault " + name);
  }

  static constexpr double kTick = 1.25e-4;

  static void SetUpTestSuite() {
    machine = std::make_unique<Machine>(test::Bonder());
    DiagnosisSource source;
    source.nominal.linear = true;
    prepared = std::make_unique<PreparedDiagnosis>(PrepareDiagnosis(*machine, source));
  }
  static void TearDownTestSuite() {
    prepared.reset();
    machine.reset();
  }

  inline static std::unique_ptr<Machine> machine;
  inline static std::unique_ptr<PreparedDiagnosis> prepared;
  std::vector<Finding> looks_;
  TickJudge judge_{*machine, *prepared, JudgeOptions{},
                   [this](const Finding& look) { looks_.push_back(look); }};
  std::unique_ptr<RunningMachine> running_;
  std::vector<double> values_;
  double time_ = 0.0;
  std::int64_t number_ = 0;
};

TEST_F(TickJudgeTest, LooksTenTimesASecondAndFindsNothingOnAHealthyMachine) {
  Watch(20.0);
  EXPECT_EQ(looks_.size(), 200U);
  for (const Finding& look : looks_) {
    const bool early = look.run_time < 2.0 - kTick;
    EXPECT_EQ(look.kind, early ? VerdictKind::kSettling : VerdictKind::kHealthy)
        << look.run_time << " s: " << look.words;
  }
}

TEST_F(TickJudgeTest, NamesAFaultThatAppears) {
  Watch(10.0);
  running_->Become(machine->With({{{"zeta_x", 1.2}}, {}}));
  Watch(20.0);
  EXPECT_EQ(last().kind, VerdictKind::kFault) << last().words;
  EXPECT_TRUE(Fault("zeta_x").detected);
  EXPECT_NEAR(Fault("zeta_x").value, 1.2, 5.0 * Fault("zeta_x").sd);
  EXPECT_FALSE(Fault("eta_x").detected);
}

TEST_F(TickJudgeTest, FindsAFaultAgainWhoseTwinHasLostTheMachine) {
  Watch(4.0);
  running_->Become(machine->With({{{"zeta_x", 1.2}}, {}}));
  Watch(16.0);
  EXPECT_EQ(last().kind, VerdictKind::kFault) << last().words;
  EXPECT_TRUE(Fault("zeta_x").detected);
}

TEST_F(TickJudgeTest, BeginsAnewBehindAGapAndSaysNothingWrong) {
  Watch(5.0);
  Lose(777);
  Watch(4.0);
  Lose(1);
  Watch(4.0);
  EXPECT_GE(judge_.runs(), 3);  // and where another opinion was wanted
  for (const Finding& look : looks_) {
    EXPECT_TRUE(look.kind == VerdictKind::kHealthy ||
                look.kind == VerdictKind::kSettling)
        << look.time << ": " << look.words;
  }
}

TEST_F(TickJudgeTest, FindsAFaultInARunThatBeginsInMotion) {
  running_->Become(machine->With({{{"zeta_x", 1.2}}, {}}));
  for (int k = 0; k < 1234; ++k) running_->Tick();
  Watch(20.0);
  EXPECT_EQ(last().kind, VerdictKind::kFault) << last().words;
  EXPECT_NEAR(Fault("zeta_x").value, 1.2, 5.0 * Fault("zeta_x").sd);
}

// Its twin sees a hundred thousandth, and no residual does.
TEST_F(TickJudgeTest, WhatARunInMotionNamesWithoutAnAlarmASecondHasToNameToo) {
  running_->Become(machine->With({{{"eta_x", 1.00001}}, {}}));
  for (int k = 0; k < 1234; ++k) running_->Tick();
  Watch(2.05);
  EXPECT_TRUE(Fault("eta_x").detected);
  running_->Become(*machine);
  Watch(8.0);
  EXPECT_EQ(judge_.runs(), 2);
  EXPECT_EQ(last().kind, VerdictKind::kHealthy) << last().words;
  for (const Finding& look : looks_) EXPECT_NE(look.kind, VerdictKind::kFault);
}

TEST_F(TickJudgeTest, WhatASecondNamesTooIsNamed) {
  running_->Become(machine->With({{{"eta_x", 1.00001}}, {}}));
  for (int k = 0; k < 1234; ++k) running_->Tick();
  Watch(5.0);
  EXPECT_EQ(judge_.runs(), 2);
  EXPECT_EQ(last().kind, VerdictKind::kFault) << last().words;
  EXPECT_TRUE(Fault("eta_x").detected);
}

TEST_F(TickJudgeTest, DoesWithoutReadingsThatAreMissing) {
  Watch(5.0);
  for (int k = 0; k < 10; ++k) {
    Watch(1.0);
    running_->Tick();
    time_ += kTick;
    judge_.OnTick({1, number_++, kMissing, 1000.0 + time_},
                  std::vector<double>{kMissing, values_[1], values_[2], values_[3],
                                      values_[4], values_[5]});
  }
  EXPECT_EQ(judge_.runs(), 1);
  EXPECT_EQ(last().kind, VerdictKind::kHealthy) << last().words;
}

TEST_F(TickJudgeTest, ACommandThatIsMissingIsATickThatIs) {
  Watch(5.0);
  running_->Tick();
  time_ += kTick;
  values_.back() = kMissing;
  judge_.OnTick({1, number_++, kMissing, 1000.0 + time_}, values_);
  Watch(1.0);
  EXPECT_EQ(judge_.runs(), 2);
}

}  // namespace
}  // namespace mjdiag
