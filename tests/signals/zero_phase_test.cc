#include "mjdiag/signals/zero_phase.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mjdiag/signals/butterworth.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kSampleTime = 1e-3;

const SecondOrderSections& LowPass() {
  static const auto sections =
      DigitalButterworth(FilterKind::kLowPass, 4, 100.0, kSampleTime);
  return sections;
}

TEST(FilterZeroPhase, KeepsAConstantUpToItsEnds) {
  const VectorXd constant = VectorXd::Constant(200, 7.0);
  EXPECT_LT((FilterZeroPhase(LowPass(), constant) - constant).cwiseAbs().maxCoeff(),
            1e-12);
}

TEST(FilterZeroPhase, KeepsAStraightLineAwayFromItsEnds) {
  const VectorXd line = VectorXd::LinSpaced(600, -1.0, 3.0);
  const VectorXd change = FilterZeroPhase(LowPass(), line) - line;
  EXPECT_LT(change.segment(200, 200).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(FilterZeroPhase, HasTheSquaredGainAndNoDelay) {
  constexpr double kFrequency = 80.0;
  const auto sine = [](Index k) {
    return std::sin(2.0 * std::numbers::pi * kFrequency * kSampleTime *
                    static_cast<double>(k));
  };
  const VectorXd signal = VectorXd::NullaryExpr(1000, sine);
  const double gain = std::norm(FrequencyResponse(LowPass(), kFrequency, kSampleTime));
  const VectorXd filtered = FilterZeroPhase(LowPass(), signal);
  // Ends carry a transient, which decays below 1e-9 within 200 samples (pole radius
  // 0.80).
  for (Index k = 200; k < 800; ++k) EXPECT_NEAR(filtered[k], gain * signal[k], 1e-9);
}

TEST(FilterZeroPhase, IsTheSameBackwardsInTime) {
  VectorXd signal = VectorXd::LinSpaced(300, 0.0, 1.0);
  signal[150] += 1.0;
  const VectorXd there = FilterZeroPhase(LowPass(), signal);
  const VectorXd back = FilterZeroPhase(LowPass(), signal.reverse());
  // The passes do not commute at the ends, where the transients differ.
  EXPECT_LT((there - back.reverse()).segment(50, 200).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(FilterZeroPhase, RefusesASignalShorterThanItsPadding) {
  EXPECT_THROW(FilterZeroPhase(LowPass(), VectorXd::Zero(12)), InputError);
  EXPECT_NO_THROW(FilterZeroPhase(LowPass(), VectorXd::Zero(13)));
}

}  // namespace
}  // namespace mjdiag
