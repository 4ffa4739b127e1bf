// What motion tells of masses and of where they are.

#include "mjdiag/discovery/hypotheses/mass_moments.h"

#include <gtest/gtest.h>

#include "mjdiag/plugin/plant/scale_number.h"
#include "support/arm.h"

namespace mjdiag {
namespace {

/// Upper arm of 2 kg, 0.2 m from the shoulder; fore arm of 1 kg on the elbow at 0.4 m.
TEST(MassMoments, GatherWhatHangsOnTheNextAxis) {
  const test::Arm arm;
  const std::vector<MassMoment> moments = MassMoments(arm.machine.plant());
  ASSERT_EQ(moments.size(), 4U);
  EXPECT_EQ(moments[1].joint, "shoulder");
  EXPECT_EQ(moments[1].axis, "z");
  EXPECT_NEAR(moments[1].value, -2.0 * 0.2 - 1.0 * 0.4, 1e-12);
  EXPECT_NEAR(moments[3].value, -1.0 * 0.15, 1e-12);
}

TEST(MassMoments, DoNotChangeWithWhatNoMotionTells) {
  // A part of the mass moves from the upper arm's end to the elbow itself: no joint feels it.
  const test::Arm arm;
  const ModelPtr other = CopyModel(arm.machine.plant());
  const int upper = FindElement(*other, mjOBJ_BODY, "upper");
  const int fore = FindElement(*other, mjOBJ_BODY, "fore");
  const double moved = 0.3;
  const double mass = other->body_mass[upper];
  double& centre = other->body_ipos[3 * upper + 2];
  centre = (mass * centre + moved * 0.4) / (mass - moved);
  other->body_mass[upper] -= moved;
  other->body_ipos[3 * fore + 2] *=
      other->body_mass[fore] / (other->body_mass[fore] + moved);
  other->body_mass[fore] += moved;
  const std::vector<MassMoment> before = MassMoments(arm.machine.plant());
  const std::vector<MassMoment> after = MassMoments(*other);
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_NEAR(after[i].value, before[i].value, 1e-12) << i;
  }
}

TEST(ModelParameter, MovesACentreOfMassByItsShareOfTheSizeOfTheBody) {
  const test::Arm arm;
  const ModelPtr plant = CopyModel(arm.machine.plant());
  const ModelParameter number = FindModelParameter(*plant, "centre_z@fore");
  const int fore = number.element;
  const double unit = std::sqrt((0.008 + 0.008 + 0.001) / (2.0 * 1.0));
  Scale(*plant, number, std::exp(0.1));
  EXPECT_NEAR(plant->body_ipos[3 * fore + 2], -0.15 + 0.1 * unit, 1e-12);
  EXPECT_EQ(plant->body_mass[fore], 1.0);
}

}  // namespace
}  // namespace mjdiag
