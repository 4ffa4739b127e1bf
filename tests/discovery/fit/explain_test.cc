#include "mjdiag/discovery/fit/explain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/plugin/replay/coarser_run.h"
#include "support/arm.h"

namespace mjdiag {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

/// @param substeps  2: the physics steps of the model; 64: next to none
Explained ExplainedFor(const std::vector<std::string>& lacking, int substeps = 64) {
  const test::Arm arm;
  const MeasuredRun run =
      ToMeasuredRun(arm.setup(), test::Arm::Measure(lacking, 1.0, substeps));
  return Explain(arm.machine, run, Eigen::VectorXd::Constant(2, test::Arm::kNoise),
                 {.seconds = 300.0, .progress = {}});
}

std::vector<std::string> NamesOf(const Explained& explained) {
  std::vector<std::string> names;
  for (const Member& member : explained.fit.model) {
    names.push_back(explained.blocks[member.block].name);
  }
  return names;
}

/// That the first value of a member is what it was, within 4 of the standard deviations that
/// the fit says, which are no larger than `most`, and 0.2 %, which physics steps of 0.5 ms
/// leave of second order.
void ExpectValue(const Explained& explained, const std::string& name, double truth,
                 double most) {
  const Model& model = explained.fit.model;
  const auto coordinates = CoordinatesOf(explained.blocks, model);
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    const Coordinate& one = coordinates[i];
    if (explained.blocks[model[one.member].block].name != name || one.value != 0)
      continue;
    const double value = model[one.member].values[0];
    double sd = one.unit * explained.fit.sd[static_cast<Eigen::Index>(i)];
    if (one.is_log) sd *= value;
    EXPECT_LT(sd, most) << name;
    EXPECT_NEAR(value, truth, 4.0 * sd + 0.002 * truth) << name;
    return;
  }
  ADD_FAILURE() << "no " << name;
}

TEST(Explain, HasNothingWhereNothingIsHidden) {
  EXPECT_THAT(NamesOf(ExplainedFor({}, 2)), IsEmpty());
  EXPECT_THAT(NamesOf(ExplainedFor({})), IsEmpty());
}

TEST(Explain, NamesADamperAndItsSize) {
  const Explained found = ExplainedFor({"viscous_friction@elbow:coefficient=0.05"});
  EXPECT_THAT(NamesOf(found), ElementsAre("viscous_friction@elbow"));
  ExpectValue(found, "viscous_friction@elbow", 0.05, 1e-3);
  EXPECT_LT(found.score, found.nothing.deviance - 100.0);
}

// What it says of a value is what the run tells behind the noise of the answer, which is a
// hundredth of what the machine as given needs. A tenth: the Jacobian is of where it was taken.
TEST(Explain, SaysHowWellValuesAreKnownBehindTheNoiseOfItsAnswer) {
  const test::Arm arm;
  const MeasuredRun run = ToMeasuredRun(
      arm.setup(),
      test::Arm::Measure({"viscous_friction@elbow:coefficient=0.05"}, 1.0));
  const Explained found =
      Explain(arm.machine, run, Eigen::VectorXd::Constant(2, test::Arm::kNoise),
              {.seconds = 300.0});
  const auto machine_with = [&](const Model& model) {
    const Machine machine = arm.machine.With(ChangesOfModel(found.blocks, model));
    return found.steps.Of(machine);
  };
  const ModelFit anew = FitModel(machine_with, run, found.path, KeepGains(found.path),
                                 found.blocks, found.fit.model, {});
  ASSERT_EQ(anew.sd.size(), found.fit.sd.size());
  ASSERT_GT(anew.sd.size(), 0);
  for (Eigen::Index i = 0; i < anew.sd.size(); ++i) {
    EXPECT_NEAR(found.fit.sd[i], anew.sd[i], 0.1 * anew.sd[i]);
  }
}

/// Six records, which are looked at once in some ticks first; of a simulation with the physics steps of
/// the model, of which six records would tell more than of a damper.
MeasuredRun LongRun(const test::Arm& arm, const std::string& lacking) {
  std::vector<MeasuredRun> runs;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    runs.push_back(
        ToMeasuredRun(arm.setup(), test::Arm::Measure({lacking}, 1.0, 2, seed)));
  }
  return Joined(runs);
}

