#include "mjdiag/discovery/fitting/cause_fit.h"

#include <gtest/gtest.h>

#include "discovery/candidate_place.h"
#include "discovery/stage_under_test.h"
#include "mjdiag/discovery/fitting/parameter_covariance.h"
#include "mjdiag/discovery/hypotheses/candidate_bounds.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using test::Place;

// 40 draws of noise: the 95 % interval covers at least 32 (the binomial chance of fewer
// is 1e-4).
TEST(CauseFit, HasIntervalsThatHold) {
  const test::StageUnderTest stage;
  int covered = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const DiscoveryProblem problem =
        stage.Pose(stage.Measure({"quadratic_drag@load:coefficient=0.5"}, {}, seed));
    const auto candidates = ListCandidates(stage.machine);
    const std::size_t place = Place(candidates, "quadratic_drag@load");
    const CauseFit fit = FitCauses(problem, candidates,
                                   {{{place, Eigen::VectorXd::Constant(1, 0.4)}}}, {});
    const double sd = std::sqrt(ParameterCovariance(problem, candidates, fit)(0, 0));
    covered += std::abs(fit.causes[0].value[0] - 0.5) < 1.96 * sd;
  }
  EXPECT_GE(covered, 32);
}

TEST(CauseFit, FindsSeveralParametersOfAStrongEffectFromAPoorStart) {
  const test::StageUnderTest stage;
  const DiscoveryProblem problem = stage.Pose(
      stage.Measure({"stribeck_friction@load:coulomb=12,breakaway=8,velocity=0.01"}));
  const auto candidates = ListCandidates(stage.machine);
  const std::size_t place = Place(candidates, "stribeck_friction@load");
  const CauseFit fit =
      FitCauses(problem, candidates, {{{place, Eigen::Vector3d(8.0, 4.0, 0.02)}}},
                {30, 1e-8, true, nullptr});
  EXPECT_NEAR(fit.causes[0].value[0], 12.0, 0.05);
  EXPECT_NEAR(fit.causes[0].value[1], 8.0, 0.1);
  EXPECT_NEAR(fit.causes[0].value[2], 0.01, 3e-4);
  EXPECT_NEAR(fit.train, 1.0, 0.1);
}

// Broyden's updates change the way, not the place: within a tenth of the interval.
TEST(CauseFit, BySecantsFindsTheSamePlace) {
  const test::StageUnderTest stage;
  const DiscoveryProblem problem = stage.Pose(
      stage.Measure({"stribeck_friction@load:coulomb=12,breakaway=8,velocity=0.01"}));
  const auto candidates = ListCandidates(stage.machine);
  const FittedModel start = {{{Place(candidates, "stribeck_friction@load"),
                               Eigen::Vector3d(11.0, 7.0, 0.012)}}};
  const CauseFit full =
      FitCauses(problem, candidates, start, {30, 1e-10, true, nullptr, false});
  const CauseFit secant =
      FitCauses(problem, candidates, start, {60, 1e-10, false, nullptr, true});
  const Eigen::VectorXd sd =
      ParameterCovariance(problem, candidates, full).diagonal().cwiseSqrt();
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_NEAR(secant.causes[0].value[i], full.causes[0].value[i], 0.1 * 1.96 * sd[i])
        << i;
  }
}

TEST(CauseFit, StaysWithinItsBounds) {
  const test::StageUnderTest stage;
  // Less damping than the plant has; more cannot be taken away.
  const DiscoveryProblem problem = stage.Pose(stage.Measure({}, {{"zeta", 0.0}}));
  const auto candidates = ListCandidates(stage.machine);
  const std::size_t place = Place(candidates, "coulomb_friction@load");
  const CauseFit fit = FitCauses(problem, candidates,
                                 {{{place, Eigen::VectorXd::Constant(1, 5.0)}}}, {});
  EXPECT_GE(fit.causes[0].value[0], 0.0);
}

