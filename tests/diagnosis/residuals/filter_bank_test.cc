#include "mjdiag/diagnosis/residuals/filter_bank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "diagnosis/test_stage.h"
#include "mjdiag/diagnosis/model/delta_form.h"
#include "mjdiag/signals/error.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Complex = std::complex<double>;

constexpr double kSampleTime = 1.0 / 8000.0;

/// 2 x 3 numerators of which every power matters near the cut-off.
Numerators Sample(int degree, const Denominator& denominator) {
  const double corner =
      2.0 * std::numbers::pi * denominator.cutoff * kSampleTime / kDeltaScale;
  Numerators numerators;
  for (int k = 0; k <= degree; ++k) {
    numerators.push_back(test::WhiteNoise(2, 3, std::pow(corner, -k), 5 + k));
  }
  return numerators;
}

/// N(p) / d(p) at p = (exp(i w T) - 1) / kDeltaScale, d as product over the poles.
MatrixXcd Response(const Numerators& numerators, const Denominator& denominator,
                   double frequency) {
  const Complex p =
      (std::polar(1.0, 2.0 * std::numbers::pi * frequency * kSampleTime) - 1.0) /
      kDeltaScale;
  MatrixXcd numerator = MatrixXcd::Zero(2, 3);
  for (std::size_t k = 0; k < numerators.size(); ++k) {
    numerator += std::pow(p, static_cast<int>(k)) * numerators[k];
  }
  Complex product = 1.0;
  for (int i = 0; i < denominator.order; ++i) {
    // Butterworth: on a circle in the left half plane, a step of pi / order apart.
    const double angle =
        std::numbers::pi * (0.5 + (i + 0.5) / static_cast<double>(denominator.order));
    const Complex s = std::polar(2.0 * std::numbers::pi * denominator.cutoff, angle);
    product *= p - (std::exp(s * kSampleTime) - 1.0) / kDeltaScale;
  }
  return numerator / product;
}

class Denominators : public testing::TestWithParam<Denominator> {};

