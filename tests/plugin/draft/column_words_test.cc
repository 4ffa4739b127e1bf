#include "mjdiag/plugin/draft/column_words.h"

#include <gtest/gtest.h>

#include "mjdiag/signals/column_name.h"

namespace mjdiag {
namespace {

ColumnWords Read(const std::string& header) {
  return ReadColumnWords(ParseColumnHeader(header));
}

TEST(ColumnWords, TellQuantityPlaceAndUnitFromTheName) {
  const ColumnWords words = Read("FL_hip_pos_deg");
  EXPECT_EQ(words.quantity, Quantity::kPosition);
  EXPECT_EQ(words.place.words, (std::vector<std::string>{"fl", "hip"}));
  EXPECT_EQ(words.unit, "deg");
  EXPECT_FALSE(words.unit_in_header);
}

TEST(ColumnWords, TakeTheUnitInBracketsBeforeTheName) {
  const ColumnWords words = Read("angle_deg [rad]");
  EXPECT_EQ(words.unit, "rad");
  EXPECT_TRUE(words.unit_in_header);
}

TEST(ColumnWords, UnderstandUnitsAsPeopleSpellThem) {
  EXPECT_EQ(Read("torque_mNm").unit, "mN m");
  EXPECT_EQ(Read("w_rad_s").unit, "rad/s");
  EXPECT_EQ(Read("Time (sec)").unit, "s");
  EXPECT_FALSE(Read("Time (sec)").unit_in_header);
  EXPECT_EQ(Read("theta1_deg_2").unit, "deg");
}

TEST(ColumnWords, DoNotTakeANameForAUnit) {
  EXPECT_FALSE(Read("V").unit);
  EXPECT_FALSE(Read("m1").unit);
  EXPECT_FALSE(Read("q_1").unit);
}

TEST(ColumnWords, TellWhatWasMeasuredFromWhatWasWanted) {
  EXPECT_EQ(Read("tau_meas").role, ColumnRole::kMeasured);
  EXPECT_EQ(Read("q_des[3]").role, ColumnRole::kReference);
  EXPECT_EQ(Read("i_cmd").role, ColumnRole::kCommand);
  EXPECT_EQ(Read("tau_ff1").role, ColumnRole::kOther);
  EXPECT_EQ(Read("motorVelocity2").quantity, Quantity::kVelocity);
}

TEST(ColumnWords, LetTheUnitCorrectAWord) {
  const ColumnWords thrust = Read("t1 [N]");
  EXPECT_EQ(thrust.quantity, Quantity::kDrive);
  EXPECT_EQ(thrust.place.words, std::vector<std::string>{"t"});
  EXPECT_EQ(thrust.place.numbers, std::vector<int>{1});
}

TEST(ColumnWords, NameAUnitThatIsNotKnown) {
  EXPECT_EQ(Read("pos [cm]").unknown_unit, "cm");
}

TEST(Agreement, IsOfTheSameWordsAndNumbers) {
  const auto agreement = [](const char* column, const char* element) {
    return Agreement(ReadPlaceWords(column), ReadPlaceWords(element));
  };
  EXPECT_EQ(agreement("q_mot1", "motor1"), 1.0);
  EXPECT_LT(agreement("q_link1", "motor1"), agreement("q_link1", "link_encoder1"));
  EXPECT_LT(agreement("q1", "joint2"), 0.0);
  EXPECT_EQ(agreement("arm_pos", "stage"), 0.0);
  EXPECT_GT(agreement("q", "elbow"), 0.0);  // says nothing of the place
}

}  // namespace
}  // namespace mjdiag