// The damper of the plant is in doubt by a factor of two, and acts as both sides of the
// law together do.
TEST(CauseFit, ALawThatStandsForANumberOfThePlantHasAllOfIt) {
  const test::StageUnderTest stage;
  const DiscoveryProblem problem = WithDoubts(
      stage.Pose(
          stage.Measure({"asymmetric_viscous_friction@load:positive=30,negative=-20"})),
      {FindPlantNumber(stage.machine.plant(), "mass@load"),
       FindPlantNumber(stage.machine.plant(), "gear@drive")});
  ASSERT_EQ(problem.numbers().size(), 2u);  // the damper, and how late inputs act
  const auto candidates = ListCandidates(stage.machine);
  const std::size_t place = Place(candidates, "asymmetric_viscous_friction@load");
  FittedModel start = {{{place, Eigen::Vector2d(1.0, 1.0)}}, Eigen::Vector2d(0.3, 0.0)};
  const CauseFit fit = FitCauses(problem, candidates, start, {});
  EXPECT_NEAR(fit.numbers[0], 0.0, 1e-6);
  const Eigen::MatrixXd covariance = ParameterCovariance(problem, candidates, fit);
  const Eigen::Vector2d truth(30.0, -20.0);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const double sd = std::sqrt(covariance(i + 2, i + 2));
    EXPECT_LT(sd, 3.0);
    EXPECT_NEAR(fit.causes[0].value[i], truth[i], 4.0 * sd);
  }
  // From a J of another set, in which the number is free, and back.
  FitOptions options;
  const Eigen::MatrixXd of_number = problem.NumberJacobian({}, {});
  options.initial_jacobian = &of_number;
  EXPECT_NEAR(FitCauses(problem, candidates, start, options).numbers[0], 0.0, 1e-6);
  const Eigen::MatrixXd of_none = 0.0 * of_number;
  options.initial_jacobian = &of_none;
  const CauseFit alone = FitCauses(problem, candidates, {}, options);
  // Alone the damper lies between what both sides ask for, which a damper that stood
  // still would not.
  const double damping =
      203.5 * std::exp(problem.numbers()[0].spread * alone.numbers[0]);
  EXPECT_GT(damping, 204.5);
  EXPECT_LT(damping, 203.5 + 30.0);
}

TEST(ParameterCovariance, OfWhatNothingIsToldTakesNothingFromTheOthers) {
  const test::StageUnderTest stage;
  const DiscoveryProblem problem =
      stage.Pose(stage.Measure({"coulomb_friction@load:force=12"}));
  const auto candidates = ListCandidates(stage.machine);
  const std::size_t place = Place(candidates, "stribeck_friction@load");
  // Without a breakaway part its velocity does nothing.
  const CauseFit fit =
      FitCauses(problem, candidates, {{{place, Eigen::Vector3d(12.0, 0.0, 0.02)}}},
                {.iterations = 0});
  const Eigen::MatrixXd covariance = ParameterCovariance(problem, candidates, fit);
  EXPECT_TRUE(std::isinf(covariance(2, 2)));
  EXPECT_TRUE(std::isfinite(covariance(0, 0)));
  EXPECT_LT(std::sqrt(covariance(0, 0)), 1.0);
  EXPECT_EQ(covariance(0, 2), 0.0);
}

// A part of a law that is nothing at the start, as a law that becomes a simpler one
// there has, and more in truth.
TEST(CauseFit, MovesAwayFromNothing) {
  const test::StageUnderTest stage;
  const DiscoveryProblem problem = stage.Pose(
      stage.Measure({"stribeck_friction@load:coulomb=12,breakaway=8,velocity=0.01"}));
  auto candidates = ListCandidates(stage.machine);
  BoundByRecord(candidates, stage.machine, problem.MotionOf(problem.Nominal()));
  const std::size_t place = Place(candidates, "stribeck_friction@load");
  const CauseFit fit =
      FitCauses(problem, candidates, {{{place, Eigen::Vector3d(13.0, 0.0, 0.01)}}},
                {30, 1e-8, true, nullptr});
  EXPECT_NEAR(fit.causes[0].value[1], 8.0, 0.1);
  EXPECT_NEAR(fit.train, 1.0, 0.1);
}

}  // namespace
}  // namespace mjdiag
