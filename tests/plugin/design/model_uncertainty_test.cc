// A twin of a machine that its model is not: what parts of healthy records say of it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "mjdiag/plugin/design/calibrate.h"
#include "mjdiag/plugin/design/machine_twin.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/record_file.h"
#include "support/changes.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using testing::Each;

TwinReading Read(const Machine& machine, const Record& record, double times = 1.0) {
  const Eigen::MatrixXd y = SamplesOf(record, ChannelsOf(machine.channels().sensors));
  const Eigen::MatrixXd u =
      times * SamplesOf(record, ChannelsOf(machine.channels().actuators));
  const auto twin = MakeTwinEstimator(machine, false);
  for (Index k = 0; k < y.cols(); ++k) {
    twin->Add({y.col(k).data(), static_cast<std::size_t>(y.rows())},
              {u.col(k).data(), static_cast<std::size_t>(u.rows())});
  }
  twin->CatchUp();
  return twin->Read();
}

Machine Stage(const std::vector<std::string>& overrides = {}) {
  return Machine(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/emps", overrides));
}

Machine CalibratedOn(const Machine& machine, const Record& record) {
  return CalibratedMachine(machine, Calibrate(machine, {record}, {}).calibration);
}

constexpr std::size_t kEta = 1;

// Its damping is another one in each direction and grows with speed, which the model does
// not know; the second motion is slower than the one that it is calibrated on.
TEST(ModelUncertaintyOfAStage, IsNoAlarmInAnotherMotionAndAMotorThatIsOffIs) {
  const Machine model = Stage()
                            .With(test::With({"coulomb_friction@load:force=20"}))
                            .WithSensorNoise(Eigen::VectorXd::Constant(1, 1e-7));
  const Machine real = model.With(
      test::With({"asymmetric_viscous_friction@load:positive=-14,negative=15",
                  "quadratic_drag@load:coefficient=120"}));
  const Excitation motion = DefaultMotion(
      Stage({"trajectories.default.duration=10.0", "trajectories.default.period=10.0",
             "trajectories.default.moves=[{at=0.2,by={q=0.2}},{at=2.7,by={q=-0.2}},"
             "{at=5.2,by={q=0.1}},{at=7.0,by={q=-0.1}}]"})
          .setup());
  const Excitation slower = DefaultMotion(
      Stage({"axes.q.limits.velocity=0.05", "trajectories.default.duration=10.0",
             "trajectories.default.period=10.0",
             "trajectories.default.moves=[{at=0.2,by={q=0.1}},{at=3.0,by={q=0.05}},"
             "{at=5.2,by={q=-0.15}}]"})
          .setup());
  RunOptions run;
  run.seed = 1;
  const Machine calibrated = CalibratedOn(model, Simulate(real, motion, run));
  EXPECT_TRUE(calibrated.setup().calibration->model.any());
  run.seed = 2;
  const TwinReading healthy = Read(calibrated, Simulate(real, slower, run));
  EXPECT_THAT(healthy.named, Each(false));
  EXPECT_LT(healthy.best_alarm[kEta], healthy.alarm[kEta]);
  run.seed = 3;
  const Machine weak = real.With({{{"eta", 0.9}}, {}});
  EXPECT_TRUE(Read(calibrated, Simulate(weak, slower, run)).named[kEta]);
}

/// Really measured; the data is not part of this repository.
class ModelUncertaintyOfEmps : public testing::Test {
 protected:
  void SetUp() override {
    const char* named = std::getenv("MJDIAG_EMPS_DATA");
    folder_ = named != nullptr ? named : "";
    if (std::filesystem::exists(folder_ / "DATA_EMPS.mat")) return;
    ASSERT_EQ(std::getenv("CI"), nullptr) << "no EMPS data in " << folder_;
    GTEST_SKIP() << "no EMPS data: MJDIAG_EMPS_DATA names no folder with DATA_EMPS.mat";
  }
  Record Measured(const std::string& file) const {
    return ReadRecord(folder_ / file, model_.setup().record);
  }

  std::filesystem::path folder_;
  /// The symmetric model that its authors publish.
  const Machine model_ = Stage().With(test::With(
      {"coulomb_friction@load:force=20.39", "force_offset@load:force=3.16"}));
};

TEST_F(ModelUncertaintyOfEmps, IsNoAlarmInTheOtherMotionAndAMotorThatIsOffIs) {
  const Machine calibrated = CalibratedOn(model_, Measured("DATA_EMPS.mat"));
  const Record pulses = Measured("DATA_EMPS_PULSES.mat");
  EXPECT_THAT(Read(calibrated, pulses).named, Each(false));
  EXPECT_TRUE(Read(calibrated, pulses, 1.05).named[kEta]);
}

TEST_F(ModelUncertaintyOfEmps, IsNoAlarmInTheOtherHalfOfItsRecord) {
  const Record record = Measured("DATA_EMPS.mat");
  const Index half = record.samples() / 2;
  const Machine calibrated = CalibratedOn(model_, record.Slice(0, half));
  EXPECT_THAT(Read(calibrated, record.Slice(half, half)).named, Each(false));
}

}  // namespace
}  // namespace mjdiag
