#include "mjdiag/diagnosis/residuals/published_relation.h"

#include <gtest/gtest.h>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::MatrixXd;

/// 2 q'' + 3 q' + 50 q = u, y = q: the residual is -(2 s^2 + 3 s + 50) y + u, scaled.
MechanicalModel Oscillator() {
  const auto scalar = [](double value) { return MatrixXd::Constant(1, 1, value); };
  return {{"q"},       {"u"},        {"y"},       scalar(2.0),
          scalar(3.0), scalar(50.0), scalar(1.0), scalar(1.0)};
}

PublishedRelation Printed() {
  PublishedRelation relation;
  relation.degree = 2;
  relation.digits = 3;
  relation.pins = {{"y", 0, -50.0}};
  relation.polynomials = {{"y", {-50.0, -3.01, -2.0}}, {"u", {1.004, 0.0}}};
  return relation;
}

TEST(PublishedRelation, ComparesInHalvesOfTheLastPrintedDigit) {
  const PublishedRelationComparison comparison =
      ComparePublishedRelation(Oscillator(), Printed());
  ASSERT_EQ(comparison.coefficients.size(), 3u);  // not the pin, not the zero
  EXPECT_EQ(comparison.coefficients[0].channel, "y");
  EXPECT_EQ(comparison.coefficients[0].power, 1);
  EXPECT_NEAR(comparison.coefficients[0].computed, -3.0, 1e-12);
  EXPECT_NEAR(comparison.coefficients[0].half_ulps, 2.0, 1e-9);  // 0.01 of 0.005
  EXPECT_NEAR(comparison.coefficients[1].half_ulps, 0.0, 1e-9);
  EXPECT_NEAR(comparison.coefficients[2].half_ulps, 0.8, 1e-9);  // 0.004 of 0.005
  EXPECT_DOUBLE_EQ(comparison.worst_half_ulp, comparison.coefficients[0].half_ulps);
}

TEST(PublishedRelation, RefusesChannelsThatTheModelLacks) {
  PublishedRelation relation = Printed();
  relation.polynomials[1].channel = "v";
  EXPECT_THROW(ComparePublishedRelation(Oscillator(), relation), InputError);
  relation = Printed();
  relation.pins[0].channel = "u";
  EXPECT_THROW(ComparePublishedRelation(Oscillator(), relation), InputError);
}

}  // namespace
}  // namespace mjdiag
