// One regression of what a plant lacks, with the noise of the model among its unknowns.

#include "mjdiag/discovery/forces/force_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kValues = 600;

/// Two joints with values one after the other, of which a fit sees all.
ForceRows TwoJoints() {
  ForceRows rows;
  rows.dofs = {0, 1};
  for (Index k = 0; k < kValues; ++k) {
    rows.samples.push_back(k);
    rows.begins.push_back(k == 0);
  }
  rows.train = kValues;
  return rows;
}

/// A latent force of that time constant at both joints.
VectorXd Latent(double phi, double sd, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  VectorXd all(2 * kValues);
  double r = 0.0;
  for (double& value : all) value = r = phi * r + sd * normal(random);
  return all;
}

VectorXd Wave(double period) {
  VectorXd all = VectorXd::Zero(2 * kValues);
  for (Index k = 0; k < kValues; ++k) {
    all[k] = std::sin(6.283185307 * static_cast<double>(k) / period);
  }
  return all;
}

ForceProblem Problem(const VectorXd& missing) {
  ForceProblem problem;
  problem.rows = TwoJoints();
  problem.missing = missing;
  problem.numbers = MatrixXd(missing.size(), 0);
  problem.drives = VectorXd(0);
  return problem;
}

// Bounds: four standard deviations of what so many values tell.
TEST(ForceModel, KnowsSizeAndTimeConstantOfTheNoise) {
  const ForceNoise noise = NoiseOfNothing(Problem(Latent(0.7, 0.2, 1)));
  for (Index j = 0; j < 2; ++j) {
    EXPECT_NEAR(noise.phi[j], 0.7, 4.0 * std::sqrt((1.0 - 0.49) / kValues));
    EXPECT_NEAR(noise.sd[j], 0.2, 4.0 * 0.2 / std::sqrt(2.0 * kValues));
  }
}

TEST(ForceModel, FindsTheSizeOfALawWithinItsNoise) {
  const ForceProblem problem = Problem(Latent(0.7, 0.2, 2) + 0.3 * Wave(40.0));
  const ForceGroup law{Wave(40.0), {}, false, 0.0};
  const ForceFit fit = FitForces(problem, {&law}, NoiseOfNothing(problem));
  const double information =
      Whitened(problem.rows, fit.noise, law.columns).squaredNorm();
  EXPECT_NEAR(fit.amplitudes[0], 0.3, 4.0 / std::sqrt(information));
}

TEST(ForceModel, TakesNoLawThatIsBelowItsBound) {
  const ForceProblem problem = Problem(Latent(0.5, 0.1, 3) - 0.3 * Wave(40.0));
  const ForceGroup law{Wave(40.0), VectorXd::Zero(1), false, 0.0};
  const ForceNoise noise = NoiseOfNothing(problem);
  EXPECT_TRUE(std::isinf(FitForces(problem, {&law}, noise).score));
  const ForceFit nothing = FitForces(problem, {}, noise);
  EXPECT_TRUE(std::isinf(GainsBeside(problem, {}, nothing, {&law})[0]));
}

TEST(ForceModel, PredictsUnseenPartsByALawThatIsThereOnly) {
  const ForceProblem problem = Problem(Latent(0.7, 0.2, 4) + 0.3 * Wave(40.0));
  const ForceGroup there{Wave(40.0), {}, false, 0.0};
  const ForceGroup none{Wave(13.0), {}, false, 0.0};
  const ForceFit fit = FitForces(problem, {&there, &none}, NoiseOfNothing(problem));
  const VectorXd loss = LossUnseen(problem, {&there, &none}, fit).each;
  EXPECT_GT(loss[0], 20.0);
  EXPECT_LT(loss[1], 6.0);
}

TEST(ForceModel, NoMotorThatDoesNothingExplainsAJointThatWeighsNothing) {
  // What was measured is friction of a joint without inertia: the input does nothing but
  // overcome it. A motor of no force would leave nothing.
  const VectorXd friction = Wave(40.0).cwiseSign();
  const VectorXd measured = friction + Latent(0.5, 0.1, 5);
  const ForceProblem problem = Problem(-measured);
  const ForceGroup motor{measured, {}, true, 0.0};
  const ForceGroup law{-friction, VectorXd::Zero(1), false, 0.0};
  const ForceNoise noise = NoiseOfNothing(problem);
  EXPECT_LT(FitForces(problem, {&law}, noise).score,
            FitForces(problem, {&motor}, noise).score);
}

}  // namespace
}  // namespace mjdiag
