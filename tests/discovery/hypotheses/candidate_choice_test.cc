#include "mjdiag/discovery/hypotheses/candidate_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/signals/error.h"
#include "support/any_machine.h"
#include "support/message_of.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

/// A stage of one slide with the fault parameters zeta, its damping, and eta, its gear.
class CandidateChoice : public ::testing::Test {
 protected:
  std::vector<std::string> Chosen(std::vector<std::string> only,
                                  std::vector<std::string> without) const {
    std::vector<std::string> names;
    for (const Candidate& candidate :
         ChooseCandidates(stage_.machine, {std::move(only), std::move(without)})) {
      names.push_back(CandidateName(candidate));
    }
    return names;
  }
  std::string Refused(const std::vector<std::string>& only,
                      const std::vector<std::string>& without) const {
    return test::MessageOf<InputError>([&] { Chosen(only, without); });
  }

  const test::Stage stage_;
};

TEST_F(CandidateChoice, LeavesAllWhereNothingIsNamed) {
  EXPECT_EQ(Chosen({}, {}).size(), ListCandidates(stage_.machine).size());
}

TEST_F(CandidateChoice, LeavesOutAnEffectEverywhereOrAtASite) {
  EXPECT_THAT(Chosen({}, {"encoder_scale"}),
              AllOf(Not(Contains("encoder_scale@load_encoder")),
                    Contains("encoder_drift@load_encoder")));
  EXPECT_THAT(Chosen({}, {"coulomb_friction@load"}),
              Not(Contains("coulomb_friction@load")));
}

TEST_F(CandidateChoice, LeavesOutAFamilyAndTheFaultParametersThatBelongToIt) {
  const std::vector<std::string> chosen = Chosen({}, {"friction"});
  EXPECT_THAT(chosen, AllOf(Not(Contains("coulomb_friction@load")),
                            Not(Contains("zeta")), Contains("eta")));
}

TEST_F(CandidateChoice, TakesAFaultParameterByTheNamesOfTheEffectThatItStandsFor) {
  EXPECT_THAT(Chosen({"motor_constant"}, {}), ElementsAre("eta"));
  EXPECT_THAT(Chosen({"viscous_friction@load"}, {}), ElementsAre("zeta"));
  EXPECT_THAT(Chosen({}, {"motor_constant@drive"}), Not(Contains("eta")));
  EXPECT_THAT(Chosen({"friction"}, {}),
              AllOf(Contains("zeta"), Contains("coulomb_friction@load"),
                    Not(Contains("eta")), Not(Contains("added_mass@load"))));
}

TEST_F(CandidateChoice, TakesWhatIsLeftOutFromWhatIsChosen) {
  EXPECT_THAT(Chosen({"eta", "added_mass", "encoder_drift"}, {"encoder"}),
              ElementsAre("eta", "added_mass@load"));
}

TEST_F(CandidateChoice, RefusesANameThatMeansNothingAndSaysWhatThereIs) {
  EXPECT_THAT(Refused({}, {"encoder_scal"}),
              AllOf(HasSubstr("--without"), HasSubstr("'encoder_scal'"),
                    HasSubstr("friction, drive, structure, encoder, zeta, eta"),
                    HasSubstr("encoder_scale")));
  EXPECT_THAT(Refused({"coulomb_friction@moon"}, {}),
              AllOf(HasSubstr("--only"), HasSubstr("coulomb_friction@moon"),
                    HasSubstr("expected one of coulomb_friction@load")));
}

TEST_F(CandidateChoice, RefusesAChoiceThatLeavesNothing) {
  EXPECT_THAT(Refused({"eta"}, {"drive"}), HasSubstr("leave no cause"));
}

// Nothing drives it, nothing reads it and no spring of its own holds it.
TEST(Candidates, AreAlsoAtALoadBehindAShaft) {
  const Machine pair = test::MachineOf(
      R"(<mujoco><option timestep="0.001" gravity="0 0 0"/><worldbody>
         <body><joint name="motor" axis="0 0 1"/>
         <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body>
         <body><joint name="load" axis="0 0 1"/>
         <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody>
         <tendon><fixed name="shaft" stiffness="100"><joint joint="motor" coef="1"/>
         <joint joint="load" coef="-1"/></fixed></tendon>
         <actuator><motor name="u" joint="motor"/></actuator>
         <sensor><jointpos name="y" joint="motor"/></sensor></mujoco>)",
      "[rates]\ncontrol = 1000.0\n[sensors.y]\nelement = \"y\"\nunit = \"rad\"\n"
      "[actuators.u]\nelement = \"u\"\nunit = \"N m\"\n");
  const auto names = [&](bool with_seen) {
    std::vector<std::string> all;
    for (const Candidate& one : ChooseCandidates(pair, {}, with_seen)) {
      all.push_back(CandidateName(one));
    }
    return all;
  };
  EXPECT_THAT(names(true), Contains("coulomb_friction@load"));
  EXPECT_THAT(names(false), Not(Contains("coulomb_friction@load")));
}

}  // namespace
}  // namespace mjdiag
