#include "mjdiag/plugin/replay/plant_twin.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/plugin/runtime/simulation.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kBlock = 8;

/// A tenth of a second of the nonlinear bonder with every axis in motion, and its twin.
class PlantTwinOfTheBonder : public testing::Test {
 protected:
  PlantTwinOfTheBonder() {
    Trajectory motion = machine_.setup().trajectories.Find("xyz");
    motion.duration = 0.1;
    RunOptions options;
    options.noise_scale = 0.0;
    const Record record =
        Simulate(machine_, FollowTrajectory(machine_.setup(), motion), options);
    outputs_ = SamplesOf(record, ChannelsOf(machine_.channels().sensors));
    inputs_ = SamplesOf(record, ChannelsOf(machine_.channels().actuators));
  }

  /// The predicted readings, stacked.
  VectorXd Predicted(const VectorXd& theta, MatrixXd* sensitivities = nullptr) {
    const Index ticks = inputs_.cols() / kBlock * kBlock;
    VectorXd readings(3 * ticks);
    if (sensitivities != nullptr) sensitivities->resize(3 * ticks, theta.size());
    VectorXd reading(3);
    const VectorXd none = VectorXd::Zero(3);
    twin_.Start(theta);
    for (Index k = 0; k < ticks; ++k) {
      twin_.Predict(reading);
      readings.segment(3 * k, 3) = reading;
      twin_.Step({inputs_.col(k).data(), 3}, none);
      if ((k + 1) % kBlock != 0) continue;
      const MatrixXd& of_block = twin_.EndBlock();
      if (sensitivities != nullptr) {
        sensitivities->middleRows(3 * (k + 1 - kBlock), 3 * kBlock) = of_block;
      }
    }
    return readings;
  }

  const Machine machine_ = test::Bonder();
  const UncertainMachine plant_ = MakeUncertainMachine(machine_, {});
  PlantTwin twin_{
      machine_, plant_, {{MatrixXd::Zero(20, 3), MatrixXd::Identity(3, 3), 0}}, kBlock};
  MatrixXd outputs_;
  MatrixXd inputs_;
};

TEST_F(PlantTwinOfTheBonder, HasTheFaultsTheFrictionAndTheTonesAsUnknowns) {
  std::vector<std::string> names;
  for (Index i = 0; i < twin_.unknowns() - twin_.start_unknowns(); ++i) {
    names.push_back(plant_.unknowns[static_cast<std::size_t>(i)].name);
  }
  EXPECT_THAT(names, testing::ElementsAre("zeta_x", "zeta_y", "beta_x", "beta_y",
                                          "eta_x", "eta_y", "eta_z", "friction@X",
                                          "friction@Y", "friction@Z", "gamma sine",
                                          "gamma cosine", "gamma sine", "gamma cosine",
                                          "gamma sine", "gamma cosine"));
}

TEST_F(PlantTwinOfTheBonder, PredictsWhatTheSameMachineReads) {
  const VectorXd predicted = Predicted(VectorXd::Zero(twin_.unknowns()));
  const VectorXd measured = outputs_.reshaped().head(predicted.size());
  EXPECT_LT((predicted - measured).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_F(PlantTwinOfTheBonder, GoesOnFromAStateOfItsRun) {
  const VectorXd none = VectorXd::Zero(3);
  const Index ticks = inputs_.cols() / kBlock * kBlock;
  const Index from = ticks / kBlock / 2 * kBlock;
  VectorXd theta = VectorXd::Zero(twin_.unknowns());
  for (Index i = 10; i < 16; ++i) theta[i] = 0.01;  // tones
  TwinState state = twin_.MakeState();
  VectorXd whole(3), reading(3);
  twin_.Start(theta);
  for (const Index first : {Index{0}, from}) {
    if (first > 0) twin_.Start(theta, state, from);
    for (Index k = first; k < ticks; ++k) {
      if (k == from && first == 0) twin_.ReadState(state);
      twin_.Predict(first == 0 ? whole : reading);
      twin_.Step({inputs_.col(k).data(), 3}, none);
      if ((k + 1) % kBlock == 0) twin_.EndBlock();
    }
  }
  EXPECT_LT((reading - whole).cwiseAbs().maxCoeff(), 1e-12);
}

// To the first order that the map of the machine at rest has, which moves by 4 mm, and
// of a friction that holds: 4 to 22 %, most for the stiffness of the y guide. An error of
// that size costs its square of the information, and no bias: innovations are exact.
TEST_F(PlantTwinOfTheBonder, KnowsHowItsPredictionsChangeWithEveryUnknown) {
  const VectorXd theta = VectorXd::Zero(twin_.unknowns());
  MatrixXd sensitivities;
  Predicted(theta, &sensitivities);
  for (Index i = 0; i < twin_.unknowns() - twin_.start_unknowns(); ++i) {
    constexpr double kStep = 1e-5;
    const VectorXd step = kStep * VectorXd::Unit(theta.size(), i);
    const VectorXd difference =
        (Predicted(theta + step) - Predicted(theta - step)) / (2.0 * kStep);
    EXPECT_LT((sensitivities.col(i) - difference).norm(), 0.3 * difference.norm())
        << plant_.unknowns[static_cast<std::size_t>(i)].name;
  }
}

}  // namespace
}  // namespace mjdiag
