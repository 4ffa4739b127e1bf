#include "mjdiag/discovery/sets/likelihood.h"

#include <gtest/gtest.h>

#include "discovery/stage_under_test.h"

namespace mjdiag {
namespace {

/// How likely the record is beside changes behind the observer that they deserve.
struct Weight {
  std::size_t rung = 0;
  double deviance = 0.0;
};
Weight WeightOf(const ObserverLadder& ladder, const Changes& changes) {
  Weight best{0, ladder.Deviance(0, ladder[0].Residual(changes))};
  for (std::size_t rung = 1; rung < ladder.size(); ++rung) {
    const double deviance = ladder.Deviance(rung, ladder[rung].Residual(changes));
    if (deviance < best.deviance) best = {rung, deviance};
  }
  return best;
}

class Likelihood : public ::testing::Test {
 protected:
  Weight Of(const std::vector<std::string>& effects) const {
    return WeightOf(ladder_, test::With(effects));
  }
  const test::StageUnderTest stage_;
  const ObserverLadder ladder_{stage_.Pose(
      stage_.Measure({"coulomb_friction@load:force=18",
                      "force_ripple@load:amplitude=1.5,period=0.02,phase=0.7"}))};
};

TEST_F(Likelihood, PutsNothingHalfTruthsAndTheTruthInThatOrder) {
  const Weight nothing = Of({});
  const Weight wrong = Of({"quadratic_drag@load:coefficient=100"});
  const Weight half = Of({"coulomb_friction@load:force=18"});
  const Weight truth = Of({"coulomb_friction@load:force=18",
                           "force_ripple@load:amplitude=1.5,period=0.02,phase=0.7"});
  EXPECT_LT(half.deviance, nothing.deviance - 1000.0);
  EXPECT_LT(half.deviance, wrong.deviance - 1000.0);
  EXPECT_LT(truth.deviance, half.deviance - 1000.0);
}

TEST_F(Likelihood, LetsTheObserverBecomeSlowAsTheModelBecomesRight) {
  const Weight nothing = Of({});
  const Weight truth = Of({"coulomb_friction@load:force=18",
                           "force_ripple@load:amplitude=1.5,period=0.02,phase=0.7"});
  EXPECT_EQ(nothing.rung, 0u);
  EXPECT_EQ(truth.rung, ladder_.size() - 1);
}

// Sum of squares of n values of noise: n +- sqrt(2 n), and what is slower than the observer
// is taken away. Seed 1; 5 standard deviations.
TEST_F(Likelihood, OfTheTruthIsThatOfNoise) {
  const Weight truth = Of({"coulomb_friction@load:force=18",
                           "force_ripple@load:amplitude=1.5,period=0.02,phase=0.7"});
  const DiscoveryProblem& slowest = ladder_[ladder_.size() - 1];
  const auto values = static_cast<double>(slowest.train() - slowest.skip());
  EXPECT_NEAR(truth.deviance, ladder_.Noise(),
              0.02 * values + 5.0 * std::sqrt(2.0 * values));
}

TEST_F(Likelihood, TurnsDownAForceThatIsNotThere) {
  const Weight truth = Of({"coulomb_friction@load:force=18",
                           "force_ripple@load:amplitude=1.5,period=0.02,phase=0.7"});
  const Weight more = Of({"coulomb_friction@load:force=18",
                          "force_ripple@load:amplitude=1.5,period=0.02,phase=0.7",
                          "floor_vibration@load:amplitude=0.05,frequency=3,phase=0"});
  EXPECT_GT(more.deviance, truth.deviance + 12.0);
}

}  // namespace
}  // namespace mjdiag
