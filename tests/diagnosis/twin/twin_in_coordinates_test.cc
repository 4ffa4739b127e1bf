#include "mjdiag/diagnosis/twin/twin_in_coordinates.h"

#include <gtest/gtest.h>

#include <memory>

#include "diagnosis/twin/uncertain_stage.h"
#include "mjdiag/diagnosis/twin/linear_twin.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kTicks = 400;

std::unique_ptr<LinearTwin> StageTwin() {
  return std::make_unique<LinearTwin>(
      test::UncertainStage(),
      std::vector<TwinGain>{{MatrixXd::Zero(6, 2), MatrixXd::Identity(2, 2), 0}},
      test::kBlock);
}

/// The last prediction, and the sensitivity of the last block.
std::pair<VectorXd, MatrixXd> Last(Twin& twin, const VectorXd& theta) {
  const MatrixXd inputs = test::Drive(kTicks);
  const VectorXd none = VectorXd::Zero(2);
  VectorXd reading(2);
  MatrixXd psi;
  twin.Start(theta);
  for (Index k = 0; k < kTicks; ++k) {
    twin.Predict(reading);
    twin.Step({inputs.col(k).data(), 2}, none);
    if ((k + 1) % twin.block() == 0) psi = twin.EndBlock();
  }
  return {reading, psi};
}

TEST(TwinInCoordinates, IsTheTwinAtThetaOfItsCoordinates) {
  const std::unique_ptr<LinearTwin> twin = StageTwin();
  const Index p = twin->unknowns();
  // The first three, which are numbers, turned into two.
  MatrixXd T = MatrixXd::Zero(p, p - 1);
  T.topLeftCorner(3, 2) << 0.3, -0.1, 0.2, 0.4, -0.5, 0.1;
  T.bottomRightCorner(p - 3, p - 3).setIdentity();
  TwinInCoordinates turned(StageTwin(), T, test::UncertainStage().tones);
  ASSERT_EQ(turned.unknowns(), p - 1);
  EXPECT_EQ(turned.first_tone(), 2);
  VectorXd z = VectorXd::Zero(p - 1);
  z.head(4) << 0.5, -0.3, 0.02, -0.01;
  const auto [reading, psi] = Last(turned, z);
  const auto [expected, of_theta] = Last(*twin, T * z);
  EXPECT_EQ(reading, expected);
  EXPECT_LT((psi - of_theta * T).norm(), 1e-15 * psi.norm());
}

}  // namespace
}  // namespace mjdiag
