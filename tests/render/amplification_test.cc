#include "mjdiag/render/amplification.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "mjdiag/render/amplification_label.h"
#include "mjdiag/render/drawn_joints.h"
#include "mjdiag/signals/error.h"
#include "support/message_of.h"
#include "render/test_machine.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;

const std::vector<DrawnJoint> kJoints{
    {"mount", JointMotion::kTranslation, JointRole::kCompliant},
    {"stage", JointMotion::kTranslation, JointRole::kDriven},
    {"tilt", JointMotion::kRotation, JointRole::kCompliant},
    {"arm", JointMotion::kRotation, JointRole::kDriven}};

Amplification Amplify(const Record& healthy, const Record& faulty,
                      const AmplificationOptions& options) {
  const std::array runs{&healthy, &faulty};
  return Amplification(kJoints, healthy, runs, {0.0, 0.1}, options);
}

TEST(RoundDown125, TakesTheNextRoundNumberBelow) {
  EXPECT_DOUBLE_EQ(RoundDown125(1.0), 1.0);
  EXPECT_DOUBLE_EQ(RoundDown125(1.99), 1.0);
  EXPECT_DOUBLE_EQ(RoundDown125(4.9), 2.0);
  EXPECT_DOUBLE_EQ(RoundDown125(7300.0), 5000.0);
  EXPECT_DOUBLE_EQ(RoundDown125(0.03), 0.02);
  EXPECT_DOUBLE_EQ(RoundDown125(4.9999999999), 5.0);
}

TEST(DrawnJoints, TellsDrivenJointsFromCompliantOnes) {
  const ModelPtr model = test::Machine();
  const std::vector<DrawnJoint> joints = DrawnJoints(*model);
  ASSERT_EQ(joints.size(), kJoints.size());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    EXPECT_EQ(joints[j].name, kJoints[j].name);
    EXPECT_EQ(joints[j].motion, kJoints[j].motion) << joints[j].name;
    EXPECT_EQ(joints[j].role, kJoints[j].role) << joints[j].name;
  }
}

TEST(Amplification, DrawsThePeakOfAGroupAtTheWantedSize) {
  const Record healthy = test::Run({});
  const Record faulty = test::Run({.mount = 3e-8, .stage = 4e-6});
  const Amplification drawn =
      Amplify(healthy, faulty, {.drawn_length = 0.01, .drawn_angle = 0.05});
  // 0.01 / 3e-8 = 333333, 0.01 / (4e-6 - 1e-6) = 3333, 0.05 / 3e-8 = 1666667; the arms
  // of both runs move alike, so nothing is off angle.
  EXPECT_DOUBLE_EQ(drawn.factors()[0], 200000.0);
  EXPECT_DOUBLE_EQ(drawn.factors()[1], 2000.0);
  EXPECT_DOUBLE_EQ(drawn.factors()[2], 1e6);
  EXPECT_DOUBLE_EQ(drawn.factors()[3], 1.0);
}

TEST(Amplification, DrawsDrivenJointsWithOneFactorSoThatNoiseStaysSmall) {
  const Record healthy = test::Run({});
  // The arm is off by rounding noise, the stage by a fault.
  const Record faulty = test::Run({.stage = 4e-6, .arm = 1e-5 + 1e-10});
  const Amplification drawn =
      Amplify(healthy, faulty, {.drawn_length = 0.01, .drawn_angle = 0.05});
  EXPECT_DOUBLE_EQ(drawn.factors()[1], 2000.0);
  EXPECT_DOUBLE_EQ(drawn.factors()[3], 2000.0);
}