TEST_P(Denominators, GiveTheFrequencyResponseOfThePolynomials) {
  const Denominator& denominator = GetParam();
  for (const int degree : {denominator.order - 2, denominator.order}) {
    const Numerators numerators = Sample(degree, denominator);
    const FilterBank bank = MakeFilterBank(numerators, denominator, kSampleTime);
    const Index samples = SettlingSamples(bank, 1e-13);
    for (const double ratio : {0.1, 0.7, 1.0, 3.0}) {
      const double frequency = ratio * denominator.cutoff;
      const MatrixXcd expected = Response(numerators, denominator, frequency);
      EXPECT_LT((FrequencyResponse(bank, frequency) - expected).norm(),
                1e-8 * expected.norm())
          << frequency << " Hz, degree " << degree;
      const double step = 2.0 * std::numbers::pi * frequency * kSampleTime;
      const VectorXd phase = VectorXd::NullaryExpr(
          samples, [&](Index k) { return step * static_cast<double>(k); });
      const Complex last = std::polar(1.0, phase[samples - 1]);
      for (Index input = 0; input < 3; ++input) {
        MatrixXd signals = MatrixXd::Zero(3, samples);
        signals.row(input) = phase.array().cos();
        const MatrixXd real = FilterSignals(bank, signals);
        signals.row(input) = phase.array().sin();
        const MatrixXd imaginary = FilterSignals(bank, signals);
        for (Index output = 0; output < 2; ++output) {
          const Complex response(real(output, samples - 1),
                                 imaginary(output, samples - 1));
          EXPECT_LT(std::abs(response / last - expected(output, input)),
                    1e-8 * expected.norm())
              << frequency << " Hz, degree " << degree;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(FilterBank, Denominators,
                         testing::Values(Denominator{7, 50.0}, Denominator{7, 750.0},
                                         Denominator{4, 200.0}));

TEST(FilterBank, HasHalfPowerAtTheCutOff) {
  // A constant numerator leaves the low-pass itself. Its poles are moved to discrete
  // time one by one, which costs less than 1 % of gain this far below Nyquist.
  const FilterBank bank =
      MakeFilterBank({MatrixXd::Ones(1, 1)}, {7, 50.0}, kSampleTime);
  const auto gain = [&](double frequency) {
    const Index samples = 8000;
    MatrixXd signal(1, samples);
    for (Index k = 0; k < samples; ++k) {
      signal(0, k) = std::cos(2.0 * std::numbers::pi * frequency * kSampleTime *
                              static_cast<double>(k));
    }
    // 4000 samples are whole periods of both tones.
    return FilterSignals(bank, signal).rightCols(4000).norm();
  };
  EXPECT_NEAR(gain(50.0) / gain(2.0), std::numbers::sqrt2 / 2.0, 0.01);
}

TEST(OutputCovariance, IsTheSumOverTheImpulseResponse) {
  const FilterBank bank = MakeFilterBank(Sample(7, {7, 50.0}), {7, 50.0}, kSampleTime);
  const Vector3d noise(1.0, 0.3, 0.0);
  const Index samples = SettlingSamples(bank, 1e-13);
  MatrixXd expected = MatrixXd::Zero(2, 2);
  for (Index input = 0; input < 3; ++input) {
    MatrixXd impulse = MatrixXd::Zero(3, samples);
    impulse(input, 0) = noise[input];
    const MatrixXd response = FilterSignals(bank, impulse);
    expected += response * response.transpose();
  }
  const MatrixXd covariance = OutputCovariance(bank, noise);
  EXPECT_LT((covariance - expected).norm(), 1e-8 * expected.norm());
}

TEST(OutputCovariance, IsWhatNoiseLeaves) {
  const Denominator denominator{5, 750.0};
  const FilterBank bank =
      MakeFilterBank(Sample(4, denominator), denominator, kSampleTime);
  const Vector3d sd(1.0, 0.3, 2.0);
  const MatrixXd expected = OutputCovariance(bank, sd);
  // Means over 200 blocks that are long against the filter's memory: their scatter
  // gives the standard error of the grand mean, which may be off by five of them.
  constexpr int kBlocks = 200;
  constexpr Index kLength = 500;
  const MatrixXd noise = sd.asDiagonal() * test::WhiteNoise(3, kBlocks * kLength, 1, 3);
  const MatrixXd outputs = FilterSignals(bank, noise);
  for (const auto& [i, j] : {std::pair{0, 0}, {0, 1}, {1, 1}}) {
    VectorXd mean(kBlocks);
    for (Index block = 0; block < kBlocks; ++block) {
      mean[block] = outputs.row(i)
                        .segment(block * kLength, kLength)
                        .dot(outputs.row(j).segment(block * kLength, kLength)) /
                    static_cast<double>(kLength);
    }
    const double error = std::sqrt((mean.array() - mean.mean()).square().sum() /
                                   (kBlocks - 1) / kBlocks);
    EXPECT_NEAR(mean.mean(), expected(i, j), 5.0 * error) << i << j;
    EXPECT_LT(error, 0.02 * expected.diagonal().maxCoeff());
  }
}

TEST(RunningBank, HasNoTransientFromItsSteadyState) {
  const Denominator denominator{7, 50.0};
  const FilterBank bank =
      MakeFilterBank(Sample(6, denominator), denominator, kSampleTime);
  const Vector3d level(0.3, -2.0, 5.0);
  const VectorXd expected =
      Response(Sample(6, denominator), denominator, 0.0).real() * level;
  RunningBank running(bank);
  running.Settle(level);
  for (int k = 0; k < 2000; ++k) {
    ASSERT_LT((running.Step(level) - expected).norm(), 1e-8 * expected.norm()) << k;
  }
}

TEST(RunningBank, StepsEveryOutputAsIfItWereAlone) {
  // 1 to 17 outputs: groups of every size.
  const MatrixXd signals = test::WhiteNoise(3, 50, 1.0, 1);
  for (Index count = 1; count <= 17; ++count) {
    const Numerators numerators{test::WhiteNoise(count, 3, 1.0, 2),
                                test::WhiteNoise(count, 3, 1.0, 3)};
    const MatrixXd together =
        FilterSignals(MakeFilterBank(numerators, {3, 200.0}, kSampleTime), signals);
    for (Index i = 0; i < count; ++i) {
      const Numerators one{numerators[0].row(i), numerators[1].row(i)};
      const MatrixXd alone =
          FilterSignals(MakeFilterBank(one, {3, 200.0}, kSampleTime), signals);
      EXPECT_TRUE(together.row(i).isApprox(alone, 1e-12)) << i << " of " << count;
    }
  }
}

TEST(RunningBank, IsAtRestAfterReset) {
  const FilterBank bank =
      MakeFilterBank(Sample(3, {4, 200.0}), {4, 200.0}, kSampleTime);
  RunningBank running(bank);
  const VectorXd first = running.Step(Vector3d::Ones());
  running.Step(Vector3d::Ones());
  running.Reset();
  EXPECT_EQ(running.Step(Vector3d::Ones()), first);
}

TEST(SettlingSamples, AreThoseAfterWhichTheTransientHasDecayed) {
  // Of a fifth-order low-pass the slowest pair of poles is left at the end, which
  // swings about its decay: within a factor of ten of the fraction.
  const FilterBank bank =
      MakeFilterBank({MatrixXd::Ones(1, 1)}, {5, 200.0}, kSampleTime);
  const Index settled = SettlingSamples(bank, 1e-6);
  MatrixXd impulse = MatrixXd::Zero(1, settled + 200);
  impulse(0, 0) = 1.0;
  const MatrixXd response = FilterSignals(bank, impulse).cwiseAbs();
  const double peak = response.maxCoeff();
  EXPECT_LT(response.rightCols(200).maxCoeff(), 1e-5 * peak);
  EXPECT_GT(response.rightCols(200).maxCoeff(), 1e-7 * peak);
}

TEST(MakeFilterBank, RefusesAnOrderBelowTheDegree) {
  const Numerators numerators = Sample(7, {7, 50.0});
  EXPECT_EQ(test::MessageOf<InputError>([&] {
              MakeFilterBank(numerators, {6, 50.0}, kSampleTime);
            }),
            "denominator: order 6; expected at least the degree of the numerator, 7");
}

TEST(MakeFilterBank, RefusesADenominatorOfOrderZero) {
  EXPECT_THROW(MakeFilterBank({MatrixXd::Ones(1, 1)}, {0, 50.0}, kSampleTime),
               InputError);
}

TEST(MakeFilterBank, RefusesACutOffOutsideTheBand) {
  for (const double cutoff : {4000.0, 5000.0, 0.0, -1.0, std::nan("")}) {
    EXPECT_THROW(MakeFilterBank({MatrixXd::Ones(1, 1)}, {3, cutoff}, kSampleTime),
                 InputError)
        << cutoff;
  }
}

}  // namespace
}  // namespace mjdiag
