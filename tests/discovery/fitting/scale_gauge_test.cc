#include "mjdiag/discovery/fitting/scale_gauge.h"

#include <gtest/gtest.h>

#include <cmath>

#include "discovery/candidate_place.h"
#include "discovery/stage_under_test.h"
#include "mjdiag/discovery/fitting/cause_fit.h"
#include "mjdiag/discovery/hypotheses/candidate_bounds.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST(ForceExponent, CountsNewtonsAndKilograms) {
  EXPECT_EQ(ForceExponent("N"), 1);
  EXPECT_EQ(ForceExponent("N s/m"), 1);
  EXPECT_EQ(ForceExponent("N m s/rad"), 1);
  EXPECT_EQ(ForceExponent("kg"), 1);
  EXPECT_EQ(ForceExponent("1/N/m"), -1);
  EXPECT_EQ(ForceExponent("m/s"), 0);
  EXPECT_EQ(ForceExponent("1"), 0);
  EXPECT_EQ(ForceExponent("Nm"), 0);  // is no unit of ours
}

struct Doubted {
  test::StageUnderTest stage;
  Record measured = stage.Measure({"coulomb_friction@load:force=18"});
  DiscoveryProblem problem = WithDoubts(stage.Pose(measured), {});
  std::vector<Candidate> candidates = ListCandidates(stage.machine);
  std::vector<FittedCause> friction;

  Doubted() {
    BoundByRecord(candidates, stage.machine, problem.MotionOf(problem.Nominal()));
    friction = {{test::Place(candidates, "coulomb_friction@load"),
                 VectorXd::Constant(1, 18.0)}};
  }
  VectorXd Theta(const VectorXd& z) const {
    VectorXd theta(z.size() + 1);
    theta << z, friction[0].value;
    return theta;
  }
};

TEST(ScaleGauges, AreWhatNoRunTells) {
  const Doubted doubted;
  const auto numbers = static_cast<Index>(doubted.problem.numbers().size());
  const VectorXd z = VectorXd::Zero(numbers);
  const auto gauges =
      ScaleGauges(doubted.problem, doubted.candidates, doubted.friction);
  ASSERT_EQ(gauges.size(), 1u);
  // A quarter more of everything: the friction, too, and the inputs as late as before.
  const VectorXd moved = gauges[0].Moved(doubted.Theta(z), std::log(1.25));
  FittedModel larger{doubted.friction, moved.head(numbers)};
  larger.causes[0].value = moved.tail(1);
  EXPECT_NEAR(moved[numbers], 1.25 * 18.0, 1e-9);
  const auto residual = [&](const FittedModel& model) {
    return doubted.problem.Residual(
        ChangesOf(doubted.problem, doubted.candidates, model));
  };
  const VectorXd before = residual({doubted.friction, z});
  // Half the mass alone moves it by thousands of standard deviations of its noise.
  EXPECT_LT((residual(larger) - before).norm(), 1e-3 * before.norm());
}

// What a fault parameter or a mass of its own says is said as well by the number in doubt.
TEST(HandedOver, LeavesTheMachineAsItWas) {
  const Doubted doubted;
  const auto numbers = static_cast<Index>(doubted.problem.numbers().size());
  const auto residual = [&](const FittedModel& model) {
    return doubted.problem.Residual(
        ChangesOf(doubted.problem, doubted.candidates, model));
  };
  const std::vector<std::pair<std::string, double>> causes{
      {"eta", 0.9}, {"zeta", 1.2}, {"added_mass@load", 5.0}};
  for (const auto& [name, value] : causes) {
    FittedModel model{doubted.friction, VectorXd::Constant(numbers, 0.1)};
    model.numbers[numbers - 1] = 0.0;  // how late inputs are
    model.causes.push_back(
        {test::Place(doubted.candidates, name), VectorXd::Constant(1, value)});
    const VectorXd before = residual(model);
    const FittedModel without =
        HandedOver(doubted.problem, doubted.candidates, model, 1);
    EXPECT_EQ(without.causes.size(), 1u);
    const FittedModel dropped{doubted.friction, model.numbers};
    EXPECT_GT((residual(dropped) - before).norm(), 1.0) << name;
    EXPECT_LT((residual(without) - before).norm(), 1e-3) << name;
  }
}

TEST(ScaleGauges, AreNoneOfAKnownMass) {
  const Doubted doubted;
  std::vector<DoubtedNumber> numbers = doubted.problem.numbers();
  std::erase_if(numbers, [](const DoubtedNumber& number) {
    return !number.is_lateness && number.number.kind == PlantNumberKind::kMass;
  });
  const DiscoveryProblem problem = doubted.problem.Doubting(numbers);
  const VectorXd z = VectorXd::Zero(std::ssize(numbers));
  const auto gauges = ScaleGauges(problem, doubted.candidates, doubted.friction);
  const MatrixXd J = FitCauses(problem, doubted.candidates, {doubted.friction, z},
                               {.iterations = 0, .jacobian = true})
                         .jacobian;
  EXPECT_EQ(gauges.size(), 1u);
  EXPECT_TRUE(Untold(gauges, doubted.Theta(z), J).empty());
}

// From a machine of half as much again, which every run is as good with.
TEST(CauseFit, KeepsToWhatIsKnownWhereNoRunTells) {
  const Doubted doubted;
  const auto numbers = static_cast<Index>(doubted.problem.numbers().size());
  const auto gauges =
      ScaleGauges(doubted.problem, doubted.candidates, doubted.friction);
  ASSERT_EQ(gauges.size(), 1u);
  const VectorXd larger =
      gauges[0].Moved(doubted.Theta(VectorXd::Zero(numbers)), std::log(1.5));
  FittedModel start{doubted.friction, larger.head(numbers)};
  start.causes[0].value = larger.tail(1);
  const CauseFit fit = FitCauses(doubted.problem, doubted.candidates, start,
                                 {.iterations = 12, .first_order = true});
  // The mass is known to 5 %, and so is the motor.
  EXPECT_LT(fit.numbers.norm(), 0.5);
  EXPECT_NEAR(fit.causes[0].value[0], 18.0, 0.5);
  // Nor does the Jacobian tell it afterwards.
  VectorXd theta = doubted.Theta(fit.numbers);
  theta.tail(1) = fit.causes[0].value;
  EXPECT_LT((fit.jacobian * gauges[0].Along(theta)).norm(),
            1e-6 * fit.jacobian.col(0).norm());
}

}  // namespace
}  // namespace mjdiag
