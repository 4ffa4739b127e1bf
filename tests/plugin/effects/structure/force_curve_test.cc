// Forces without a name: curves over what predicts them.

#include "mjdiag/plugin/effects/structure/force_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "mjdiag/signals/error.h"
#include "plugin/effects/effect_bench.h"

namespace mjdiag {
namespace {

using test::EffectBench;

double CurveAt(const CurveAxis& axis, double x, double (*value)(double), double low,
               double step) {
  const CurveAxis::Weights weights = axis.At(x);
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.place.size(); ++i) {
    sum += weights.weight[i] * value(low + step * weights.place[i]);
  }
  return sum;
}

TEST(ForceCurve, GoesThroughItsKnotsAndIsALineWhereTheyAreOnOne) {
  const CurveAxis axis{-1.0, 2.0, CurveShapes::kPlain, 7};
  const auto line = [](double x) { return 3.0 - 2.0 * x; };
  const auto cube = [](double x) { return x * x * x; };
  for (double x = -1.0; x <= 2.0; x += 0.01) {
    EXPECT_NEAR(CurveAt(axis, x, line, -1.0, 0.5), line(x), 1e-12);
  }
  for (double x = -1.0; x <= 2.0; x += 0.5) {
    EXPECT_NEAR(CurveAt(axis, x, cube, -1.0, 0.5), cube(x), 1e-12);
  }
  EXPECT_NEAR(CurveAt(axis, 5.0, cube, -1.0, 0.5), cube(2.0), 1e-12);
  EXPECT_NEAR(CurveAt(axis, -5.0, cube, -1.0, 0.5), cube(-1.0), 1e-12);
}

TEST(ForceCurve, IsAParabolaUpToItsEndsWhereItsKnotsAreOnOne) {
  const auto parabola = [](double x) { return 3.0 - 2.0 * x + 5.0 * x * x; };
  for (const int knots : {4, 7}) {
    const CurveAxis axis{-1.0, 2.0, CurveShapes::kPlain, knots};
    for (double x = -1.0; x <= 2.0; x += 0.01) {
      EXPECT_NEAR(CurveAt(axis, x, parabola, -1.0, 3.0 / (knots - 1)), parabola(x),
                  1e-12);
    }
  }
}

TEST(ForceCurve, IsALineThroughTwoKnotsOfASplitOne) {
  const CurveAxis axis{-1.0, 2.0, CurveShapes::kSplit, 4, 1e-6};
  const CurveAxis::Weights weights = axis.At(0.5);
  double of_zero = 0.0;
  double of_end = 0.0;
  for (std::size_t i = 0; i < weights.place.size(); ++i) {
    if (weights.place[i] == 2) of_zero += weights.weight[i];
    if (weights.place[i] == 3) of_end += weights.weight[i];
  }
  EXPECT_NEAR(of_zero, 0.75, 1e-12);
  EXPECT_NEAR(of_end, 0.25, 1e-12);
}

// The error of a cubic through samples of a sine, a sixteenth of a turn apart, is below
// (pi / 8)^3 / 6 = 1 %.
TEST(ForceCurve, ComesBackAfterItsPeriod) {
  const CurveAxis axis{0.0, 1.0, CurveShapes::kPeriodic, 16};
  const auto wave = [](double x) { return std::sin(2.0 * std::numbers::pi * x); };
  for (double x = -2.0; x <= 2.0; x += 0.013) {
    EXPECT_NEAR(CurveAt(axis, x, wave, 0.0, 1.0 / 16.0), wave(x), 0.01);
  }
}

TEST(ForceCurve, StepsWhereItIsSplit) {
  const CurveAxis axis{-1.0, 2.0, CurveShapes::kSplit, 8, 1e-6};
  for (const double x : {-0.7, -0.01, 0.01, 1.3}) {
    const CurveAxis::Weights weights = axis.At(x);
    double below = 0.0;
    double above = 0.0;
    for (std::size_t i = 0; i < weights.place.size(); ++i) {
      (weights.place[i] < 4 ? below : above) += weights.weight[i];
    }
    EXPECT_NEAR(below, x < 0.0 ? 1.0 : 0.0, 1e-12);
    EXPECT_NEAR(above, x < 0.0 ? 0.0 : 1.0, 1e-12);
  }
}

TEST(ForceCurve, PushesByWhatItIsOverTimesItsFactor) {
  // Over the position: 1 N at 0.2 m, along a line from -1 to 1.
  const std::string knots = "force_1=-5,force_2=-2.5,force_3=0,force_4=2.5,force_5=5";
  EffectBench over_position(
      {"force_curve@q:variable=0,low=-1,width=2,knots=5," + knots});
  EXPECT_NEAR(over_position.ForceAt(0.2, 7.0), 1.0, 1e-12);
  EffectBench over_velocity(
      {"force_curve@q:variable=1,low=-1,width=2,knots=5," + knots});
  EXPECT_NEAR(over_velocity.ForceAt(7.0, -0.2), -1.0, 1e-12);
  EffectBench with_direction(
      {"force_curve@q:variable=0,factor=1,low=-1,width=2,knots=5," + knots});
  EXPECT_NEAR(with_direction.ForceAt(0.2, -3.0), -1.0, 1e-12);
  EffectBench with_velocity(
      {"force_curve@q:variable=0,factor=2,low=-1,width=2,knots=5," + knots});
  EXPECT_NEAR(with_velocity.ForceAt(0.2, -3.0), -3.0, 1e-12);
}

TEST(ForceCurve, SaysWhatIsWrongWithItsRange) {
  EXPECT_THROW(EffectBench({"force_curve@q:variable=0,low=1,width=0,knots=5,force_1=0,"
                            "force_2=0,force_3=0,force_4=0"}),
               InputError);
  EXPECT_THROW(EffectBench({"force_curve@q:variable=1,low=0.1,width=1,shape=2,knots=6,"
                            "force_1=0,force_2=0,force_3=0,force_4=0"}),
               InputError);
  EXPECT_THROW(EffectBench({"force_curve@q:variable=1,of=7,low=-1,width=2,knots=5,"
                            "force_1=0,force_2=0,force_3=0,force_4=0"}),
               InputError);
}

}  // namespace
}  // namespace mjdiag
