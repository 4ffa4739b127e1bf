#include "mjdiag/plugin/machine/input_course.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Largest difference from f at the middle of the steps, away from the ends.
template <typename Function>
double LargestError(Hold hold, const Function& f, int substeps) {
  VectorXd samples(200);
  for (Index k = 0; k < samples.size(); ++k) samples[k] = f(static_cast<double>(k));
  const InputCourse course(hold, samples, substeps);
  double largest = 0.0;
  for (Index k = 50; k < 150; ++k) {
    for (int i = 0; i < substeps; ++i) {
      const double at = static_cast<double>(k) + (i + 0.5) / substeps;
      largest = std::max(largest, std::abs(samples[k] + course.Above(k, i) - f(at)));
    }
  }
  return largest;
}

TEST(InputCourse, KeepsItsSampleWhereItIsHeld) {
  const InputCourse course(Hold::kZero, VectorXd::LinSpaced(5, 0.0, 1.0), 4);
  EXPECT_EQ(course.Above(2, 3), 0.0);
  EXPECT_EQ(InputCourse().Above(7, 1), 0.0);
}

TEST(InputCourse, MeetsAStraightLineExactly) {
  const auto line = [](double t) { return 3.0 - 0.25 * t; };
  EXPECT_LT(LargestError(Hold::kLinear, line, 4), 1e-12);
  EXPECT_LT(LargestError(Hold::kLinear, line, 1), 1e-12);
}

// Three samples a period, between which a straight line misses half of the amplitude.
TEST(InputCourse, MeetsASineBelowHalfTheSamplingRate) {
  const auto sine = [](double t) { return std::sin(2.0 * t + 0.3); };
  EXPECT_LT(LargestError(Hold::kBandLimited, sine, 5), 0.01);
  EXPECT_GT(LargestError(Hold::kLinear, sine, 5), 0.4);
}

TEST(InputCourse, StaysAConstantUpToTheEndsOfTheRecord) {
  for (const Hold hold : {Hold::kLinear, Hold::kBandLimited}) {
    const InputCourse course(hold, VectorXd::Constant(40, 7.0), 3);
    for (const Index k : {0, 1, 20, 39, 40}) {
      EXPECT_NEAR(course.Above(k, 2), 0.0, 1e-12) << k;
    }
  }
}

}  // namespace
}  // namespace mjdiag
