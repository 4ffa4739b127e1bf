#include "mjdiag/plugin/draft/setup_draft.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/setup/measured_file.h"
#include "mjdiag/signals/text_file.h"
#include "plugin/draft/swung_arm.h"

namespace mjdiag {
namespace {

using test::Arm;
using test::kEncoder;
using test::kMotor;
using test::Row;
using test::SwungLog;
using test::SwungMoment;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kDegrees = 180.0 / std::numbers::pi;

class SetupDraftOf : public ::testing::Test {
 protected:
  SetupDraft Draft(const std::string& plant, const std::string& log) {
    const std::string file = folder_.Write("model.xml", plant);
    source_ = LoadSourcePlant(file);
    return DraftSetup(source_, file, log.empty() ? "" : folder_.Write("log.csv", log));
  }
  /// What every command makes of it.
  Machine Written(const SetupDraft& draft) {
    std::filesystem::create_directories(folder_ / "out");
    WriteDraft(draft, source_, folder_ / "out");
    return Machine(ReadSetup(folder_ / "out"));
  }
  test::TemporaryFolder folder_;
  SourcePlant source_;
};

std::string InRadians(const SwungMoment& m) { return Row(m.time, m.angle, m.torque); }
std::string InDegrees(const SwungMoment& m) {
  return Row(m.time, kDegrees * m.angle, m.torque);
}

TEST_F(SetupDraftOf, ALogWithUnitsIsCertainAndIsReadUnchanged) {
  const SetupDraft draft =
      Draft(Arm(kMotor + kEncoder), SwungLog("t [s],q [rad],tau [N m]", InRadians));
  EXPECT_THAT(draft.questions, IsEmpty());
  EXPECT_FALSE(draft.additions.any());
  const Machine machine = Written(draft);
  EXPECT_EQ(machine.rates().control, 500.0);
  EXPECT_EQ(machine.rates().substeps, 2);
  const Record record = ReadMeasured(machine.setup(), folder_ / "log.csv").record;
  EXPECT_EQ(record.At("q").unit, "rad");
  EXPECT_EQ(record.At("tau").unit, "N m");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out" / "plant.xml"));
}

TEST_F(SetupDraftOf, UnitsThatNobodySaysFollowFromTheForces) {
  const SetupDraft degrees =
      Draft(Arm(kMotor + kEncoder), SwungLog("t,q,tau [N m]", InDegrees));
  EXPECT_THAT(degrees.questions, IsEmpty());
  EXPECT_EQ(degrees.sensors.at(0).column_unit, "deg");
  const SetupDraft radians =
      Draft(Arm(kMotor + kEncoder), SwungLog("t,q,tau", InRadians));
  EXPECT_THAT(radians.questions, IsEmpty());
  EXPECT_EQ(radians.sensors.at(0).column_unit, "rad");
  EXPECT_EQ(radians.actuators.at(0).column_unit, "N m");
}

TEST_F(SetupDraftOf, AUnitThatNothingTellsIsAQuestion) {
  const SetupDraft draft =
      Draft(Arm(kMotor + kEncoder), SwungLog("t,q,tau [N m]", [](const SwungMoment& m) {
              return Row(m.time, 0.1, 0.0 * m.torque);  // it stands
            }));
  EXPECT_THAT(draft.questions, ElementsAre(HasSubstr("rad or deg")));
}

TEST_F(SetupDraftOf, AJointsRangeRulesAUnitOut) {
  std::string plant = Arm(kMotor + kEncoder);
  const std::string joint = "name=\"hinge\"";
  plant.insert(plant.find(joint), "limited=\"true\" range=\"-90 90\" ");
  const SetupDraft draft =
      Draft(plant, SwungLog("t,q,tau [N m]", [](const SwungMoment& m) {
              return Row(m.time, 45.0, 0.0 * m.torque);
            }));
  EXPECT_THAT(draft.questions, IsEmpty());
  EXPECT_EQ(draft.sensors.at(0).column_unit, "deg");
}

TEST_F(SetupDraftOf, ForcesDecideWhichColumnDrivesAMotor) {
  const SetupDraft draft = Draft(
      Arm(kMotor + kEncoder),
      SwungLog("t,q [rad],ia [A],va [V]", [](const SwungMoment& m) {
        return Row(m.time, m.angle, 3.0 * m.speed, m.torque);  // the plant is in V
      }));
  EXPECT_THAT(draft.questions, IsEmpty());
  EXPECT_EQ(draft.actuators.at(0).column, "va");
}

TEST_F(SetupDraftOf, AForceThatPushesTheOtherWayRoundIsAQuestion) {
  const SetupDraft draft = Draft(
      Arm(kMotor + kEncoder), SwungLog("t,q [rad],tau [N m]", [](const SwungMoment& m) {
        return Row(m.time, m.angle, -m.torque);
      }));
  EXPECT_THAT(draft.questions, ElementsAre(HasSubstr("sign of 'tau'")));
}

TEST_F(SetupDraftOf, AMotorThatMayHaveBeenOffIsAQuestion) {
  const auto log = [](double off_after) {
    return SwungLog("t,q [rad],tau [N m],torque_enable", [=](const SwungMoment& m) {
      return Row(m.time, m.angle, m.torque, m.time < off_after ? 1.0 : 0.0);
    });
  };
  const std::string plant = Arm(kMotor + kEncoder);
  EXPECT_THAT(Draft(plant, log(3.0)).questions, ElementsAre(HasSubstr("enabled_by")));
  EXPECT_THAT(Draft(plant, log(9.0)).questions, IsEmpty());
}

TEST_F(SetupDraftOf, ALateInputIsSaidAndNotPutIn) {
  const SetupDraft draft =
      Draft(Arm(kMotor + kEncoder), SwungLog("t,q [rad],tau [N m]", InRadians, 7));
  EXPECT_THAT(draft.questions, IsEmpty());
  EXPECT_THAT(draft.notes, ElementsAre(HasSubstr("14.0 ms")));
}

TEST_F(SetupDraftOf, WhatThePlantLacksIsInACopy) {
  const SetupDraft draft = Draft(Arm(""), SwungLog("t,q [rad],tau [N m]", InRadians));
  EXPECT_THAT(draft.questions, IsEmpty());
  const Machine machine = Written(draft);
  EXPECT_EQ(machine.plant().nu, 1);
  EXPECT_EQ(machine.plant().nsensor, 1);
  const std::string plant = ReadTextFile(folder_ / "out" / "plant.xml");
  EXPECT_THAT(plant, HasSubstr("<!-- as drawn -->"));
  EXPECT_THAT(plant, HasSubstr("<motor name=\"hinge\" joint=\"hinge\"/>"));
}

TEST_F(SetupDraftOf, NamelessElementsGetNames) {
  std::string plant =
      Arm("<default><motor forcelimited=\"false\"/></default>"
          "<actuator><motor joint=\"hinge\"/></actuator>");
  const SetupDraft draft = Draft(plant, SwungLog("t,q [rad],tau [N m]", InRadians));
  const Machine machine = Written(draft);
  EXPECT_EQ(machine.setup().channels.actuators.at(0).element, "actuator_0");
}

TEST_F(SetupDraftOf, AStepThatIsNoPartOfTheTickIsMadeShorter) {
  const SetupDraft draft =
      Draft(Arm(kMotor + kEncoder, R"(<option timestep="0.0015"/>)"),
            SwungLog("t,q [rad],tau [N m]", InRadians));
  const Machine machine = Written(draft);
  EXPECT_EQ(machine.rates().control, 500.0);
  EXPECT_EQ(machine.rates().substeps, 2);
}

TEST_F(SetupDraftOf, AnIntegratorOfSeveralEvaluationsIsReplaced) {
  const SetupDraft draft = Draft(
      Arm(kMotor + kEncoder, R"(<option timestep="0.001" integrator="RK4"/>)"), "");
  EXPECT_EQ(Written(draft).plant().opt.integrator, mjINT_EULER);
}

TEST_F(SetupDraftOf, ActuatorsThatNothingDrivesAreSaid) {
  const SetupDraft draft = Draft(
      Arm("<actuator><motor name=\"motor\" joint=\"hinge\"/><position name=\"hold\" "
          "joint=\"hinge\" kp=\"1\"/></actuator>" +
          kEncoder),
      SwungLog("t,q [rad],tau [N m]", InRadians));
  EXPECT_THAT(draft.notes, Contains(HasSubstr("'hold': 0 all the time")));
}

TEST_F(SetupDraftOf, AColumnOfAVectorSaysNotWhichOfItsNumbers) {
  const std::string sensors =
      "<sensor><jointpos name=\"encoder\" joint=\"hinge\"/>"
      "<framelinvel name=\"tip\" objtype=\"body\" objname=\"link\"/></sensor>";
  const auto row = [](const SwungMoment& m) {
    return Row(m.time, m.angle, m.torque, -0.2 * m.speed);
  };
  const SetupDraft draft =
      Draft(Arm(kMotor + sensors), SwungLog("t,q [rad],tau [N m],tip [m/s]", row));
  EXPECT_THAT(draft.unused, ElementsAre(HasSubstr("name it 'tip_x', _y or _z")));
  EXPECT_EQ(draft.sensors.size(), 1u);
}

TEST_F(SetupDraftOf, NamesThatSayNothingAreAQuestion) {
  const SetupDraft draft =
      Draft(Arm(kMotor + kEncoder), SwungLog("t,foo,bar", InRadians));
  EXPECT_THAT(draft.questions, Contains(HasSubstr("'foo', 'bar'")));
}

TEST_F(SetupDraftOf, WithoutALogItHasAllJointsAndActuators) {
  const SetupDraft draft = Draft(Arm(""), "");
  EXPECT_THAT(draft.questions, IsEmpty());
  const Machine machine = Written(draft);
  EXPECT_EQ(machine.channels().sensors.size(), 1u);
  EXPECT_EQ(machine.channels().actuators.size(), 1u);
}

}  // namespace
}  // namespace mjdiag
