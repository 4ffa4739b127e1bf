// Physics that no list holds: learned as what it is, a force without a name.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mjdiag/discovery/discovery.h"
#include "mjdiag/plugin/effects/joint_force.h"
#include "mjdiag/plugin/effects/registry.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

/// A law that the registry does not have.
class OutsideLaw final : public JointForceEffect {
 public:
  using ForceOf = double (*)(double q, double v);
  explicit OutsideLaw(ForceOf force)
      : JointForceEffect({.name = "outside",
                          .family = Family::kStructure,
                          .kind = Kind::kUnknownForce,
                          .variable = LawVariable::kPosition,
                          .parameters = {},
                          .meaning = "none"}),
        force_(force) {}
  double Force(double q, double v, double,
               const EffectValues&) const noexcept override {
    return force_(q, v);
  }
  Sized Draw(const Scales&, Random&) const override { return {}; }

 private:
  ForceOf force_;
};

Record MeasureOutside(const OutsideLaw& law, const test::Stage& stage) {
  Changes changes;
  changes.effects.push_back({Lasting(law), "load", {}});
  return Simulate(stage.machine.With(changes), stage.Motion(), {});
}

Discovery DiscoverOutside(const OutsideLaw& law, const test::Stage& stage,
                          const CandidateChoice& choice = {}) {
  const Record measured = MeasureOutside(law, stage);
  DiscoverOptions discover;
  discover.choice = choice;
  return Discover(stage.machine, measured, nullptr, discover);
}

const FoundCause* Curve(const Discovery& answer) {
  const auto found = std::ranges::find_if(answer.causes, [](const FoundCause& cause) {
    return cause.cause.name() == "force_curve";
  });
  return found == answer.causes.end() ? nullptr : &*found;
}

TEST(ForceCurveDiscovery, LearnsALawOverThePosition) {
  const test::Stage stage;
  const OutsideLaw law([](double q, double) { return 3.0 * std::sin(25.0 * q * q); });
  const Discovery answer = DiscoverOutside(law, stage);
  ASSERT_NE(Curve(answer), nullptr);
  EXPECT_NE(Curve(answer)->unnamed.find("load position"), std::string::npos);
  EXPECT_EQ(answer.verdict, DiscoveryVerdict::kPartlyExplained);
  EXPECT_GT(answer.gain_validation, 0.8);
  // It has no name, but a kind: a force of the position alone.
  ASSERT_FALSE(answer.kinds.empty());
  EXPECT_EQ(answer.kinds[0].kind, Kind::kCompliance);
  EXPECT_EQ(answer.kinds[0].site, "load");
  EXPECT_GT(answer.kinds[0].probability, 0.95);
}

TEST(ForceCurveDiscovery, LearnsALawOverTheVelocity) {
  const test::Stage stage;
  // At 30 v a drag beside a weaker damper leaves no more than noise of it.
  const OutsideLaw law([](double, double v) { return 3.0 * std::sin(80.0 * v); });
  const Discovery answer = DiscoverOutside(law, stage);
  ASSERT_NE(Curve(answer), nullptr);
  EXPECT_NE(Curve(answer)->unnamed.find("load velocity"), std::string::npos);
  EXPECT_EQ(Curve(answer)->cause.site, "load");
  EXPECT_EQ(answer.verdict, DiscoveryVerdict::kPartlyExplained);
  EXPECT_GT(answer.gain_validation, 0.8);
  ASSERT_FALSE(answer.kinds.empty());
  EXPECT_EQ(answer.kinds[0].kind, Kind::kViscousFriction);
  EXPECT_GT(answer.kinds[0].probability, 0.95);
}

}  // namespace
}  // namespace mjdiag
