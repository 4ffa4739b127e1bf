#include "mjdiag/plugin/draft/name_match.h"

#include <gtest/gtest.h>

#include "mjdiag/signals/column_name.h"
#include "support/small_plant.h"

namespace mjdiag {
namespace {

std::vector<ColumnWords> Columns(const std::vector<std::string>& headers) {
  std::vector<ColumnWords> columns;
  for (const std::string& header : headers) {
    columns.push_back(ReadColumnWords(ParseColumnHeader(header)));
  }
  return columns;
}

/// "shoulder=q1 elbow=q2", places that no column is of left out.
template <typename Place>
std::string Said(const std::vector<Place>& places,
                 const std::vector<ColumnChoice>& choices,
                 const std::vector<ColumnWords>& columns) {
  std::string text;
  for (std::size_t p = 0; p < places.size(); ++p) {
    if (!choices[p].column) continue;
    text += (text.empty() ? "" : " ") + places[p].element + "=" +
            columns[*choices[p].column].name;
  }
  return text;
}

std::string Readings(const mjModel& model, const std::vector<std::string>& headers) {
  const std::vector<Reading> readings = PlantReadings(model);
  const std::vector<ColumnWords> columns = Columns(headers);
  return Said(readings, MatchReadings(readings, columns), columns);
}

std::string Drives(const mjModel& model, const std::vector<std::string>& headers) {
  const std::vector<Drive> drives = PlantDrives(model);
  const std::vector<ColumnWords> columns = Columns(headers);
  const std::vector<bool> taken(columns.size(), false);
  return Said(drives, MatchDrives(drives, columns, taken), columns);
}

constexpr const char* kLinks = R"(<worldbody><body>
    <joint name="shoulder" axis="0 1 0"/><geom size=".1"/>
    <body pos="0 0 -.3"><joint name="elbow" axis="0 1 0"/><geom size=".1"/></body>
  </body></worldbody>)";

class NameMatch : public ::testing::Test {
 protected:
  static ModelPtr Links(const std::string& more) {
    return test::SmallPlant(kLinks + more);
  }
};

TEST_F(NameMatch, FollowsTheNamesOfJoints) {
  const ModelPtr model = Links("");
  EXPECT_EQ(Readings(*model, {"elbow_pos", "shoulder_pos", "shoulder_vel"}),
            "shoulder=shoulder_pos elbow=elbow_pos");
}

TEST_F(NameMatch, TakesNumberedColumnsInTheOrderOfJointsWithoutNumbers) {
  const ModelPtr model = Links("");
  EXPECT_EQ(Readings(*model, {"q[0]", "q[1]"}), "shoulder=q[0] elbow=q[1]");
}

TEST_F(NameMatch, CountsFromZeroWhereJointsCountFromOne) {
  const ModelPtr model = test::SmallPlant(R"(<worldbody>
    <body><joint name="joint1" axis="0 1 0"/><geom size=".1"/>
    <body pos="0 0 -.3"><joint name="joint2" axis="0 1 0"/><geom size=".1"/></body>
    </body></worldbody>)");
  EXPECT_EQ(Readings(*model, {"q_0", "q_1"}), "joint1=q_0 joint2=q_1");
  EXPECT_EQ(Readings(*model, {"q2", "q1"}), "joint1=q1 joint2=q2");
}

TEST_F(NameMatch, LeavesOpenWhatOneColumnMayBeOf) {
  const ModelPtr model = Links("");
  const std::vector<Reading> readings = PlantReadings(*model);
  const std::vector<ColumnChoice> choices = MatchReadings(readings, Columns({"q"}));
  for (const ColumnChoice& choice : choices) {
    EXPECT_FALSE(choice.column);
    EXPECT_EQ(choice.others, std::vector<std::size_t>{0});
  }
}

TEST_F(NameMatch, DoesNotTakeAWantedPositionForAMeasuredOne) {
  const ModelPtr model = Links("");
  EXPECT_EQ(Readings(*model, {"elbow_pos_ref", "elbow_pos"}), "elbow=elbow_pos");
}

TEST_F(NameMatch, PutsWhatWasMeasuredBeforeWhatWasCommanded) {
  const ModelPtr model =
      Links("<actuator><motor name='motor' joint='elbow'/></actuator>");
  EXPECT_EQ(Drives(*model, {"tau_cmd", "tau_meas", "tau_des"}), "motor=tau_meas");
  EXPECT_EQ(Drives(*model, {"tau_des [N m]", "tau_cmd [N m]"}), "motor=tau_cmd");
}

TEST_F(NameMatch, GivesAServoWhatItWasTold) {
  const ModelPtr model =
      Links("<actuator><position name='servo' joint='elbow' kp='10'/></actuator>");
  EXPECT_EQ(Drives(*model, {"elbow [rad]", "cmd [rad]", "tau [N m]"}), "servo=cmd");
}

TEST_F(NameMatch, GivesAMotorWithBackEmfAVoltage) {
  const ModelPtr model =
      Links(R"(<actuator><general name="motor" joint="elbow" gear="0.4" gainprm="0.2"
               biastype="affine" biasprm="0 0 -0.2"/></actuator>)");
  EXPECT_EQ(Drives(*model, {"i [A]", "u [V]"}), "motor=u");
}

TEST_F(NameMatch, LeavesOpenWhichUnitAGearIsOf) {
  const ModelPtr model =
      Links("<actuator><motor name='motor' joint='elbow' gear='14'/></actuator>");
  EXPECT_EQ(Drives(*model, {"i [A]", "tau [N m]"}), "");
  EXPECT_EQ(Drives(*model, {"i [A]", "tau_des [N m]"}), "motor=i");
}

TEST_F(NameMatch, AddsNoMotorForAColumnThatAnotherMotorCanTake) {
  const ModelPtr model =
      Links("<actuator><motor name='motor' joint='elbow'/></actuator>");
  EXPECT_EQ(Drives(*model, {"tau_meas [N m]", "tau_cmd [N m]"}), "motor=tau_meas");
  EXPECT_EQ(Drives(*model, {"tau_elbow [N m]", "tau_shoulder [N m]"}),
            "motor=tau_elbow shoulder=tau_shoulder");
}

TEST_F(NameMatch, AddsNoMotorForAmperes) {
  const ModelPtr model = Links("");
  EXPECT_EQ(Drives(*model, {"elbow_current [A]", "shoulder_torque [N m]"}),
            "shoulder=shoulder_torque");
}

TEST_F(NameMatch, NamesComponentsOfVectorsByTheirLetters) {
  const ModelPtr model = test::SmallPlant(test::kQuadrotor);
  EXPECT_EQ(Readings(*model, {"z [m]", "wx [rad/s]"}), "pos=z gyro=wx");
  EXPECT_EQ(Drives(*model, {"t1 [N]", "t3 [N]"}), "t1=t1 t3=t3");
}

TEST_F(NameMatch, ReadsSpeedsWhereNoPositionIs) {
  const ModelPtr model =
      Links("<sensor><jointvel name='tacho' joint='elbow'/></sensor>");
  EXPECT_EQ(Readings(*model, {"elbow_vel [rad/s]"}), "tacho=elbow_vel");
  EXPECT_EQ(Readings(*model, {"elbow_vel [rad/s]", "elbow_pos [rad]"}),
            "elbow=elbow_pos");
}

}  // namespace
}  // namespace mjdiag
