// The EMPS stage, really measured. The data belongs to its authors and is not part of
// this repository: the folder is named by MJDIAG_EMPS_DATA, see docs/tour.md.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>

#include "mjdiag/discovery/blocks/path_motion.h"
#include "mjdiag/discovery/comparison/comparison.h"
#include "mjdiag/discovery/hypotheses/candidate_bounds.h"
#include "mjdiag/discovery/regression/force_moves.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/plugin/replay/sensor_noise.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/record_file.h"
#include "support/changes.h"

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
    const Machine nominal = effects.empty() ? Given() : WithAuthorsMassAndDamping();
    const Record measured = ReadRecord(DataFolder() / file, nominal.setup().record);
    return Compare(nominal.With(test::With(effects)), measured, {});
  }
  static Machine Given() { return Machine(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/emps")); }
  /// The plant has them rounded.
  static Machine WithAuthorsMassAndDamping() {
    const Machine given = Given();
    const ModelPtr plant = CopyModel(given.plant());
    plant->body_mass[FindElement(*plant, mjOBJ_BODY, "load")] = 95.1089;
    plant->dof_damping[0] = 203.5034;
    return {given.setup(), *plant};
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

// What one regression of the smoothed forces that are missing says is the friction and the
// offset of the authors' symmetric model, from the plant that has neither: both by inverse
// dynamics, theirs with mass and damping of their own, which is worth the 2 %.
TEST_F(Emps, ForcesThatAreMissingAreTheAuthorsFrictionAndOffset) {
  const Machine machine = Given();
  const MeasuredRun run =
      ToMeasuredRun(machine.setup(),
                    ReadRecord(DataFolder() / "DATA_EMPS.mat", machine.setup().record));
  const FilterPath path =
      FilterLikeliest(machine, run, SensorNoise(machine.channels(), run));
  std::vector<Candidate> candidates = ListCandidates(machine);
  BoundByRecord(candidates, machine, MotionAlong(machine, run, path));
  std::vector<Block> blocks = BlocksOf(machine, candidates, {});
  const Moves moves = ForceMovesOf(machine, run, path, blocks, {}, {});
  ASSERT_FALSE(moves.best.empty());
  std::map<std::string, double> sizes;
  for (const Added& added : moves.best.front().added) {
    const RegressorValues values = added.variation.values(added.amplitudes);
    ASSERT_TRUE(values);
    sizes[blocks[added.variation.block].name] = (*values)[0];
  }
  // What is viscous comes with what is dry, for fits to take out: the plant knows it.
  EXPECT_NEAR(sizes["zeta"], 1.0, 0.05);
  sizes.erase("zeta");
  ASSERT_EQ(sizes.size(), 2u);
  // By these rows alone friction that creeps and friction at once are nearly the same.
  const double friction =
      sizes["coulomb_friction@load"] + sizes["smooth_coulomb_friction@load"];
  EXPECT_NEAR(friction, 20.3935, 0.02 * 20.3935);
  EXPECT_NEAR(sizes["force_offset@load"], 3.1648, 0.02 * 3.1648);
}

}  // namespace
}  // namespace mjdiag
