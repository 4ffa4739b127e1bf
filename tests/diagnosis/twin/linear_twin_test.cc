#include "mjdiag/diagnosis/twin/linear_twin.h"

#include <gtest/gtest.h>

#include "diagnosis/twin/uncertain_stage.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Longer runs round more: the stage slides away on a spring of 5e6 N/m.
constexpr Index kTicks = 800;

/// The predicted readings, stacked, for that theta.
VectorXd Predicted(LinearTwin& twin, const VectorXd& theta, bool at_rest,
                   MatrixXd* sensitivities = nullptr) {
  const MatrixXd inputs = test::Drive(kTicks);
  VectorXd readings(2 * kTicks);
  if (sensitivities != nullptr) sensitivities->resize(2 * kTicks, theta.size());
  VectorXd reading(2);
  const VectorXd none = VectorXd::Zero(2);
  if (at_rest) {
    twin.Start(theta);
  } else {
    twin.Start(theta, twin.MakeState(), 0);
  }
  for (Index k = 0; k < kTicks; ++k) {
    twin.Predict(reading);
    readings.segment(2 * k, 2) = reading;
    twin.Step({inputs.col(k).data(), 2}, none);
    if ((k + 1) % test::kBlock != 0) continue;
    const MatrixXd& of_block = twin.EndBlock();
    if (sensitivities == nullptr) continue;
    sensitivities->middleRows(2 * (k + 1 - test::kBlock), 2 * test::kBlock) = of_block;
  }
  return readings;
}

LinearTwin Twin() {
  return {test::UncertainStage(),
          {{MatrixXd::Zero(6, 2), MatrixXd::Identity(2, 2), 0}},
          test::kBlock};
}

TEST(LinearTwin, PredictsTheReadingsOfTheMachineThatItsUnknownsSay) {
  LinearTwin twin = Twin();
  VectorXd theta = VectorXd::Zero(twin.unknowns());
  theta[1] = std::log(1.3);
  const MatrixXd inputs = test::Drive(kTicks);
  MatrixXd expected = SimulateLti(TickModel(test::Stage({1.0, 1.3, 1.0}),
                                            test::kTiming.step, test::kTiming.substeps),
                                  inputs);
  expected.colwise() += test::UncertainStage().rest;
  VectorXd reading(2);
  const VectorXd none = VectorXd::Zero(2);
  twin.Start(theta);
  for (Index k = 0; k < kTicks; ++k) {
    twin.Predict(reading);
    ASSERT_LT((reading - expected.col(k)).norm(), 1e-13) << k;
    twin.Step({inputs.col(k).data(), 2}, none);
    if ((k + 1) % test::kBlock == 0) twin.EndBlock();
  }
}

TEST(LinearTwin, KnowsHowItsPredictionsChangeWithEveryUnknown) {
  LinearTwin twin = Twin();
  VectorXd theta = VectorXd::Zero(twin.unknowns());
  theta.head(test::kOfTheMachine) << 0.2, -0.1, 0.05, 0.01, -0.02;
  MatrixXd sensitivities;
  Predicted(twin, theta, false, &sensitivities);
  for (Index i = 0; i < theta.size(); ++i) {
    // In tones and start the predictions are linear, so that large steps round less.
    const double size = i < 3 ? 1e-5 : 1e-3;
    const VectorXd step = size * VectorXd::Unit(theta.size(), i);
    const VectorXd difference =
        (Predicted(twin, theta + step, false) - Predicted(twin, theta - step, false)) /
        (2.0 * size);
    EXPECT_LT((sensitivities.col(i) - difference).norm(), 1e-7 * difference.norm())
        << test::UncertainStage().unknowns[static_cast<std::size_t>(i)].name;
  }
}

TEST(LinearTwin, GoesOnFromAStateOfItsRunAboutAnyTheta) {
  LinearTwin twin = Twin();
  const MatrixXd inputs = test::Drive(kTicks);
  const VectorXd none = VectorXd::Zero(2);
  constexpr Index kFrom = kTicks / 2;
  VectorXd theta = VectorXd::Zero(twin.unknowns());
  theta.head(test::kOfTheMachine) << 0.2, -0.1, 0.05, 0.01, -0.02;
  VectorXd change = VectorXd::Zero(twin.unknowns());
  change.head(test::kOfTheMachine) << 1e-5, -1e-5, 1e-5, 1e-5, 1e-5;
  TwinState state = twin.MakeState();
  const auto go_on = [&](Index from) {
    MatrixXd readings(2, kTicks - kFrom);
    VectorXd reading(2);
    for (Index k = from; k < kTicks; ++k) {
      if (k == kFrom && from == 0) twin.ReadState(state);
      twin.Predict(reading);
      if (k >= kFrom) readings.col(k - kFrom) = reading;
      twin.Step({inputs.col(k).data(), 2}, none);
      if ((k + 1) % test::kBlock == 0) twin.EndBlock();
    }
    return readings;
  };
  twin.Start(theta + change);
  const MatrixXd elsewhere = go_on(0);
  twin.Start(theta);
  const MatrixXd whole = go_on(0);
  // The tones of theta, too, go on from where they were.
  twin.Start(theta, state, kFrom);
  EXPECT_LT((go_on(kFrom) - whole).norm(), 1e-12 * whole.norm());
  twin.Start(theta + change, state, kFrom);
  EXPECT_LT((go_on(kFrom) - elsewhere).norm(), 1e-3 * (elsewhere - whole).norm());
}

TEST(LinearTwin, GoesToWhereAShiftTakesItToFirstOrder) {
  LinearTwin twin = Twin();
  const MatrixXd inputs = test::Drive(kTicks);
  const VectorXd none = VectorXd::Zero(2);
  const VectorXd theta = VectorXd::Zero(twin.unknowns());
  VectorXd change = theta;
  change.head(3) << 1e-4, -1e-4, 1e-4;
  const auto reading_after = [&](bool shifted) {
    twin.Start(shifted ? theta : theta + change);
    for (Index k = 0; k < kTicks; ++k) {
      twin.Step({inputs.col(k).data(), 2}, none);
      if ((k + 1) % test::kBlock == 0) twin.EndBlock();
    }
    if (shifted) twin.Shift(change);
    VectorXd reading(2);
    twin.Predict(reading);
    return reading;
  };
  const VectorXd before = Predicted(twin, theta, true).tail(2);
  const VectorXd wanted = reading_after(false);
  EXPECT_LT((reading_after(true) - wanted).norm(), 1e-2 * (wanted - before).norm());
}

}  // namespace
}  // namespace mjdiag