TEST(Amplification, FollowsItsEquation) {
  const Record healthy = test::Run({});
  const Record faulty = test::Run({.mount = 3e-8, .stage = 4e-6});
  const Amplification drawn = Amplify(
      healthy, faulty, {.factors = {{"mount", 1e5}, {"stage", 500.0}}, .all = 2.0});
  const double time = 0.0105;  // between two samples
  const Eigen::VectorXd q = drawn.DrawnPositions(faulty, time);
  const auto at = [&](const Record& record, const char* name) {
    const Eigen::VectorXd& samples = record.At(name).samples;
    return 0.5 * (samples[10] + samples[11]);
  };
  // Compliant joints deviate from where the reference run starts.
  EXPECT_NEAR(q[0], 1e5 * at(faulty, "joint.mount"), 1e-15);
  EXPECT_NEAR(q[2], 2.0 * at(faulty, "joint.tilt"), 1e-20);
  // Driven joints deviate from the reference run.
  const double nominal = at(healthy, "joint.stage");
  EXPECT_NEAR(q[1], nominal + 500.0 * (at(faulty, "joint.stage") - nominal), 1e-15);
  EXPECT_GT(std::abs(q[1] - nominal), 1e-3);
}

TEST(Amplification, DrawsDrivenJointsOfTheReferenceRunWhereTheyAre) {
  const Record healthy = test::Run({});
  const Record faulty = test::Run({.stage = 4e-6});
  const Amplification drawn = Amplify(healthy, faulty, {.all = 1000.0});
  EXPECT_NEAR(drawn.DrawnPositions(healthy, 0.037)[1],
              healthy.At("joint.stage").samples[37], 1e-15);
}

TEST(Amplification, NeverShrinksMotion) {
  const Record healthy = test::Run({});
  const Record faulty = test::Run({.stage = 1.0});
  EXPECT_EQ(Amplify(healthy, faulty, {.drawn_length = 0.01}).factors()[1], 1.0);
}

TEST(Amplification, LooksOnlyAtTheTimesShown) {
  Record late = test::Run({.mount = 0.0});
  Eigen::VectorXd mount = Eigen::VectorXd::Zero(late.samples());
  mount[5] = 1e-3;
  mount[20] = 1e-6;
  mount[80] = 1e-3;
  Record run(1e-3);
  run.Add({"joint.mount", "m", mount});
  const std::array runs{static_cast<const Record*>(&run)};
  const Amplification drawn({kJoints[0]}, run, runs, {0.01, 0.05},
                            {.drawn_length = 0.01});
  EXPECT_DOUBLE_EQ(drawn.factors()[0], 10000.0);
}

TEST(Amplification, NamesTheMissingJointChannel) {
  const Record healthy = test::Run({});
  Record faulty(1e-3);
  faulty.Add({"joint.mount", "m", healthy.At("joint.mount").samples});
  EXPECT_THAT(test::MessageOf<InputError>([&] { Amplify(healthy, faulty, {}); }),
              HasSubstr("no channel \"joint.stage\""));
}

TEST(Amplification, RefusesUnknownJointsAndSenselessFactors) {
  const Record run = test::Run({});
  EXPECT_THAT(
      test::MessageOf<InputError>([&] {
        Amplify(run, run, {.factors = {{"knee", 2.0}}});
      }),
      AllOf(HasSubstr("no joint \"knee\""), HasSubstr("mount, stage, tilt, arm")));
  EXPECT_THAT(test::MessageOf<InputError>([&] {
                Amplify(run, run, {.factors = {{"arm", -1.0}}});
              }),
              HasSubstr("amplification of arm"));
}

TEST(AmplificationLabels, NameEveryEnlargedGroup) {
  const Record healthy = test::Run({});
  const Record faulty = test::Run({.stage = 4e-6});
  const auto shared =
      AmplificationLabels(Amplify(healthy, faulty, {.factors = {{"mount", 20000.0}}}));
  EXPECT_EQ(shared.back(), "flexing \u00d720 000");
  EXPECT_EQ(shared.front(), "motion enlarged: flexing \u00d720 000");
  EXPECT_EQ(AmplificationLabels(Amplify(healthy, faulty, {.all = 1.0})),
            std::vector<std::string>{""});
}

}  // namespace
}  // namespace mjdiag
