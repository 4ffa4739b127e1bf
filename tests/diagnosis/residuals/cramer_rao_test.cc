#include "mjdiag/diagnosis/residuals/cramer_rao.h"

#include <gtest/gtest.h>

#include <cmath>

#include "diagnosis/test_stage.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kSamples = 1500;

InformationBound StageBound() {
  return CramerRaoBound(OutputSensitivities(test::PerturbedStages(), test::kTiming,
                                            test::Drive(kSamples)),
                        Eigen::Vector2d::Constant(test::kNoise));
}

TEST(CramerRaoBound, OfAFreeMassWithUnknownGainIsAnalytic) {
  // Constant force F on a mass m from rest: q = h^2 F / m j (j + 1) / 2 after j Euler
  // steps, read every fourth, and so is its derivative by the gain. The bound is
  // sd / sqrt(sum q^2).
  constexpr double kMass = 2.0;
  constexpr double kForce = 3.0;
  const auto mass = [=](double gain) {
    MechanicalModel model;
    model.M = MatrixXd::Constant(1, 1, kMass);
    model.D = model.K = MatrixXd::Zero(1, 1);
    model.Gamma = MatrixXd::Constant(1, 1, gain);
    model.b = MatrixXd::Ones(1, 1);
    return model;
  };
  const MatrixXd commands = MatrixXd::Constant(1, 100, kForce);
  const std::vector<MatrixXd> sensitivities = OutputSensitivities(
      {{"gain", 1e-3, mass(1.0 - 1e-3), mass(1.0 + 1e-3)}}, test::kTiming, commands);
  double sum = 0.0;
  for (int tick = 0; tick < 100; ++tick) {
    const double steps = 4.0 * tick;
    const double position = test::kTiming.step * test::kTiming.step * kForce / kMass *
                            steps * (steps + 1.0) / 2.0;
    EXPECT_NEAR(sensitivities[0](0, tick), position, 1e-9 * position);
    sum += position * position;
  }
  const InformationBound bound =
      CramerRaoBound(sensitivities, VectorXd::Constant(1, test::kNoise));
  EXPECT_NEAR(bound.alone[0], test::kNoise / std::sqrt(sum), 1e-8 * bound.alone[0]);
  EXPECT_NEAR(bound.together[0], bound.alone[0], 1e-12 * bound.alone[0]);
}

TEST(CramerRaoBound, WeighsSensorsByTheirNoise) {
  // One fault seen as 1 by a sensor of sd 1 and as 2 by one of sd 4, three times.
  const MatrixXd seen = (MatrixXd(2, 3) << 1, 1, 1, 2, 2, 2).finished();
  const InformationBound bound = CramerRaoBound({seen}, Eigen::Vector2d(1.0, 4.0));
  EXPECT_NEAR(bound.alone[0], 1.0 / std::sqrt(3.0 * (1.0 + 0.25)), 1e-12);
}

TEST(CramerRaoBound, OfFaultsTogetherIsNeverBelowThatOfOneAlone) {
  const InformationBound bound = StageBound();
  ASSERT_EQ(bound.alone.size(), 3);
  EXPECT_TRUE((bound.together.array() >= bound.alone.array()).all());
  // Correlated by 0.8: a factor of 1 / 0.6.
  const MatrixXd a = (MatrixXd(1, 2) << 1.0, 0.0).finished();
  const MatrixXd b = (MatrixXd(1, 2) << 0.8, 0.6).finished();
  const InformationBound pair = CramerRaoBound({a, b}, VectorXd::Ones(1));
  EXPECT_NEAR(pair.together[0] / pair.alone[0], 1.0 / 0.6, 1e-12);
}

TEST(CramerRaoBound, RefusesCollinearFaultsAndOneWithoutEffect) {
  const VectorXd noise = Eigen::Vector2d::Ones();
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const MatrixXd a = test::WhiteNoise(2, 50, 1.0, seed);
    const MatrixXd b = test::WhiteNoise(2, 50, 1.0, 100 + seed);
    EXPECT_THROW(CramerRaoBound({a, b, 0.3 * a - 7.0 * b}, noise), NumericalError);
    EXPECT_THROW(CramerRaoBound({a, 0.1 * a}, noise), NumericalError);
    EXPECT_THROW(CramerRaoBound({a, 0.0 * b}, noise), NumericalError);
  }
}

TEST(CramerRaoBound, RefusesASensorWithoutNoise) {
  EXPECT_THROW(CramerRaoBound({MatrixXd::Ones(2, 3)}, Eigen::Vector2d(1.0, 0.0)),
               InputError);
}

TEST(OutputResponse, IsTheMachinesOwn) {
  const MatrixXd commands = test::Drive(100);
  EXPECT_EQ(OutputResponse(test::Stage(), test::kTiming, commands),
            test::Motion(test::Stage(), commands).topRows(2));
}

/// Faults that fit the readings best: output error, Gauss and Newton from healthy.
Eigen::Vector3d MaximumLikelihood(const MatrixXd& readings, const MatrixXd& commands,
                                  const MatrixXd& sensitivity) {
  Eigen::Vector3d fault = Eigen::Vector3d::Zero();
  for (int iteration = 0; iteration < 4; ++iteration) {
    const MatrixXd nis =
        readings - test::Motion(test::Stage(test::Moved(fault)), commands).topRows(2);
    fault += LeastSquares(sensitivity, nis.reshaped());
  }
  return fault;
}

TEST(CramerRaoBound, IsReachedByMaximumLikelihood) {
  // The sample variance of R draws scatters by sqrt(2 / R) of itself: five of these.
  constexpr int kDraws = 400;
  const Eigen::Vector3d truth(1e-3, -2e-3, 5e-4);
  const MatrixXd commands = test::Drive(kSamples);
  const MatrixXd motion = test::Motion(test::Stage(test::Moved(truth)), commands);
  const std::vector<MatrixXd> columns =
      OutputSensitivities(test::PerturbedStages(), test::kTiming, commands);
  MatrixXd sensitivity(2 * kSamples, 3);
  for (Index i = 0; i < 3; ++i) {
    sensitivity.col(i) = columns[static_cast<std::size_t>(i)].reshaped();
  }
  Eigen::Array3d square = Eigen::Array3d::Zero();
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    const MatrixXd readings = test::Measured(motion, draw).topRows(2);
    square +=
        (MaximumLikelihood(readings, commands, sensitivity) - truth).array().square();
  }
  const Eigen::Array3d ratio = square / kDraws / StageBound().together.array().square();
  for (Index i = 0; i < 3; ++i) {
    EXPECT_NEAR(ratio[i], 1.0, 5.0 * std::sqrt(2.0 / kDraws))
        << test::kFaults[static_cast<std::size_t>(i)];
  }
}

}  // namespace
}  // namespace mjdiag
