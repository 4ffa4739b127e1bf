#include "mjdiag/diagnosis/model/linear_chain.h"

#include <gtest/gtest.h>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Vector3d;

ChainJoint Hinge(const Vector3d& axis, const Vector3d& point) {
  return {"hinge", true, axis, point, 0.0, 0.0};
}

/// A point mass 0.3 m below a hinge along y.
LinearChain Pendulum() {
  LinearChain chain;
  chain.bodies = {{"bob",
                   "",
                   {Hinge(Vector3d::UnitY(), Vector3d(0, 0, 1))},
                   2.0,
                   Vector3d(0, 0, 0.7),
                   Vector3d::Zero()}};
  return chain;
}

TEST(LinearChain, PendulumHasItsInertiaAndGravityStiffness) {
  const MechanicalModel model = Linearize(Pendulum());
  EXPECT_NEAR(model.M(0, 0), 2.0 * 0.09, 1e-15);
  EXPECT_NEAR(model.K(0, 0), 2.0 * 9.81 * 0.3, 1e-14);
}

TEST(LinearChain, PendulumAboveItsHingeHasNegativeStiffness) {
  LinearChain chain = Pendulum();
  chain.bodies[0].centre.z() = 1.3;
  EXPECT_NEAR(Linearize(chain).K(0, 0), -2.0 * 9.81 * 0.3, 1e-14);
}

TEST(LinearChain, DoublePendulumHasTheTextbookMatrices) {
  LinearChain chain = Pendulum();
  chain.bodies.push_back({"second",
                          "bob",
                          {Hinge(Vector3d::UnitY(), Vector3d(0, 0, 0.7))},
                          1.5,
                          Vector3d(0, 0, 0.5),
                          Vector3d::Zero()});
  const MechanicalModel model = Linearize(chain);
  // Relative angles; l1 = 0.3, l2 = 0.2.
  EXPECT_NEAR(model.M(0, 0), 2.0 * 0.09 + 1.5 * 0.25, 1e-14);
  EXPECT_NEAR(model.M(0, 1), 1.5 * 0.2 * 0.5, 1e-14);
  EXPECT_NEAR(model.K(0, 0), 9.81 * (2.0 * 0.3 + 1.5 * 0.5), 1e-13);
  EXPECT_NEAR(model.K(0, 1), 9.81 * 1.5 * 0.2, 1e-14);
  EXPECT_NEAR(model.K(1, 0), model.K(0, 1), 1e-15);
  EXPECT_NEAR(model.K(1, 1), 9.81 * 1.5 * 0.2, 1e-14);
}

TEST(LinearChain, GravityDoesNothingToSlidesAndVerticalHinges) {
  LinearChain chain;
  ChainJoint slide{"slide", false, Vector3d::UnitX(), Vector3d::Zero(), 7.0, 3.0};
  chain.bodies = {{"stage",
                   "",
                   {slide, Hinge(Vector3d::UnitZ(), Vector3d::Zero())},
                   2.0,
                   Vector3d(0.1, 0.2, 0.3),
                   Vector3d(0.01, 0.01, 0.02)}};
  const MechanicalModel model = Linearize(chain);
  EXPECT_EQ(model.K, Eigen::MatrixXd(Eigen::Vector2d(7.0, 0.0).asDiagonal()));
  EXPECT_EQ(model.D, Eigen::MatrixXd(Eigen::Vector2d(3.0, 0.0).asDiagonal()));
  EXPECT_NEAR(model.M(0, 1), -2.0 * 0.2, 1e-15);
  EXPECT_NEAR(model.M(1, 1), 2.0 * 0.05 + 0.02, 1e-15);
}

TEST(LinearChain, PortActsOnlyInTheJointsBetweenItsBodies) {
  LinearChain chain;
  const ChainJoint base{"base", true, Vector3d::UnitZ(), Vector3d::Zero(), 1.0, 1.0};
  const ChainJoint slide{"slide", false, Vector3d::UnitX(), Vector3d::Zero(), 0.0, 1.0};
  const ChainJoint yaw{"yaw", true, Vector3d::UnitZ(), Vector3d(0.1, 0, 0), 1.0, 1.0};
  chain.bodies = {
      {"base", "", {base}, 1.0, Vector3d::Zero(), Vector3d::Ones()},
      {"stage", "base", {slide, yaw}, 1.0, Vector3d::Zero(), Vector3d::Ones()}};
  chain.actuators = {
      {"u", "stage", "base", false, Vector3d::UnitX(), Vector3d(0.5, 0.04, 0), 2.0}};
  chain.sensors = {
      {"angle", "stage", "", true, Vector3d::UnitZ(), Vector3d::Zero(), 1.0}};
  const MechanicalModel model = Linearize(chain);
  EXPECT_TRUE(model.Gamma.col(0).isApprox(Eigen::Vector3d(0.0, 2.0, -0.08)));
  EXPECT_TRUE(model.b.col(0).isApprox(Eigen::Vector3d(1.0, 0.0, 1.0)));
}

TEST(LinearChain, NamesAnUnknownBody) {
  LinearChain chain = Pendulum();
  chain.actuators = {{"u", "bib", "", false, Vector3d::UnitX(), Vector3d::Zero(), 1.0}};
  try {
    Linearize(chain);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("port u: unknown body \"bib\""),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace mjdiag
