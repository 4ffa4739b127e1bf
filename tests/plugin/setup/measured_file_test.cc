#include "mjdiag/plugin/setup/measured_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mjdiag/signals/text_file.h"
#include "plugin/setup/setup_file.h"

namespace mjdiag {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A file of the servo: a reading, a command and a switch at the given times.
class ServoFile : public ::testing::Test {
 protected:
  MeasuredFile Read(double jitter) const {
    std::string text = "time [s],q [rad],volts [V],torque_enable [1],goal [rad]\n";
    for (int k = 0; k < 400; ++k) {
      const double t = 0.005 * (k + (k > 0 ? jitter * std::sin(7.0 * k) : 0.0));
      const std::string held = k < 200 ? ",1,1," : ",3,0,";
      text += std::to_string(t) + "," + std::to_string(2.0 * t) + held + "0.5\n";
    }
    WriteTextFile(folder_ / "r.csv", text);
    return ReadMeasured(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/servo"), folder_ / "r.csv");
  }
  const test::TemporaryFolder folder_;
};

TEST_F(ServoFile, WithUniformTimesIsReadUnchanged) {
  const MeasuredFile file = Read(0.0);
  EXPECT_THAT(file.notes, IsEmpty());
  EXPECT_EQ(file.record.samples(), 400);
  EXPECT_EQ(file.record.sample_time(), 0.005);
}

TEST_F(ServoFile, WithJitterIsResampledToTheControlTickWithANote) {
  const MeasuredFile file = Read(0.1);
  EXPECT_THAT(file.notes, ElementsAre(HasSubstr("resampled to 5.00 ms")));
  const Record& record = file.record;
  EXPECT_EQ(record.sample_time(), 0.005);
  // std::to_string has six decimals.
  EXPECT_LT((record.At("q").samples - 2.0 * record.Time()).cwiseAbs().maxCoeff(), 1e-5);
}

TEST_F(ServoFile, HoldsCommandsAndSwitches) {
  const Record record = Read(0.1).record;
  for (const double volts : record.At("volts").samples) {
    // Never beyond its samples, as a cubic would be.
    EXPECT_GE(volts, 1.0);
    EXPECT_LE(volts, 3.0);
  }
  for (const double on : record.At("torque_enable").samples) {
    EXPECT_TRUE(on == 0.0 || on == 1.0) << on;
  }
}

}  // namespace
}  // namespace mjdiag
