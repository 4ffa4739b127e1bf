#include "mjdiag/controllers/reconfiguration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "mjdiag/signals/error.h"
#include "support/count_allocations.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kTick = 1e-3;  // s
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Two axes: a motor that weakens, a damper, a spring and a tone of 50 Hz.
struct Bench {
  std::vector<RemediedAxis> axes{
      {.drive_gain = 2.0, .least_gain = 0.5, .most_gain = 1.6},
      {.drive_gain = 4.0, .rest = 0.25}};
  std::vector<FaultRemedy> remedies = [] {
    std::vector<FaultRemedy> all(4);
    all[0].fault = "motor";
    all[0].drives = {0};
    all[0].least = -0.8;
    all[0].most = 1.0;
    all[1].fault = "damper";
    all[1].forces.velocity = Eigen::Matrix2d{{10.0, 1.0}, {0.0, 20.0}};
    all[2].fault = "spring";
    all[2].law = ForceLaw::kCompliance;
    all[2].forces.position = Eigen::Matrix2d{{0.0, 0.0}, {0.0, 8.0}};
    all[3].fault = "tone";
    all[3].least = 0.0;
    all[3].tones = {{50.0, Eigen::Vector2d(3.0, 0.0)}};
    return all;
  }();
  ReconfigurationOptions options{.sample_time = kTick,
                                 .sigmas = 5.0,
                                 .time_constant = 0.02,
                                 .persistence = 0.01,
                                 .patience = 0.05};

  Reconfiguration Make() const { return {axes, remedies, options}; }
};

enum Place { kMotor, kDamper, kSpring, kTone };

/// Ticks with the same estimates.
void Observe(Reconfiguration& reconfiguration, const FaultEstimates& estimates,
             int ticks) {
  for (int k = 0; k < ticks; ++k) reconfiguration.Observe(estimates);
}

constexpr int kLong = 2000;
constexpr std::array<ReferenceSample, 2> kMoving{
    {{.position = 1.0, .velocity = 2.0}, {.position = 1.25, .velocity = -3.0}}};

TEST(Reconfiguration, LeavesAHealthyMachineUnchangedToTheLastBit) {
  Reconfiguration reconfiguration = Bench().Make();
  FaultEstimates estimates = reconfiguration.MakeEstimates();
  for (const double sd : {kNaN, 1.0, 1e-3}) {
    estimates.sd.setConstant(sd);
    estimates.deviation.setConstant(4.9e-3);  // 4.9 sd at the smallest
    Observe(reconfiguration, estimates, kLong);
    for (const AxisCorrection& axis : reconfiguration.Correct(kMoving)) {
      EXPECT_EQ(axis.gain, 1.0);
      EXPECT_EQ(axis.addition, 0.0);
    }
  }
  for (const RemedyState& state : reconfiguration.states()) EXPECT_EQ(state.since, -1);
}

TEST(Reconfiguration, DrivesAWeakMotorHarderInsideTheMarginsOfItsLoop) {
  Reconfiguration reconfiguration = Bench().Make();
  FaultEstimates estimates = reconfiguration.MakeEstimates();
  estimates.sd.setConstant(1e-3);
  for (const auto& [deviation, gain] :
       {std::pair{-0.2, 1.25}, {-0.5, 1.6}, {0.25, 0.8}, {5.0, 0.5}, {0.0, 1.0}}) {
    estimates.deviation[kMotor] = deviation;
    Observe(reconfiguration, estimates, kLong);
    EXPECT_NEAR(reconfiguration.Correct(kMoving)[0].gain, gain, 1e-9) << deviation;
    EXPECT_EQ(reconfiguration.Correct(kMoving)[1].gain, 1.0);
  }
}

TEST(Reconfiguration, PushesAgainstFrictionAlongTheReference) {
  Reconfiguration reconfiguration = Bench().Make();
  FaultEstimates estimates = reconfiguration.MakeEstimates();
  estimates.sd.setConstant(1e-3);
  estimates.deviation[kDamper] = 0.5;
  Observe(reconfiguration, estimates, kLong);
  const auto corrections = reconfiguration.Correct(kMoving);
  EXPECT_NEAR(corrections[0].addition, 0.5 * (10.0 * 2.0 - 1.0 * 3.0) / 2.0, 1e-9);
  EXPECT_NEAR(corrections[1].addition, 0.5 * 20.0 * -3.0 / 4.0, 1e-9);
}

