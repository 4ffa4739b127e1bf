#include "mjdiag/discovery/residual_dependence/residual_dependence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mjdiag/signals/error.h"
#include "support/gaussian_noise.h"

namespace mjdiag {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::VectorXd;
using testing::HasSubstr;

constexpr Index kSamples = 10000;
constexpr double kTick = 2.5e-4;

/// Two axes on motions of several frequencies that have none in common.
struct Motion {
  ArrayXd time = ArrayXd::LinSpaced(kSamples, 0.0, (kSamples - 1) * kTick);
  ArrayXd x = Sum({1.3, 3.1, 7.7}, {0.02, 0.01, 0.003}, 0);
  ArrayXd v = Sum({1.3, 3.1, 7.7}, {0.02, 0.01, 0.003}, 1);
  ArrayXd a = Sum({1.3, 3.1, 7.7}, {0.02, 0.01, 0.003}, 2);
  ArrayXd y = Sum({0.9, 2.3, 5.9}, {0.03, 0.008, 0.004}, 0);

  ArrayXd Sum(std::vector<double> frequency, std::vector<double> amplitude,
              int derivative) const {
    ArrayXd sum = ArrayXd::Zero(kSamples);
    for (std::size_t i = 0; i < frequency.size(); ++i) {
      const double omega = 2.0 * std::numbers::pi * frequency[i];
      sum += amplitude[i] * std::pow(omega, derivative) *
             (omega * time + 0.5 * std::numbers::pi * derivative + 1.0).sin();
    }
    return sum;
  }