TEST(Explain, IsOfAllOfALongRun) {
  const test::Arm arm;
  const MeasuredRun run = LongRun(arm, "viscous_friction@elbow:coefficient=0.05");
  bool is_coarse = false;
  ExplainOptions options{.seconds = 300.0};
  options.better = [&](const Explained& found) {
    is_coarse = is_coarse || found.ticks > 1;
  };
  const Explained found = Explain(
      arm.machine, run, Eigen::VectorXd::Constant(2, test::Arm::kNoise), options);
  EXPECT_TRUE(is_coarse) << "nothing was found by the first look";
  EXPECT_EQ(found.path.samples(), run.samples());
  EXPECT_THAT(NamesOf(found), ElementsAre("viscous_friction@elbow"));
  ExpectValue(found, "viscous_friction@elbow", 0.05, 1e-3);
}

TEST(Explain, KeepsWhatALookOnceInSomeTicksSaidWhereItIsStopped) {
  const test::Arm arm;
  const MeasuredRun run = LongRun(arm, "viscous_friction@elbow:coefficient=0.05");
  bool has_some = false;
  ExplainOptions options{.seconds = 300.0};
  options.better = [&](const Explained&) { has_some = true; };
  options.stop = [&] { return has_some; };
  const Explained found = Explain(
      arm.machine, run, Eigen::VectorXd::Constant(2, test::Arm::kNoise), options);
  EXPECT_TRUE(found.is_cut_short);
  EXPECT_GT(found.ticks, 1);
  EXPECT_EQ(found.path.samples(), Coarser(run, found.ticks).samples());
  EXPECT_EQ(found.nothing.samples(), found.path.samples());
  EXPECT_THAT(NamesOf(found), ::testing::Contains("viscous_friction@elbow"));
  EXPECT_LT(found.path.deviance, found.nothing.deviance);
}

TEST(Explain, NamesAMotorThatIsWeak) {
  const Explained found = ExplainedFor({"motor_constant@motor1:factor=0.97"});
  // Its gear is a number in doubt, and it is said as that.
  EXPECT_THAT(NamesOf(found), ElementsAre("gear@motor1"));
  ExpectValue(found, "gear@motor1", 0.97, 1e-3);
}

// One of the two at a joint makes up for the other.
TEST(Explain, NamesDryAndViscousFrictionOfTwoJoints) {
  const Explained found = ExplainedFor({"coulomb_friction@shoulder:force=0.2",
                                        "viscous_friction@shoulder:coefficient=0.05",
                                        "coulomb_friction@elbow:force=0.05",
                                        "viscous_friction@elbow:coefficient=0.02"});
  EXPECT_THAT(
      NamesOf(found),
      UnorderedElementsAre("coulomb_friction@shoulder", "viscous_friction@shoulder",
                           "coulomb_friction@elbow", "viscous_friction@elbow"));
  ExpectValue(found, "coulomb_friction@shoulder", 0.2, 5e-3);
  ExpectValue(found, "viscous_friction@shoulder", 0.05, 5e-3);
  ExpectValue(found, "coulomb_friction@elbow", 0.05, 1e-3);
  ExpectValue(found, "viscous_friction@elbow", 0.02, 1e-3);
}

// Shapes of one resistance are one block: none of them stands beside another.
TEST(Explain, NamesDryFrictionOfTwoJointsOnceEach) {
  const Explained found = ExplainedFor(
      {"coulomb_friction@shoulder:force=0.2", "coulomb_friction@elbow:force=0.05"});
  EXPECT_THAT(NamesOf(found), UnorderedElementsAre("coulomb_friction@shoulder",
                                                   "coulomb_friction@elbow"));
  ExpectValue(found, "coulomb_friction@shoulder", 0.2, 5e-3);
  ExpectValue(found, "coulomb_friction@elbow", 0.05, 1e-3);
}

}  // namespace
}  // namespace mjdiag