TEST(Reconfiguration, PushesAgainstASpringFromItsRestWithItsCompliance) {
  Reconfiguration reconfiguration = Bench().Make();
  FaultEstimates estimates = reconfiguration.MakeEstimates();
  estimates.sd.setConstant(1e-3);
  estimates.deviation[kSpring] = -0.5;
  Observe(reconfiguration, estimates, kLong);
  // In the middle of the tick 1.25 - 3 T / 2, less 0.25 at rest, and 1 / 0.5 - 1 = 1.
  EXPECT_NEAR(reconfiguration.Correct(kMoving)[1].addition,
              8.0 * (1.0 - 1.5 * kTick) / 4.0, 1e-9);
}

TEST(Reconfiguration, PushesHarderWithAWeakMotor) {
  Reconfiguration reconfiguration = Bench().Make();
  FaultEstimates estimates = reconfiguration.MakeEstimates();
  estimates.sd.setConstant(1e-3);
  estimates.deviation[kDamper] = 0.5;
  estimates.deviation[kMotor] = -0.2;
  Observe(reconfiguration, estimates, kLong);
  EXPECT_NEAR(reconfiguration.Correct(kMoving)[0].addition, 1.25 * 0.5 * 17.0 / 2.0,
              1e-9);
}

TEST(Reconfiguration, CancelsAToneInAmplitudeAndPhaseWhateverTheMotor) {
  Reconfiguration reconfiguration = Bench().Make();
  FaultEstimates estimates = reconfiguration.MakeEstimates();
  estimates.sd.setConstant(1e-3);
  estimates.deviation << -0.2, 0.0, 0.0, 0.5;
  estimates.tones << 0.3, -0.4;
  Observe(reconfiguration, estimates, kLong);
  for (int k = kLong; k < kLong + 40; ++k) {
    const double angle = 2.0 * std::numbers::pi * 50.0 * k * kTick;
    const double tone = 3.0 * (0.3 * std::sin(angle) - 0.4 * std::cos(angle));
    EXPECT_NEAR(reconfiguration.Correct(kMoving)[0].addition, -tone / 2.0, 1e-9) << k;
    reconfiguration.Observe(estimates);
  }
}

TEST(Reconfiguration, ComesAndGoesWithoutAJump) {
  const Bench bench;
  Reconfiguration reconfiguration = bench.Make();
  FaultEstimates estimates = reconfiguration.MakeEstimates();
  estimates.sd.setConstant(1e-3);
  double before = 1.0;
  // What a low-pass moves in a tick of all that it has to move.
  const double most = 0.25 * kTick / bench.options.time_constant;
  for (const double deviation : {0.0, -0.2, 0.0}) {
    estimates.deviation[kMotor] = deviation;
    for (int k = 0; k < kLong; ++k) {
      reconfiguration.Observe(estimates);
      const double gain = reconfiguration.Correct(kMoving)[0].gain;
      EXPECT_LE(std::abs(gain - before), 1.25 * most) << k;
      before = gain;
    }
    EXPECT_NEAR(before, 1.0 / (1.0 + deviation), 1e-9);
  }
}

TEST(Reconfiguration, WaitsUntilAFaultHasBeenCertainForAWhile) {
  Reconfiguration reconfiguration = Bench().Make();
  FaultEstimates estimates = reconfiguration.MakeEstimates();
  estimates.sd.setConstant(1e-3);
  FaultEstimates healthy = estimates;
  estimates.deviation[kMotor] = -0.2;
  for (int k = 0; k < 5; ++k) {
    Observe(reconfiguration, estimates, 9);
    Observe(reconfiguration, healthy, 1);
  }
  EXPECT_FALSE(reconfiguration.states()[kMotor].certain);
  EXPECT_EQ(reconfiguration.Correct(kMoving)[0].gain, 1.0);
  Observe(reconfiguration, estimates, 10);
  EXPECT_TRUE(reconfiguration.states()[kMotor].certain);
  EXPECT_EQ(reconfiguration.states()[kMotor].since, 59);
}

TEST(Reconfiguration, LetsAFaultGoThatIsSeenToBeGone) {
  Reconfiguration reconfiguration = Bench().Make();
  FaultEstimates estimates = reconfiguration.MakeEstimates();
  estimates.sd.setConstant(1e-3);
  estimates.deviation[kMotor] = -0.2;
  Observe(reconfiguration, estimates, kLong);
  estimates.deviation[kMotor] = 1e-3;
  Observe(reconfiguration, estimates, 1);
  EXPECT_FALSE(reconfiguration.states()[kMotor].certain);
  EXPECT_EQ(reconfiguration.states()[kMotor].until, kLong);
  EXPECT_EQ(reconfiguration.states()[kMotor].since, 9);
  Observe(reconfiguration, estimates, kLong);
  EXPECT_NEAR(reconfiguration.Correct(kMoving)[0].gain, 1.0, 1e-12);
}

