#include "mjdiag/plugin/replay/tracking.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/signals/error.h"
#include "plugin/replay/replay.h"
#include "support/message_of.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using testing::HasSubstr;

const Changes& Worn() {
  static const Changes changes =
      test::With({"quadratic_drag@load:coefficient=50", "added_mass@load:mass=1"},
                 {{"zeta", 1.1}});
  return changes;
}

/// Two seconds of the stage without noise, with those changes in it.
test::Replay Measured(const Changes& changes) {
  const test::Stage stage;
  Trajectory motion = stage.setup().trajectories.Find("default");
  motion.duration = 2.0;
  RunOptions quiet;
  quiet.noise_scale = 0.0;
  return {stage.machine, Simulate(stage.machine.With(changes),
                                  FollowTrajectory(stage.setup(), motion), quiet)};
}

TEST(RunPredictor, HasNoInnovationsBesideTheMachineThatWasMeasured) {
  const test::Replay replay = Measured({});
  EXPECT_LT(replay.Follow({}).innovations.cwiseAbs().maxCoeff(), 1e-14);
}

TEST(RunPredictor, HasNoneBesideTheNominalMachineWithTheChangesThatWereInIt) {
  const test::Replay replay = Measured(Worn());
  EXPECT_LT(replay.Follow(Worn()).innovations.cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_GT(replay.Follow({}).innovations.cwiseAbs().maxCoeff(), 1e-7);
}

// The stage does not hold itself: left alone an error of its start stays.
TEST(RunPredictor, IsPulledFromAWrongStartTowardsTheRecord) {
  constexpr double kWrong = 1e-5;
  test::Replay replay = Measured({});
  replay.run.records.front().readings["q"] += kWrong;
  const MatrixXd pulled = replay.Follow({}).innovations;
  EXPECT_NEAR(pulled(0, 0), -kWrong, 1e-3 * kWrong);
  EXPECT_LT(pulled.rightCols(100).cwiseAbs().maxCoeff(), 1e-3 * kWrong);
  replay.observer.L.setZero();
  const MatrixXd left = replay.Follow({}).innovations;
  EXPECT_GT(left.rightCols(100).cwiseAbs().minCoeff(), 0.9 * kWrong);
}

// Else a wrong scale would seem to explain something by the stiffer observer it makes.
TEST(RunPredictor, IsPulledLessByASensorThatReadsMore) {
  const test::Replay replay = Measured(Worn());
  const MatrixXd plain = replay.Follow({}).innovations;
  test::Replay scaled = replay;
  scaled.run.outputs *= 2.0;
  for (auto& [name, reading] : scaled.run.records.front().readings) reading *= 2.0;
  const MatrixXd twice =
      scaled.Follow(test::With({"encoder_scale@load_encoder:factor=2"})).innovations;
  EXPECT_LT((twice - 2.0 * plain).cwiseAbs().maxCoeff(),
            1e-6 * plain.cwiseAbs().maxCoeff());
}

/// As if samples first .. first + count - 1 had not been measured, and read nonsense.
MeasuredRun Without(MeasuredRun run, Index first, Index count) {
  if (run.measured.size() == 0) run.measured.setConstant(1, run.samples(), true);
  run.measured.middleCols(first, count).setConstant(false);
  run.outputs.middleCols(first, count).setConstant(7.0);
  return run;
}

TEST(RunPredictor, RunsOnWhereNothingWasMeasured) {
  test::Replay replay = Measured({});
  replay.run = Without(replay.run, 1000, 300);
  const MatrixXd innovations = replay.Follow({}).innovations;
  EXPECT_LT(innovations.cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_EQ(innovations.middleCols(1000, 300).cwiseAbs().maxCoeff(), 0.0);
}

TEST(RunPredictor, IsBitwiseTheSameWhereAllOfItWasMeasured) {
  test::Replay replay = Measured(Worn());
  const MatrixXd innovations = replay.Follow({}).innovations;
  replay.run.measured.setConstant(1, replay.run.samples(), true);
  EXPECT_EQ(replay.Follow({}).innovations, innovations);
}

// Behind inputs that are a guess it is pulled back, and nothing counts before it is.
TEST(RunPredictor, CountsNothingBehindInputsThatAreAGuess) {
  test::Replay replay = Measured({});
  const Index n = replay.run.samples();
  replay.run = Without(replay.run, 1000, 50);
  replay.run.inputs.middleCols(1000, 50).array() += 5.0;
  const double strayed = replay.Follow({}).innovations.cwiseAbs().maxCoeff();
  replay.run.driven.setConstant(n, true);
  replay.run.driven.segment(1000, 50) = false;
  replay.run.Discount(700);
  EXPECT_EQ(replay.run.counted.count(), n - 750);
  const MatrixXd counted = replay.Follow({}).innovations;
  EXPECT_LT(counted.cwiseAbs().maxCoeff(), 0.02 * strayed);
  EXPECT_EQ(counted.middleCols(1000, 750).cwiseAbs().maxCoeff(), 0.0);
}

TEST(MeasuredRun, KnowsWhatOfSeveralRecordsWasMeasured) {
  const MeasuredRun whole = Measured({}).run;
  const Index n = whole.samples();
  const MeasuredRun both = Joined({whole, Without(whole, 10, 5)});
  EXPECT_EQ(both.measured.count(), 2 * n - 5);
  EXPECT_FALSE(both.measured(0, n + 12));
  EXPECT_EQ(Part(both, 1, n).measured.count(), n - 5);
  EXPECT_EQ(both.ReadingsOf(0).size(), 2 * n - 5);
  EXPECT_EQ(both.PeriodOf(0), 1);
  MeasuredRun slow = whole;
  slow.measured.setConstant(1, n, false);
  for (Index k = 0; k < n; k += 4) slow.measured(0, k) = true;
  EXPECT_EQ(slow.PeriodOf(0), 4);
}

TEST(RunPredictor, KeepsTheStatesWhereTheyAreAskedFor) {
  const test::Replay replay = Measured(Worn());
  const InnovationSequence without = replay.Follow(Worn());
  EXPECT_EQ(without.position.size(), 0);
  EXPECT_EQ(without.velocity.size(), 0);
  const InnovationSequence with = replay.Follow(Worn(), true);
  EXPECT_EQ(with.innovations, without.innovations);
  ASSERT_EQ(with.position.cols(), replay.run.samples());
  // The encoder reads the one joint that there is.
  EXPECT_LT((with.position - replay.run.outputs).cwiseAbs().maxCoeff(), 1e-14);
  // The position at the end of a tick is that of its last velocity.
  EXPECT_LT(std::abs(with.velocity.rowwise().sum()(0) * replay.run.sample_time -
                     with.position(0, replay.run.samples() - 1)),
            1e-3 * with.position.maxCoeff());
}

TEST(RunPredictor, IsTheSameRunWithItsFirstOrderRecorded) {
  const test::Replay replay = Measured(Worn());
  ErrorDynamics dynamics(replay.observer, 10);
  const InnovationSequence track =
      RunPredictor(replay.machine, {}, replay.run, replay.observer, dynamics);
  const InnovationSequence plain = replay.Follow({}, true);
  EXPECT_EQ(track.innovations, plain.innovations);
  EXPECT_EQ(track.position, plain.position);
  EXPECT_EQ(dynamics.blocks(), replay.run.samples() / 10);
}

TEST(RunPredictor, SaysThatItDiverges) {
  test::Replay replay = Measured({});
  replay.run.inputs(0, 100) = 1e300;
  EXPECT_THAT(test::MessageOf<NumericalError>([&] { replay.Follow({}); }),
              HasSubstr("replay: diverged at 0.1"));
}

TEST(ObserveMotion, IsOffQpos0WithAccelerationsByDifferences) {
  const test::Replay replay = Measured({});
  const InnovationSequence track = replay.Follow({}, true);
  const ModelPtr moved = CopyModel(replay.machine.plant());
  moved->qpos0[0] = 0.5;
  const ObservedMotion motion =
      ObserveMotion(Machine(replay.machine.setup(), *moved), replay.run, track);
  EXPECT_EQ(motion.sample_time, replay.run.sample_time);
  EXPECT_EQ(motion.position, (track.position.array() - 0.5).matrix());
  EXPECT_EQ(motion.velocity, track.velocity);
  EXPECT_EQ(motion.inputs, replay.run.inputs);
  EXPECT_EQ(motion.outputs, replay.run.outputs);
  const Index k = 700;
  EXPECT_NEAR(motion.acceleration(0, k),
              (track.velocity(0, k + 1) - track.velocity(0, k - 1)) /
                  (2.0 * motion.sample_time),
              1e-9);
}

/// The servo after half a second of 2 V, which then swings with its torque off; beside
/// the machine itself, which nothing pulls to the record.
struct SwitchedServo {
  Machine machine{WithoutControllers(
      ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/servo", {"sensors.q.resolution=0"}))};
  MeasuredRun run = ToMeasuredRun(machine.setup(), Recorded());
  InnovationSequence Follow(const MeasuredRun& of) const {
    Observer idle;
    idle.L = MatrixXd::Zero(2, 1);
    return RunPredictor(machine, {}, of, idle, true);
  }

 private:
  Record Recorded() const {
    Eigen::VectorXd on = Eigen::VectorXd::Zero(300);
    on.head(100).setOnes();
    Record asked(machine.rates().tick());
    asked.Add({"q", "rad", Eigen::VectorXd::Zero(300)});
    asked.Add({"volts", "V", 2.0 * on});
    asked.Add({"torque_enable", "1", on});
    return Simulate(machine, Replay(machine.setup(), asked), {});
  }
};

TEST(RunPredictor, SwitchesActuatorsAsTheRecordSays) {
  const SwitchedServo servo;
  EXPECT_EQ(servo.run.on.row(0).sum(), 100.0);
  EXPECT_LT(servo.Follow(servo.run).innovations.cwiseAbs().maxCoeff(), 1e-12);
  MeasuredRun always_on = servo.run;
  always_on.on.resize(0, 0);
  EXPECT_GT(servo.Follow(always_on).innovations.cwiseAbs().maxCoeff(), 0.1);
}

TEST(ObserveMotion, HasTheBackEmfAtTheEndsOfAnOpenCircuit) {
  const SwitchedServo servo;
  const ObservedMotion motion =
      ObserveMotion(servo.machine, servo.run, servo.Follow(servo.run));
  EXPECT_EQ(motion.inputs(0, 50), 2.0);
  EXPECT_NEAR(motion.inputs(0, 150), 0.387 * motion.velocity(0, 150), 1e-12);
  EXPECT_GT(std::abs(motion.velocity(0, 150)), 0.1);
}

/// A record of the stage with what is asked for.
Record Sampled(const std::string& input_unit, double sample_time) {
  Record record(sample_time);
  record.Add({"u", input_unit, Eigen::VectorXd::LinSpaced(50, 0.0, 1.0)});
  record.Add({"q", "m", Eigen::VectorXd::LinSpaced(50, 0.3, 0.4)});
  record.Add({"q_ref", "m", Eigen::VectorXd::Zero(50)});
  return record;
}

TEST(RunPredictor, FollowsEveryRecordOfARunFromItsOwnStart) {
  const test::Stage stage;
  const test::Replay first(stage.machine, stage.Measure({}));
  test::Replay second(stage.machine, stage.Measure({"coulomb_friction@load:force=18"}));
  second.run = Part(second.run, 0, 1500);
  test::Replay both = first;
  both.run = Joined({first.run, second.run});
  const Index n = first.run.samples();
  ASSERT_EQ(both.run.SamplesOf(0), n);
  ASSERT_EQ(both.run.SamplesOf(1), 1500);
  EXPECT_EQ(both.run.Time()[n + 1], both.run.sample_time);
  const InnovationSequence track = both.Follow({}, true);
  EXPECT_EQ(track.innovations.leftCols(n), first.Follow({}).innovations);
  // The observer is that of the first record.
  const InnovationSequence alone =
      RunPredictor(second.machine, {}, second.run, first.observer, true);
  EXPECT_EQ(track.innovations.rightCols(1500), alone.innovations);
  const ObservedMotion motion = ObserveMotion(both.machine, both.run, track);
  EXPECT_EQ(motion.acceleration.rightCols(1500),
            ObserveMotion(second.machine, second.run, alone).acceleration);
}

TEST(MeasuredRun, IsCutAtAnySample) {
  const test::Replay replay = Measured({});
  const MeasuredRun both = Joined({replay.run, replay.run});
  const Index n = replay.run.samples();
  EXPECT_EQ(Part(both, 0, n - 1).records.size(), 1u);
  EXPECT_EQ(Part(both, 0, n + 1).SamplesOf(1), 1);
  EXPECT_EQ(Part(both, 1, n).outputs, replay.run.outputs);
}

TEST(ToMeasuredRun, TakesChannelsByNameAndBeginsAtTheFirstReading) {
  const test::Stage stage;
  const double tick = stage.setup().rates.tick();
  const MeasuredRun run = ToMeasuredRun(stage.setup(), Sampled("V", tick));
  EXPECT_EQ(run.sample_time, tick);
  EXPECT_EQ(run.samples(), 50);
  EXPECT_EQ(run.inputs(0, 49), 1.0);
  EXPECT_EQ(run.outputs(0, 49), 0.4);
  EXPECT_EQ(run.records.front().readings.at("q"), 0.3);
}

TEST(ToMeasuredRun, RefusesAnotherUnitRateOrChannel) {
  const test::Stage stage;
  const double tick = stage.setup().rates.tick();
  const auto refusal = [&](const Record& record) {
    return test::MessageOf<InputError>([&] { ToMeasuredRun(stage.setup(), record); });
  };
  EXPECT_THAT(refusal(Sampled("A", tick)), HasSubstr("channel 'u' is in 'A'"));
  EXPECT_NE(refusal(Sampled("V", 2.0 * tick)), "no error of the expected kind");
  Record without(tick);
  without.Add({"q", "m", Eigen::VectorXd::Zero(50)});
  without.Add({"q_ref", "m", Eigen::VectorXd::Zero(50)});
  EXPECT_THAT(refusal(without), HasSubstr("u"));
}

}  // namespace
}  // namespace mjdiag
