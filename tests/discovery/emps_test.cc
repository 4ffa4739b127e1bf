// The EMPS stage, really measured. The data belongs to its authors and is not part of
// this repository: the folder is named by MJDIAG_EMPS_DATA, see the README.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "mjdiag/discovery/comparison.h"

namespace mjdiag {
namespace {

std::filesystem::path DataFolder() {
  const char* named = std::getenv("MJDIAG_EMPS_DATA");
  return named != nullptr ? named : "";
}

double RelativeError(const Comparison& comparison, const std::string& name) {
  for (const ChannelMismatch& channel : comparison.channels) {
    if (channel.name == name) return channel.relative_error_percent;
  }
  for (const DerivedMismatch& derived : comparison.derived) {
    if (derived.name == name) return derived.relative_error_percent;
  }
  ADD_FAILURE() << "no figure for " << name;
  return 0.0;
}

class Emps : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::filesystem::exists(DataFolder() / "DATA_EMPS.mat")) return;
    ASSERT_EQ(std::getenv("CI"), nullptr) << "no EMPS data in " << DataFolder();
    GTEST_SKIP() << "no EMPS data: MJDIAG_EMPS_DATA names no folder with DATA_EMPS.mat";
  }
  /// The closed loop on the measured reference, with effects on the incomplete plant.
  static Comparison CompareWith(const std::string& file,
                                const std::vector<std::string>& effects) {
    const mjdiag::Setup setup = ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/emps");
    const ModelPtr plant = LoadPlant(setup);
    if (!effects.empty()) SetAuthorsMassAndDamping(*plant);
    RunOptions options;
    for (const std::string& effect : effects) {
      options.effects.push_back(ParseEffect(effect));
    }
    return Compare(setup, *plant, ReadRecord(DataFolder() / file, setup.record),
                   options);
  }
  /// The plant has them rounded.
  static void SetAuthorsMassAndDamping(mjModel& plant) {
    plant.body_mass[FindElement(plant, mjOBJ_BODY, "load")] = 95.1089;
    plant.dof_damping[0] = 203.5034;
  }
  /// The other two of the authors' symmetric model. A positive offset of theirs opposes
  /// the motor.
  static inline const std::vector<std::string> kAuthors = {
      "coulomb_friction@load:force=20.3935", "force_offset@load:force=3.1648"};
};

TEST_F(Emps, AuthorsFourParametersReachTheIndependentSimulation) {
  const Comparison comparison = CompareWith("DATA_EMPS.mat", kAuthors);
  EXPECT_LE(RelativeError(comparison, "q"), 0.0015);
  EXPECT_LE(RelativeError(comparison, "q_velocity"), 0.13);
  EXPECT_LE(RelativeError(comparison, "force"), 4.6);
}

TEST_F(Emps, AuthorsFourParametersHoldOnTheUnseenPulses) {
  const Comparison comparison = CompareWith("DATA_EMPS_PULSES.mat", kAuthors);
  EXPECT_LE(RelativeError(comparison, "q"), 0.002);
  EXPECT_LE(RelativeError(comparison, "q_velocity"), 0.20);
  EXPECT_LE(RelativeError(comparison, "force"), 5.6);
}

TEST_F(Emps, IncompletePlantIsVisiblyWorseAndSaidToBe) {
  const Comparison incomplete = CompareWith("DATA_EMPS.mat", {});
  const Comparison authors = CompareWith("DATA_EMPS.mat", kAuthors);
  EXPECT_GT(RelativeError(incomplete, "force"), 3.0 * RelativeError(authors, "force"));
  EXPECT_TRUE(incomplete.exceeds_noise());
}

}  // namespace
}  // namespace mjdiag
