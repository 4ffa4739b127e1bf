#include "mjdiag/report/filter_plots.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mjdiag/signals/butterworth.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTick = 1.0 / 8000.0;

/// Two readings and one command under filters of order 2.
DiagnosisDesign SmallDesign() {
  DiagnosisDesign design;
  design.outputs = {"x", "y"};
  design.inputs = {"u"};
  design.sensor_noise = Eigen::Vector2d(1e-3, 2e-3);
  const Numerators numerators = {(MatrixXd(1, 3) << 1.0, 2.0, 3.0).finished()};
  design.bank.residuals = 1;
  design.bank.filters = MakeFilterBank(numerators, {2, 50.0}, kTick);
  design.disturbance.filter = MakeFilterBank(numerators, {2, 500.0}, kTick);
  design.disturbance.high_pass =
      DigitalButterworth(FilterKind::kHighPass, 3, 100.0, kTick);
  design.disturbances = {{"hum", {100.0, 300.0}, VectorXd::Ones(1)}};
  return design;
}

double At(const BodePlot& plot, std::size_t curve, Index k) {
  return plot.curves.at(curve).magnitude[k];
}

TEST(LowPassPlot, FallsToHalfPowerAtTheCutOff) {
  const BodePlot plot = LowPassPlot(SmallDesign());
  EXPECT_NEAR(At(plot, 0, 0), 1.0, 1e-4);
  ASSERT_EQ(plot.marks.size(), 2u);
  // Poles moved by z = exp(s T) shift it by about (pi f T)^2, 2 % of 500 Hz.
  EXPECT_NEAR(plot.marks[0].value, 50.0, 0.1);
  EXPECT_NEAR(plot.marks[1].value, 500.0, 20.0);
}

TEST(HalfPower, LiesBetweenTheFrequencies) {
  // 1 / sqrt(1 + f^2) on a coarse grid: the line in the logarithms misses by less than
  // the square of its step.
  const VectorXd frequency = VectorXd::LinSpaced(40, 0.1, 4.0);
  const VectorXd magnitude = (1.0 + frequency.array().square()).rsqrt();
  EXPECT_NEAR(HalfPower(frequency, magnitude), 1.0, 0.01);
  EXPECT_EQ(HalfPower(frequency, VectorXd::Ones(40)), 4.0);
}

TEST(HighPassPlot, ShowsTheHighPassAloneAndWithItsLowPass) {
  const DiagnosisDesign design = SmallDesign();
  const BodePlot plot = HighPassPlot(design);
  const VectorXd low = LowPassMagnitude(design.disturbance.filter, plot.frequency);
  for (Index k = 0; k < plot.frequency.size(); k += 50) {
    EXPECT_NEAR(At(plot, 1, k), At(plot, 0, k) * low[k], 1e-15);
  }
  EXPECT_NEAR(At(plot, 0, plot.frequency.size() - 1), 1.0, 1e-6);
  EXPECT_LT(At(plot, 0, 0), 2e-6);
}

TEST(ResponsePlots, TakeReadingsInTheirNoiseAndCommandsAsTheyAre) {
  DiagnosisDesign design = SmallDesign();
  const BodePlot readings = ReadingResponsePlot(design);
  const BodePlot commands = CommandResponsePlot(design);
  ASSERT_EQ(readings.curves.size(), 2u);
  ASSERT_EQ(commands.curves.size(), 1u);
  EXPECT_EQ(readings.curves[1].label, "y");
  EXPECT_EQ(commands.curves[0].label, "u");
  // The numerators are 1, 2 and 3.
  EXPECT_NEAR(At(readings, 1, 7) / At(readings, 0, 7), 2.0 * 2.0, 1e-12);
  EXPECT_NEAR(At(commands, 0, 7) / At(readings, 0, 7), 3.0 / 1e-3, 1e-9);
  design.sensor_noise.setZero();
  EXPECT_NEAR(At(ReadingResponsePlot(design), 1, 7) / At(commands, 0, 7), 2.0 / 3.0,
              1e-12);
}

TEST(DisturbanceResponsePlot, IsSeenThroughTheHighPassWithItsTonesMarked) {
  const DiagnosisDesign design = SmallDesign();
  const BodePlot plot = DisturbanceResponsePlot(design);
  const VectorXd high = HighPassPlot(design).curves[0].magnitude;
  const double without =
      std::abs(FrequencyResponse(design.disturbance.filter, plot.frequency[200])(0, 2));
  EXPECT_NEAR(At(plot, 0, 200), high[200] * without, 1e-12 * without);
  ASSERT_EQ(plot.marks.size(), 2u);
  EXPECT_EQ(plot.marks[1].value, 300.0);
  EXPECT_EQ(plot.marks[1].label, "tones of hum");
}

TEST(ChangePlot, IsTheDifferenceOfTheResponsesInUnitsOfTheNoise) {
  // A mass of 2 kg on a spring of 2e4 N/m, damped, that loses half of its stiffness.
  MechanicalModel healthy;
  healthy.M = MatrixXd::Constant(1, 1, 2.0);
  healthy.D = MatrixXd::Constant(1, 1, 5.0);
  healthy.K = MatrixXd::Constant(1, 1, 2e4);
  healthy.Gamma = MatrixXd::Ones(1, 1);
  healthy.b = MatrixXd::Ones(1, 1);
  MechanicalModel worn = healthy;
  worn.K *= 0.5;
  DiagnosisDesign design = SmallDesign();
  design.sensor_noise = VectorXd::Constant(1, 1e-6);
  const BodePlot plot =
      ChangePlot(design, healthy, {{"half", worn}, {"none", healthy}});
  const auto response = [](double stiffness, double f) {
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * f);
    return 1.0 / (stiffness + 5.0 * s + 2.0 * s * s);
  };
  for (Index k = 0; k < plot.frequency.size(); k += 40) {
    const double f = plot.frequency[k];
    const double change = std::abs(response(1e4, f) - response(2e4, f)) / 1e-6;
    EXPECT_NEAR(At(plot, 0, k) / change, 1.0, 1e-9);
    EXPECT_EQ(At(plot, 1, k), 0.0);
  }
}

}  // namespace
}  // namespace mjdiag