TEST(Reconfiguration, GivesAnEstimateThatHasBecomeUncertainTimeToComeBack) {
  for (const double unsure : {0.1, kNaN}) {
    Reconfiguration reconfiguration = Bench().Make();
    FaultEstimates estimates = reconfiguration.MakeEstimates();
    estimates.sd.setConstant(1e-3);
    estimates.deviation << -0.2, 0.0, 0.0, 0.5;
    estimates.tones << 0.3, -0.4;
    Observe(reconfiguration, estimates, kLong);
    FaultEstimates lost = reconfiguration.MakeEstimates();
    lost.sd.setConstant(unsure);
    Observe(reconfiguration, lost, 50);
    EXPECT_NEAR(reconfiguration.states()[kMotor].acting, -0.2, 1e-9);
    EXPECT_TRUE(reconfiguration.states()[kTone].certain);
    const double angle = 2.0 * std::numbers::pi * 50.0 * (kLong + 50) * kTick;
    EXPECT_NEAR(reconfiguration.Correct(kMoving)[0].addition,
                -1.5 * (0.3 * std::sin(angle) - 0.4 * std::cos(angle)), 1e-9);
    Observe(reconfiguration, lost, kLong);
    EXPECT_FALSE(reconfiguration.states()[kMotor].certain);
    EXPECT_NEAR(reconfiguration.Correct(kMoving)[0].gain, 1.0, 1e-9);
    EXPECT_NEAR(reconfiguration.Correct(kMoving)[0].addition, 0.0, 1e-9);
  }
}

TEST(Reconfiguration, KeepsAFaultThatIsAtTheLimitOfWhatIsCertain) {
  Reconfiguration reconfiguration = Bench().Make();
  FaultEstimates estimates = reconfiguration.MakeEstimates();
  estimates.sd.setConstant(1e-3);
  estimates.deviation[kMotor] = -5.5e-3;
  Observe(reconfiguration, estimates, kLong);
  ASSERT_TRUE(reconfiguration.states()[kMotor].certain);
  estimates.deviation[kMotor] = -3e-3;
  Observe(reconfiguration, estimates, kLong);
  EXPECT_TRUE(reconfiguration.states()[kMotor].certain);
  EXPECT_NEAR(reconfiguration.states()[kMotor].acting, -3e-3, 1e-9);
}

TEST(Reconfiguration, LeavesAloneWhatIsTooSmallToActOn) {
  Bench bench;
  bench.options.least = 1e-3;
  Reconfiguration reconfiguration = bench.Make();
  FaultEstimates estimates = reconfiguration.MakeEstimates();
  estimates.sd.setConstant(1e-9);
  estimates.deviation[kMotor] = -0.9e-3;
  Observe(reconfiguration, estimates, kLong);
  EXPECT_EQ(reconfiguration.Correct(kMoving)[0].gain, 1.0);
  estimates.deviation[kMotor] = -1.1e-3;
  Observe(reconfiguration, estimates, kLong);
  EXPECT_GT(reconfiguration.Correct(kMoving)[0].gain, 1.0);
}

TEST(Reconfiguration, AllocatesNothingWhileItRuns) {
  if (!test::kCountsAllocations) GTEST_SKIP();
  Reconfiguration reconfiguration = Bench().Make();
  FaultEstimates estimates = reconfiguration.MakeEstimates();
  estimates.sd.setConstant(1e-3);
  estimates.deviation.setConstant(0.5);
  EXPECT_EQ(test::CountAllocations([&] {
              for (int k = 0; k < kLong; ++k) {
                reconfiguration.Correct(kMoving);
                reconfiguration.Observe(estimates);
              }
            }),
            0);
}

TEST(Reconfiguration, RefusesARemedyForAnotherMachine) {
  const auto message = [](const char* text) {
    return ThrowsMessage<InputError>(HasSubstr(text));
  };
  Bench drive;
  drive.remedies[kMotor].drives = {2};
  EXPECT_THAT([&] { drive.Make(); }, message("remedy of motor: no axis 2"));
  Bench forces;
  forces.remedies[kDamper].forces.velocity = Eigen::Matrix3d::Zero();
  EXPECT_THAT([&] { forces.Make(); }, message("forces of another number of axes"));
  Bench tone;
  tone.remedies[kTone].tones[0].amplitude = Eigen::Vector3d::Zero();
  EXPECT_THAT([&] { tone.Make(); }, message("a tone on another number of axes"));
  Bench range;
  range.remedies[kMotor].least = -1.0;
  EXPECT_THAT([&] { range.Make(); }, message("or reach -1"));
  Bench time;
  time.options.time_constant = 0.0;
  EXPECT_THAT([&] { time.Make(); }, message("time constant is not positive"));
}

}  // namespace
}  // namespace mjdiag
