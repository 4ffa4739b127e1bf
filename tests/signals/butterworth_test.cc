#include "mjdiag/signals/butterworth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

/// Expects the coefficient to round to the printed one of four significant digits.
void ExpectPrinted(double value, double printed) {
  const double unit = std::pow(10.0, std::floor(std::log10(printed)) - 3.0);
  EXPECT_NEAR(value, printed, 0.5 * unit * (1.0 + 1e-9));
}

void ExpectPrinted(const Eigen::VectorXd& values, const std::vector<double>& printed) {
  ASSERT_EQ(values.size(), static_cast<Eigen::Index>(printed.size()));
  for (std::size_t k = 0; k < printed.size(); ++k) {
    SCOPED_TRACE(k);
    ExpectPrinted(values[static_cast<Eigen::Index>(k)], printed[k]);
  }
}

TEST(ContinuousButterworth, IsEquation31OfTheSeed) {
  const auto filter = ContinuousButterworth(FilterKind::kLowPass, 7, 50.0);
  ExpectPrinted(filter.denominator,
                {1.0, 1412.0, 9.966e5, 4.524e8, 1.421e11, 3.09e13, 4.32e15, 3.02e17});
  ExpectPrinted(filter.numerator[7], 3.02e17);
  EXPECT_EQ(filter.numerator.head(7).cwiseAbs().maxCoeff(), 0.0);
}

TEST(ContinuousButterworth, IsTheDenominatorOfEquation33OfTheSeed) {
  ExpectPrinted(
      ContinuousButterworth(FilterKind::kLowPass, 7, 750.0).denominator,
      {1.0, 2.118e4, 2.242e8, 1.527e12, 7.196e15, 2.347e19, 4.921e22, 5.16e25});
}

TEST(ContinuousButterworth, IsEquation34OfTheSeed) {
  const auto filter = ContinuousButterworth(FilterKind::kHighPass, 3, 100.0);
  ExpectPrinted(filter.denominator, {1.0, 1257.0, 7.896e5, 2.481e8});
  EXPECT_EQ(filter.numerator, Eigen::Vector4d(1.0, 0.0, 0.0, 0.0));
}

TEST(DigitalButterworth, HasHalfPowerAtCutoff) {
  constexpr double kSampleTime = 1.0 / 8000.0;
  for (const FilterKind kind : {FilterKind::kLowPass, FilterKind::kHighPass}) {
    for (int order = 1; order <= 20; ++order) {
      const auto sections = DigitalButterworth(kind, order, 750.0, kSampleTime);
      EXPECT_NEAR(std::norm(FrequencyResponse(sections, 750.0, kSampleTime)), 0.5,
                  1e-12)
          << "order " << order;
    }
  }
}

TEST(DigitalButterworth, FallsAsItsOrderSaysOnTheWarpedAxis) {
  constexpr double kSampleTime = 1e-3;
  constexpr double kPi = 3.14159265358979323846;
  for (const double f : {20.0, 130.0, 400.0}) {
    const double ratio = std::tan(kPi * f * kSampleTime) / std::tan(kPi * 0.1);
    const auto low = DigitalButterworth(FilterKind::kLowPass, 5, 100.0, kSampleTime);
    const auto high = DigitalButterworth(FilterKind::kHighPass, 5, 100.0, kSampleTime);
    EXPECT_NEAR(std::norm(FrequencyResponse(low, f, kSampleTime)) *
                    (1.0 + std::pow(ratio, 10.0)),
                1.0, 1e-11);
    EXPECT_NEAR(std::norm(FrequencyResponse(high, f, kSampleTime)) *
                    (1.0 + std::pow(ratio, -10.0)),
                1.0, 1e-11);
  }
}

TEST(DigitalButterworth, RefusesValuesOutOfRange) {
  const auto design = [](int order, double cutoff, double sample_time) {
    DigitalButterworth(FilterKind::kLowPass, order, cutoff, sample_time);
  };
  EXPECT_THROW(design(0, 100.0, 1e-3), InputError);
  EXPECT_THROW(design(21, 100.0, 1e-3), InputError);
  EXPECT_THROW(design(4, 0.0, 1e-3), InputError);
  EXPECT_THROW(design(4, 500.0, 1e-3), InputError);
  EXPECT_THROW(design(4, 100.0, 0.0), InputError);
  EXPECT_THROW(design(4, NAN, 1e-3), InputError);
  EXPECT_NO_THROW(design(20, 499.0, 1e-3));
  EXPECT_THROW(ContinuousButterworth(FilterKind::kLowPass, 4, -1.0), InputError);
}

}  // namespace
}  // namespace mjdiag
