#include "mjdiag/plugin/runtime/closed_loop.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mjdiag/controllers/realisation.h"
#include "mjdiag/signals/decompositions.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

StateSpace Tick(const Machine& machine) {
  const Rates& rates = machine.rates();
  return TickModel(machine.linear(), rates.step(), rates.substeps);
}

/// [Ad Bd; 0 I] = exp([A B; 0 0] T), of states that are balanced: rows of 1 and of K / M
/// stand beside each other.
StateSpace Held(const StateSpace& continuous, double sample_time) {
  constexpr int kSquarings = 20;
  constexpr int kTerms = 8;
  const Eigen::Index n = continuous.A.rows(), m = continuous.B.cols();
  const Eigen::VectorXd scales = BalancingScales(continuous.A);
  const auto to = scales.cwiseInverse().asDiagonal();
  Eigen::MatrixXd block = Eigen::MatrixXd::Zero(n + m, n + m);
  block.topLeftCorner(n, n) = to * continuous.A * scales.asDiagonal();
  block.topRightCorner(n, m) = to * continuous.B;
  block *= std::ldexp(sample_time, -kSquarings);
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(n + m, n + m);
  Eigen::MatrixXd power = one;
  for (int k = kTerms; k > 0; --k) power = one + block * power / k;
  for (int i = 0; i < kSquarings; ++i) power = power * power;
  return {scales.asDiagonal() * power.topLeftCorner(n, n) * to,
          scales.asDiagonal() * power.topRightCorner(n, m), continuous.C, continuous.D,
          sample_time};
}

class BonderLoop : public ::testing::Test {
 protected:
  const Machine bonder_ = test::Bonder();
  mjdiag::Setup setup_ = bonder_.setup();
};

// The figure that is known of this plant, 0.98754, is of its zero-order hold.
TEST_F(BonderLoop, HasTheKnownLargestEigenvalue) {
  const StateSpace hold =
      Held(ContinuousStateSpace(bonder_.linear()), setup_.rates.tick());
  EXPECT_NEAR(SpectralRadius(ClosedLoopMatrix(hold, setup_)), 0.98754, 5e-6);
}

TEST_F(BonderLoop, IsAsStableOnTheMapOfATick) {
  EXPECT_NEAR(SpectralRadius(ClosedLoopMatrix(Tick(bonder_), setup_)), 0.98758, 5e-6);
}

// As printed, the y controller cancels its integrator: only marginally stable.
TEST_F(BonderLoop, IsMarginalWithThePrintedCoefficients) {
  setup_.control.axes[1].feedback = {{66900.0, -131600.0, 64700.0},
                                     {1.0, -1.828, 0.8277}};
  EXPECT_NEAR(SpectralRadius(ClosedLoopMatrix(Tick(bonder_), setup_)), 1.0, 2e-3);
}

TEST(ClosedLoop, OfTheMotionStageIsStable) {
  const Machine stage(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/emps"));
  EXPECT_LT(SpectralRadius(ClosedLoopMatrix(Tick(stage), stage.setup())), 1.0);
}

// The realisation answers an impulse as the difference equation does.
TEST(Realisation, HasTheImpulseResponseOfTheCompensator) {
  const DiscreteCompensator compensator{{3.0, -1.0, 0.5}, {2.0, -1.2, 0.3}};
  const StateSpace system = Realise(compensator, 1e-3);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(2);
  double y1 = 0.0;
  double y2 = 0.0;
  for (int k = 0; k < 20; ++k) {
    const double u = k == 0 ? 1.0 : 0.0;
    const double b = k < 3 ? compensator.numerator[static_cast<std::size_t>(k)] : 0.0;
    const double expected = (b + 1.2 * y1 - 0.3 * y2) / 2.0;
    EXPECT_NEAR((system.C * x)(0) + system.D(0, 0) * u, expected, 1e-14) << k;
    x = system.A * x + system.B * u;
    y2 = y1;
    y1 = expected;
  }
}

}  // namespace
}  // namespace mjdiag
