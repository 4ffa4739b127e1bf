#include <gtest/gtest.h>

#include "mjdiag/plugin/plant/linearize.h"
#include "support/arm.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(MotionLinearization, IsThatOfTheRestAtRest) {
  const Machine bonder = test::Bonder();
  const MechanicalModel& rest = bonder.linear();
  const VectorXd none = VectorXd::Zero(bonder.plant().nv);
  const VectorXd off = VectorXd::Zero(std::ssize(bonder.channels().actuators));
  const MechanicalModel here = MotionLinearization(bonder.plant(), bonder.channels())
                                   .At({bonder.rest(), none, none, off});
  EXPECT_EQ(here.M, rest.M);
  EXPECT_LT((here.K - rest.K).norm(), 1e-12 * rest.K.norm());
  EXPECT_LT((here.D - rest.D).norm(), 1e-12 * rest.D.norm());
  EXPECT_EQ(here.Gamma, rest.Gamma);
  EXPECT_EQ(here.b, rest.b);
  EXPECT_EQ(here.coordinates, rest.coordinates);
}

/// Acceleration of the arm.
VectorXd Accelerate(const Machine& arm, const VectorXd& q, const VectorXd& v,
                    const VectorXd& u) {
  const DataPtr data = MakeData(arm.plant());
  VectorXd::Map(data->qpos, 2) = q;
  VectorXd::Map(data->qvel, 2) = v;
  VectorXd::Map(data->ctrl, 2) = u;
  mj_forward(&arm.plant(), data.get());
  return VectorXd::Map(data->qacc, 2);
}

// M a' + D v' + K q' = 0 of small deviations, against MuJoCo's own accelerations.
TEST(MotionLinearization, HasTheAccelerationsOfDeviationsFromAMotion) {
  const test::Arm arm;
  const VectorXd q = (VectorXd(2) << 1.7, -0.8).finished();
  const VectorXd v = (VectorXd(2) << 2.0, -3.0).finished();
  const VectorXd u = (VectorXd(2) << 6.0, 1.5).finished();
  const VectorXd a = Accelerate(arm.machine, q, v, u);
  const MechanicalModel here =
      MotionLinearization(arm.machine.plant(), arm.machine.channels()).At({q, v, a, u});
  constexpr double kStep = 1e-5;
  for (int j = 0; j < 2; ++j) {
    const VectorXd step = kStep * VectorXd::Unit(2, j);
    const VectorXd by_position = (Accelerate(arm.machine, q + step, v, u) -
                                  Accelerate(arm.machine, q - step, v, u)) /
                                 (2.0 * kStep);
    const VectorXd by_velocity = (Accelerate(arm.machine, q, v + step, u) -
                                  Accelerate(arm.machine, q, v - step, u)) /
                                 (2.0 * kStep);
    EXPECT_LT((here.M * by_position + here.K.col(j)).norm(), 1e-6 * here.K.norm());
    EXPECT_LT((here.M * by_velocity + here.D.col(j)).norm(), 1e-6 * here.D.norm());
  }
}

}  // namespace
}  // namespace mjdiag
