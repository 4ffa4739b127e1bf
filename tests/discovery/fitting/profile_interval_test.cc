#include "mjdiag/discovery/fitting/profile_interval.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "discovery/candidate_place.h"
#include "discovery/stage_under_test.h"
#include "mjdiag/discovery/fitting/parameter_covariance.h"
#include "mjdiag/signals/decompositions.h"

namespace mjdiag {
namespace {

struct Fitted {
  DiscoveryProblem problem;
  std::vector<Candidate> candidates;
  CauseFit fit{};
  Eigen::MatrixXd covariance{};
  std::vector<Interval> intervals{};
};

/// Of one effect, from its true values.
Fitted FitOf(const test::StageUnderTest& stage, const std::string& effect,
             const std::string& site, const Eigen::VectorXd& start) {
  Fitted f{.problem = stage.Pose(stage.Measure({effect})),
           .candidates = ListCandidates(stage.machine)};
  const std::size_t place = test::Place(f.candidates, site);
  f.fit = FitCauses(f.problem, f.candidates, {{{place, start}}},
                    {.iterations = 30, .tolerance = 1e-10});
  f.covariance = ParameterCovariance(f.problem, f.candidates, f.fit);
  f.intervals = ParameterIntervals(f.problem, f.candidates, f.fit, f.covariance);
  return f;
}

TEST(ProfileInterval, IsTheNormalOneWhereTheLikelihoodIsQuadratic) {
  const test::StageUnderTest stage;
  const Fitted f = FitOf(stage, "quadratic_drag@load:coefficient=0.5",
                         "quadratic_drag@load", Eigen::VectorXd::Constant(1, 0.5));
  const double half = 1.959964 * std::sqrt(f.covariance(0, 0));
  EXPECT_NEAR(f.intervals[0].max - f.fit.causes[0].value[0], half, 0.05 * half);
  EXPECT_NEAR(f.fit.causes[0].value[0] - f.intervals[0].min, half, 0.05 * half);
}

// A weak Stribeck law: its velocity is known to a factor, and the interval is skew.
TEST(ProfileInterval, EndsWhereTheProfileOfTheLikelihoodCrosses) {
  const test::StageUnderTest stage;
  const Fitted f = FitOf(
      stage, "stribeck_friction@load:coulomb=0.0002,breakaway=0.0004,velocity=0.02",
      "stribeck_friction@load", Eigen::Vector3d(0.0002, 0.0004, 0.02));
  const DiscoveryProblem seen = f.problem.TrainPart();
  const Eigen::MatrixXd J =
      f.fit.jacobian.bottomRows(f.problem.train() - f.problem.skip());
  const Eigen::MatrixXd C = Inverse(J.transpose() * J);
  const auto n = static_cast<double>(f.problem.train() - f.problem.skip());
  for (const double end : {f.intervals[2].min, f.intervals[2].max}) {
    std::vector<FittedCause> causes = f.fit.causes;
    causes[0].value[2] = end;
    const CauseFit held =
        FitCauses(seen, f.candidates, {causes},
                  {.iterations = 30, .tolerance = 1e-10, .held = Eigen::Index{2}});
    const double colour = f.covariance(2, 2) / C(2, 2);
    EXPECT_NEAR(n * (held.train - f.fit.train), 3.841 * colour, 0.5 * colour) << end;
  }
  const double value = f.fit.causes[0].value[2];
  ASSERT_GT(std::sqrt(f.covariance(2, 2)), 0.05 * value);  // else none is followed
  const double up = f.intervals[2].max - value;
  const double down = value - f.intervals[2].min;
  EXPECT_GT(std::max(up, down), 1.1 * std::min(up, down));
}

}  // namespace
}  // namespace mjdiag
