#include "mjdiag/signals/second_order_sections.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace mjdiag {
namespace {

const SecondOrderSections kSections{{0.2, 0.3, 0.1, -0.5, 0.3},
                                    {0.7, 0.1, 0.0, -0.4, 0.0}};

TEST(SectionFilter, ImpulseResponseTransformsToTheFrequencyResponse) {
  constexpr double kSampleTime = 1e-3;
  constexpr double kFrequency = 137.0;
  SectionFilter filter(kSections);
  std::complex<double> transform = 0.0;
  // The slowest pole has radius 0.55: nothing is left after 200 samples.
  for (int k = 0; k < 200; ++k) {
    transform +=
        filter.Update(k == 0 ? 1.0 : 0.0) *
        std::polar(1.0, -2.0 * std::numbers::pi * kFrequency * kSampleTime * k);
  }
  const auto expected = FrequencyResponse(kSections, kFrequency, kSampleTime);
  EXPECT_NEAR(std::abs(transform - expected), 0.0, 1e-14);
}

TEST(SectionFilter, GoesOnWithoutATransientFromItsSteadyState) {
  SectionFilter filter(kSections);
  filter.Update(-3.0);
  filter.Settle(2.5);
  const double gain = FrequencyResponse(kSections, 0.0, 1.0).real();
  for (int k = 0; k < 20; ++k) EXPECT_NEAR(filter.Update(2.5), 2.5 * gain, 1e-14);
}

TEST(SectionFilter, ForgetsOnReset) {
  SectionFilter filter(kSections);
  const double first = filter.Update(1.0);
  filter.Update(5.0);
  filter.Reset();
  EXPECT_EQ(filter.Update(1.0), first);
}

}  // namespace
}  // namespace mjdiag
