#include "mjdiag/discovery/unexplained/active_curve.h"

#include <gtest/gtest.h>

#include "mjdiag/plugin/effects/registry.h"
#include "support/stage.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

/// Over the velocity -0.1 to 0.1 m/s of a stage with a damper of 203.5 N s/m and no dry
/// friction, five knots, each known to 1 N.
bool Drives(const VectorXd& knots, double factor = 0.0, double variable = 1.0) {
  const test::Stage stage;
  VectorXd values =
      VectorXd::Zero(static_cast<Eigen::Index>(ForceCurve().parameters().size()));
  values[*ForceCurve().Find("variable")] = variable;
  values[*ForceCurve().Find("factor")] = factor;
  values[*ForceCurve().Find("low")] = -0.1;
  values[*ForceCurve().Find("width")] = 0.2;
  values[*ForceCurve().Find("knots")] = 5.0;
  values.segment(*ForceCurve().Find("force_1"), 5) = knots;
  return DrivesItsJoint(stage.machine.plant(), 0, values, knots.array() - 1.0,
                        knots.array() + 1.0);
}

TEST(DrivesItsJoint, WhereItPushesMoreThanTheDamperOfThePlantTakes) {
  const double takes = 203.5 * 0.1;
  const VectorXd ahead = VectorXd::Unit(5, 4);
  EXPECT_FALSE(Drives(takes * ahead));
  EXPECT_TRUE(Drives((takes + 1.1) * ahead));
  EXPECT_TRUE(Drives(-(takes + 1.1) * VectorXd::Unit(5, 0)));
  // What brakes, however hard.
  EXPECT_FALSE(Drives(-1000.0 * ahead));
  EXPECT_FALSE(Drives(1000.0 * VectorXd::Unit(5, 0)));
}

TEST(DrivesItsJoint, IsAskedOfTheDirectionAndOfTheVelocityAsFactors) {
  EXPECT_TRUE(Drives(VectorXd::Constant(5, 1.1), 1.0, 0.0));
  EXPECT_FALSE(Drives(VectorXd::Constant(5, 203.0), 2.0, 0.0));
  EXPECT_TRUE(Drives(VectorXd::Constant(5, 205.0), 2.0, 0.0));
  // A spring is no friction.
  EXPECT_FALSE(Drives(VectorXd::Constant(5, 1000.0), 0.0, 0.0));
}

}  // namespace
}  // namespace mjdiag