  std::vector<Variable> Variables() const {
    return {{"X position", "m", x},         {"X velocity", "m/s", v, true},
            {"X acceleration", "m/s^2", a}, {"X direction", "", v.sign(), true},
            {"Y position", "m", y},         {"time", "s", time}};
  }
};

/// The signature of a law of rms 1 with white noise of sd 0.3.
ResidualDependence Of(const ArrayXd& law) {
  const double rms = std::sqrt(law.square().mean());
  const VectorXd noise = GaussianNoise(kSamples, 0.3, 7);
  return FindResidualDependence("X", (law / rms).matrix() + noise, "N", 0.3,
                                Motion().Variables());
}

/// Of a signal with mean square 1 plus 0.3^2, 1 / 1.09 can be explained.
constexpr double kAll = 1.0 / 1.09;

TEST(ResidualDependence, NamesCoulombFriction) {
  const ResidualDependence s = Of(Motion().v.sign());
  EXPECT_EQ(s.variable, "X direction") << s.text;
  EXPECT_EQ(s.shape, "step at zero");
  EXPECT_NEAR(s.explained_share, kAll, 0.02);
}

TEST(ResidualDependence, NamesAnOddPowerOfTheVelocity) {
  const Motion m;
  const ResidualDependence s = Of(m.v.sign() * m.v.abs().pow(1.5));
  EXPECT_EQ(s.variable, "X velocity") << s.text;
  EXPECT_EQ(s.factor, "");
  EXPECT_THAT(s.shape, HasSubstr("odd, power")) << s.text;
  EXPECT_NEAR(s.exponent, 1.5, 0.13) << s.text;
  EXPECT_NEAR(s.explained_share, kAll, 0.02);
}

TEST(ResidualDependence, NamesDampingThatDependsOnThePosition) {
  const Motion m;
  const ResidualDependence s = Of((m.x * 2.0 * std::numbers::pi / 0.025).sin() * m.v);
  EXPECT_EQ(s.variable, "X position") << s.text;
  EXPECT_EQ(s.factor, "X velocity") << s.text;
  EXPECT_THAT(s.shape, HasSubstr("periodic")) << s.text;
  EXPECT_NEAR(s.period, 0.025, 0.001);
  EXPECT_GT(s.explained_share, 0.9 * kAll);
}

TEST(ResidualDependence, NamesFrictionThatDependsOnAnotherAxis) {
  const Motion m;
  const ResidualDependence s = Of((1.0 + 25.0 * m.y) * m.v.sign());
  EXPECT_EQ(s.variable, "Y position") << s.text;
  EXPECT_EQ(s.factor, "X direction") << s.text;
  EXPECT_EQ(s.shape, "linear") << s.text;
}

TEST(ResidualDependence, NamesABurstInTime) {
  const Motion m;
  const ResidualDependence s = Of((m.time > 1.0 && m.time < 1.25).cast<double>());
  EXPECT_EQ(s.variable, "time") << s.text;
  EXPECT_THAT(s.shape, HasSubstr("different between")) << s.text;
}

TEST(ResidualDependence, NamesTheFrequencyOfAVibration) {
  const Motion m;
  const ResidualDependence s = Of((m.time * 2.0 * std::numbers::pi * 143.7).sin());
  EXPECT_EQ(s.variable, "time") << s.text;
  EXPECT_NEAR(1.0 / s.period, 143.7, 0.1) << s.text;
  EXPECT_GT(s.explained_share, 0.95 * kAll);
}

TEST(ResidualDependence, NamesThePeriodOfARippleFinerThanTheBins) {
  const Motion m;
  const ResidualDependence s = Of((m.x * 2.0 * std::numbers::pi / 2e-4).sin());
  EXPECT_EQ(s.variable, "X position") << s.text;
  EXPECT_NEAR(s.period, 2e-4, 1e-6) << s.text;
}

TEST(ResidualDependence, NamesAnEndStop) {
  const Motion m;
  const ResidualDependence s = Of((m.x - 0.02).max(0.0));
  EXPECT_EQ(s.variable, "X position") << s.text;
  EXPECT_THAT(s.shape, HasSubstr("one-sided, rising above")) << s.text;
}

TEST(ResidualDependence, NamesAMissingMass) {
  const ResidualDependence s = Of(Motion().a);
  EXPECT_EQ(s.variable, "X acceleration") << s.text;
  EXPECT_EQ(s.shape, "linear") << s.text;
}

TEST(ResidualDependence, NamesAConstant) {
  const ResidualDependence s = Of(ArrayXd::Ones(kSamples));
  EXPECT_EQ(s.variable, "") << s.text;
  EXPECT_TRUE(s.significant);
  EXPECT_EQ(s.shape, "constant");
}

// Level 1 %, 100 draws: more than 5 false alarms have a chance of 5e-4.
TEST(ResidualDependence, RarelyNamesAnythingForNoise) {
  constexpr Index kShort = 4000;
  std::vector<Variable> variables = Motion().Variables();
  for (Variable& variable : variables) variable.value.conservativeResize(kShort);
  for (const double memory : {0.0, 0.9, 0.995}) {
    int alarms = 0;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
      const VectorXd noise = GaussianNoise(kShort, 1.0, 100 + seed, memory);
      alarms += FindResidualDependence("X", noise, "N", 1.0, variables).significant;
    }
    EXPECT_LE(alarms, 5) << "memory " << memory;
  }
}

// A sine takes three numbers, a curve over its period forty.
TEST(ResidualDependence, OfAWeakWaveInAFewSamplesHasACurveOrNone) {
  constexpr Index kFew = 400;
  const ArrayXd x = ArrayXd::LinSpaced(kFew, 0.0, 1.0);
  const ArrayXd wave = 0.45 * (2.0 * std::numbers::pi * 7.3 * x).sin();
  int waves = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const VectorXd noise = GaussianNoise(kFew, 1.0, seed);
    const ResidualDependence found = FindResidualDependence(
        "X", wave.matrix() + noise, "N", 1.0, {{"X position", "m", x}});
    EXPECT_EQ(found.x.size(), found.y_sd.size());
    waves += found.period > 0.0 ? 1 : 0;
  }
  EXPECT_GT(waves, 0);
}

TEST(ResidualDependence, RefusesSeriesThatDoNotFit) {
  const VectorXd signal = GaussianNoise(kSamples, 1.0, 1);
  const Variable brief{"x", "m", VectorXd::Zero(10)};
  EXPECT_THROW(FindResidualDependence("X", signal, "N", 1.0, {brief}), InputError);
  EXPECT_THROW(FindResidualDependence("X", signal, "N", 0.0, {}), InputError);
  EXPECT_THROW(FindResidualDependence("X", signal.head(10), "N", 1.0, {}), InputError);
}

}  // namespace
}  // namespace mjdiag
