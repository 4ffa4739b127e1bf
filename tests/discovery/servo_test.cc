// A robot servo, really measured: twelve records at three gains. The data belongs to its
// authors and is not part of this repository: the folder is named by MJDIAG_SERVO_DATA,
// see the README.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/plugin/effects/effect.h"

namespace mjdiag {
namespace {

const std::filesystem::path kSetup = MJDIAG_SOURCE_DIR "/mjcf/servo";

std::filesystem::path ServoFolder() {
  const char* named = std::getenv("MJDIAG_SERVO_DATA");
  return named != nullptr ? named : "";
}

double MeanMae(const Discovery& answer, const Comparison RecordReplay::*model) {
  double sum = 0.0;
  int records = 0;
  for (const RecordReplay& replay : answer.records) {
    if (replay.seen) continue;
    sum += (replay.*model).channels.front().mae;
    ++records;
  }
  return sum / records;
}

// With friction alone to choose from, and in a tenth of the time that the whole answer
// takes: its main physics, and that on records of a gain that no fit saw.
TEST(Servo, HasFrictionThatGrowsWithItsLoad) {
  if (!std::filesystem::exists(ServoFolder() / "sin_sin_kp100.csv")) {
    ASSERT_EQ(std::getenv("CI"), nullptr) << "no servo data in " << ServoFolder();
    GTEST_SKIP() << "no servo data: MJDIAG_SERVO_DATA names no folder with the records";
  }
  DiscoverOptions options;
  options.doubt = true;
  options.choice.only = {"friction"};
  options.budget = 40.0;
  const Machine machine(ReadSetup(kSetup));
  const Discovery answer = Discover(
      machine,
      ReadMeasurements(machine, kSetup, {},
                       ReadRecordManifest(kSetup / "records.toml", ServoFolder())),
      options);
  EXPECT_TRUE(std::ranges::any_of(answer.causes, [](const FoundCause& found) {
    return found.cause.name().find("load_friction") != std::string::npos;
  }));
  EXPECT_LT(MeanMae(answer, &RecordReplay::after),
            0.5 * MeanMae(answer, &RecordReplay::before));
}

}  // namespace
}  // namespace mjdiag
