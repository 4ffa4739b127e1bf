// What a plant lacks along a measured motion, as forces at its joints.

#include "mjdiag/discovery/comparison/force_balance.h"

#include <gtest/gtest.h>

#include "support/arm.h"
#include "support/changes.h"

namespace mjdiag {
namespace {

constexpr double kBand = 15.0;  // Hz

struct Balanced {
  test::Arm arm;
  FilteredRun filtered;

  explicit Balanced(const std::vector<std::string>& effects = {})
      : filtered(FilterRun(arm.machine,
                           ToMeasuredRun(arm.setup(), test::Arm::Measure(effects, 1.0)),
                           kBand)) {}
  Eigen::VectorXd Rms(const Changes& changes) const {
    return MissingRms(filtered,
                      InverseDynamicsResidual(arm.machine, changes, filtered).missing);
  }
};

TEST(ForceBalance, ClosesOnTheTrueArm) {
  const Eigen::VectorXd rms = Balanced().Rms({});
  // Its torques go up to 15 N m; encoders of 1e-5 rad make some mN m within the band.
  EXPECT_LT(rms[0], 0.05);
  EXPECT_LT(rms[1], 0.05);
}

TEST(ForceBalance, LacksTheFrictionThatIsThereAndNothingWithIt) {
  const std::vector<std::string> friction = {"viscous_friction@elbow:coefficient=0.4"};
  const Balanced balanced(friction);
  const Eigen::VectorXd without = balanced.Rms({});
  const Eigen::VectorXd with = balanced.Rms(test::With(friction));
  EXPECT_GT(without[1], 5.0 * with[1]);
  EXPECT_LT(with[1], 0.05);
}

TEST(ForceBalance, IsInUnitsOfWhatWasMeasured) {
  // Half of every drive and of every mass moves the same, and lacks as much.
  const Balanced balanced({"viscous_friction@elbow:coefficient=0.4"});
  Changes half;
  for (const char* number :
       {"mass@upper", "mass@fore", "inertia@upper", "inertia@fore", "armature@shoulder",
        "armature@elbow", "gear@motor1", "gear@motor2"}) {
    half.numbers.emplace_back(FindModelParameter(balanced.arm.machine.plant(), number),
                              0.5);
  }
  const Eigen::VectorXd whole = balanced.Rms({});
  const Eigen::VectorXd scaled = balanced.Rms(half);
  EXPECT_NEAR(scaled[1] / whole[1], 1.0, 1e-6);
}

TEST(ForceBalance, DryFrictionOfThePlantIsAsSmoothAsTheReadings) {
  const std::vector<std::string> friction = {"coulomb_friction@elbow:force=0.6"};
  const Balanced balanced(friction);
  const Machine machine = balanced.arm.machine.With(test::With(friction));
  const Eigen::VectorXd with =
      MissingRms(balanced.filtered,
                 InverseDynamicsResidual(machine, {}, balanced.filtered).missing);
  // What is left stands where the joint turns round: readings are smooth there.
  EXPECT_LT(with[1], 0.3 * balanced.Rms({})[1]);
}

TEST(ForceBalance, CountsNothingAtTheEndsOfARecord) {
  const FilteredRun filtered = Balanced().filtered;
  const Eigen::Index period = 67;  // of the band, in ticks
  EXPECT_FALSE(filtered.counts.head(period).any());
  EXPECT_FALSE(filtered.counts.tail(period).any());
  EXPECT_TRUE(
      filtered.counts.segment(period, filtered.counts.size() - 2 * period).all());
}

}  // namespace
}  // namespace mjdiag
