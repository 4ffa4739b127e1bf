#include "mjdiag/diagnosis/residuals/fault_estimator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "diagnosis/test_stage.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr Index kResiduals = 2;
constexpr Index kFaults = 3;

/// A bank of two residuals over three noisy signals.
FilterBank NoiseBank() {
  Numerators numerators;
  for (int k = 0; k <= 3; ++k) {
    numerators.push_back(test::WhiteNoise(kResiduals, 3, std::pow(10.0, k), 20 + k));
  }
  return MakeFilterBank(numerators, {3, 300.0}, 1.0 / 8000.0);
}

const Vector3d kSignalNoise(0.5, 1.0, 0.0);

std::string Text(const Vector3d& numbers) {
  return std::to_string(numbers[0]) + " " + std::to_string(numbers[1]) + " " +
         std::to_string(numbers[2]);
}

ResidualNoise Noise(int decimation) {
  return MakeResidualNoise(NoiseBank(), kResiduals, kSignalNoise, decimation);
}

/// G of samples * kResiduals rows. Slow signals, so that errors add up coherently.
MatrixXd Regressors(Index samples) {
  MatrixXd regressors(samples * kResiduals, kFaults);
  for (Index t = 0; t < samples; ++t) {
    const double phase = 0.05 * static_cast<double>(t);
    regressors.row(t * kResiduals) << 1.0, std::sin(phase), 20.0 * std::cos(phase);
    regressors.row(t * kResiduals + 1) << 0.3, std::cos(2.0 * phase), -5.0;
  }
  return regressors;
}

FaultEstimator Regressed(const MatrixXd& regressors, const VectorXd& residuals,
                         int decimation, double forgetting, bool at_rest = false) {
  FaultEstimator estimator(regressors.cols(), Noise(decimation), forgetting, at_rest);
  for (Index t = 0; t < residuals.size(); t += kResiduals) {
    estimator.Add(residuals.segment(t, kResiduals),
                  regressors.middleRows(t, kResiduals).transpose());
  }
  return estimator;
}

/// sqrt(lambda^age) of every row.
VectorXd RootWeights(Index rows, double forgetting) {
  VectorXd weights(rows);
  for (Index i = 0; i < rows; ++i) {
    const Index age = (rows - 1 - i) / kResiduals;
    weights[i] = std::pow(forgetting, 0.5 * static_cast<double>(age));
  }
  return weights;
}

struct Weighting {
  double forgetting;
  bool at_rest;
};
class Weightings : public testing::TestWithParam<Weighting> {};

TEST_P(Weightings, EstimateIsWeightedLeastSquares) {
  const MatrixXd regressors = Regressors(200);
  const VectorXd residuals =
      regressors * Vector3d(1.0, -2.0, 0.1) + test::WhiteNoise(400, 1, 1.0, 2);
  const VectorXd weights = RootWeights(residuals.size(), GetParam().forgetting);
  const VectorXd expected =
      LeastSquares(weights.asDiagonal() * regressors, weights.cwiseProduct(residuals));
  FaultEstimator estimator = Regressed(regressors, residuals, 1, GetParam().forgetting);
  EXPECT_EQ(estimator.samples(), 200);
  EXPECT_TRUE(estimator.Estimate().value.isApprox(expected, 1e-10));
  VectorXd solved(kFaults);
  estimator.Solve(solved);
  EXPECT_TRUE(solved.isApprox(expected, 1e-10));
}

TEST_P(Weightings, CovarianceIsThatOfRepeatedEstimates) {
  // The noise is that of the filters, every fourth sample. With R draws a sample
  // variance scatters by sqrt(2 / R) of itself, a correlation by 1 / sqrt(R); five of
  // these are allowed. Of intervals of 95 % a binomial count lies within
  // 2.576 sqrt(R 0.95 0.05) of 0.95 R in 99 of 100 cases.
  constexpr int kDraws = 1000;
  constexpr int kDecimation = 4;
  constexpr Index kSamples = 200;
  const MatrixXd regressors = Regressors(kSamples);
  const FilterBank bank = NoiseBank();
  const Vector3d truth(1.0, -2.0, 0.1);
  const Index settled = GetParam().at_rest ? 0 : SettlingSamples(bank, 1e-4);
  MatrixXd errors(kFaults, kDraws);
  MatrixXd covariance;
  Vector3d covered = Vector3d::Zero();
  for (int draw = 0; draw < kDraws; ++draw) {
    const MatrixXd white =
        kSignalNoise.asDiagonal() *
        test::WhiteNoise(3, settled + kSamples * kDecimation, 1.0, 100 + draw);
    const MatrixXd coloured = FilterSignals(bank, white);
    VectorXd residuals = regressors * truth;
    for (Index t = 0; t < kSamples; ++t) {
      residuals.segment(t * kResiduals, kResiduals) +=
          coloured.col(settled + t * kDecimation);
    }
    const FaultEstimate estimate = Regressed(regressors, residuals, kDecimation,
                                             GetParam().forgetting, GetParam().at_rest)
                                       .Estimate();
    covariance = estimate.covariance;
    errors.col(draw) = estimate.value - truth;
    const VectorXd reach = 1.96 * covariance.diagonal().cwiseSqrt();
    covered.array() += (errors.col(draw).array().abs() < reach.array()).cast<double>();
  }
  const VectorXd sd = covariance.diagonal().cwiseSqrt();
  const MatrixXd standard = sd.cwiseInverse().asDiagonal() * errors;
  const MatrixXd seen = standard * standard.transpose() / kDraws;
  const MatrixXd expected =
      sd.cwiseInverse().asDiagonal() * covariance * sd.cwiseInverse().asDiagonal();
  EXPECT_LT((seen - expected).cwiseAbs().maxCoeff(), 5.0 * std::sqrt(2.0 / kDraws));
  for (Index i = 0; i < kFaults; ++i) {
    EXPECT_NEAR(covered[i], 0.95 * kDraws, 2.576 * std::sqrt(kDraws * 0.95 * 0.05))
        << i;
  }
  RecordProperty("covered", Text(covered));
}

INSTANTIATE_TEST_SUITE_P(FaultEstimator, Weightings,
                         testing::Values(Weighting{1.0, false}, Weighting{0.97, false},
                                         Weighting{1.0, true}));

TEST(ResidualNoise, IsThatOfTheFilterAndItsDecimation) {
  // Autocovariance at lag L from the impulse response.
  const FilterBank bank = NoiseBank();
  const Index samples = SettlingSamples(bank, 1e-12);
  for (const Index lag : {1, 3}) {
    MatrixXd now = MatrixXd::Zero(kResiduals, kResiduals);
    MatrixXd later = now;
    for (Index input = 0; input < 3; ++input) {
      MatrixXd impulse = MatrixXd::Zero(3, samples + lag);
      impulse(input, 0) = kSignalNoise[input];
      const MatrixXd response = FilterSignals(bank, impulse);
      now += response * response.transpose();
      later += response.rightCols(samples) * response.leftCols(samples).transpose();
    }
    const ResidualNoise noise = Noise(static_cast<int>(lag));
    const MatrixXd with_state = noise.state * noise.C.transpose();
    EXPECT_TRUE((noise.C * with_state + noise.direct).isApprox(now, 1e-9));
    EXPECT_TRUE((noise.C * (noise.A * with_state + noise.carry)).isApprox(later, 1e-9))
        << lag;
    const MatrixXd next = noise.A * noise.state * noise.A.transpose() + noise.drive;
    EXPECT_TRUE(next.isApprox(noise.state, 1e-9));
  }
}

TEST(FaultEstimator, IntervalsCoverTheFaultsOfAMachine) {
  // All three faults at once; regressors from the same noisy readings as the residuals.
  // Of 200 runs 182 to 197 hold (binomial, 99 %).
  constexpr int kRuns = 200;
  constexpr int kDecimation = 4;
  constexpr Index kSamples = 3000;
  const Vector3d fault(2e-3, -1e-2, 1e-3);
  const SynthesisOptions options = test::StageOptions();
  const ResidualSpace space = MakeResidualSpace(test::Stage(), options);
  const Index n = test::kRelations;
  const ResidualBank bank =
      SynthesiseBank(space, MatrixXd::Identity(n, n), test::PerturbedStages(), options);
  const VectorXd noise =
      (VectorXd(4) << test::kNoise, test::kNoise, 0.0, 0.0).finished();
  const ResidualNoise residual_noise =
      MakeResidualNoise(bank.filters, n, noise, kDecimation);
  const MatrixXd motion =
      test::Motion(test::Stage(test::Moved(fault)), test::Drive(kSamples));
  Vector3d covered = Vector3d::Zero();
  Vector3d sd = Vector3d::Zero();
  for (int run = 0; run < kRuns; ++run) {
    const MatrixXd outputs = FilterSignals(
        bank.filters, test::Measured(motion, static_cast<std::uint64_t>(run)));
    FaultEstimator estimator(3, residual_noise, 1.0);
    for (Index t = 200; t < kSamples; t += kDecimation) {
      estimator.Add(outputs.col(t).head(n),
                    outputs.col(t).tail(3 * n).reshaped(n, 3).transpose());
    }
    const FaultEstimate estimate = estimator.Estimate();
    sd = estimate.covariance.diagonal().cwiseSqrt();
    covered.array() +=
        ((estimate.value - fault).array().abs() < 1.96 * sd.array()).cast<double>();
  }
  for (Index i = 0; i < 3; ++i) {
    EXPECT_GE(covered[i], 182.0) << test::kFaults[static_cast<std::size_t>(i)];
    EXPECT_LE(covered[i], 197.0) << test::kFaults[static_cast<std::size_t>(i)];
    // Wide intervals would cover anything.
    EXPECT_LT(sd[i], 0.2 * std::abs(fault[i]));
  }
  RecordProperty("covered", Text(covered));
}

TEST(FaultEstimator, HasOnlyTheDirectNoiseAtTheFirstSampleAfterRest) {
  const MatrixXd regressor = (MatrixXd(1, 2) << 1.0, 0.5).finished();
  const ResidualNoise noise = Noise(1);
  const MatrixXd stationary =
      noise.direct + noise.C * noise.state * noise.C.transpose();
  const auto variance = [&](const MatrixXd& covariance) {
    const double power = regressor.squaredNorm();
    return (regressor * covariance * regressor.transpose()).value() / (power * power);
  };
  FaultEstimator estimator(1, noise, 1.0, true);
  estimator.Add(VectorXd::Ones(2), regressor);
  EXPECT_NEAR(estimator.Estimate().covariance(0, 0), variance(noise.direct),
              1e-9 * variance(noise.direct));
  FaultEstimator assumed(1, noise, 1.0, true);
  assumed.AssumeStationary();
  assumed.Add(VectorXd::Ones(2), regressor);
  EXPECT_NEAR(assumed.Estimate().covariance(0, 0), variance(stationary),
              1e-9 * variance(stationary));
  EXPECT_GT(variance(stationary), 1.2 * variance(noise.direct));
}

TEST(Inseparable, NamesTwoCollinearFaults) {
  MatrixXd regressors = Regressors(100);
  regressors.col(2) = -1e3 * regressors.col(0);
  const VectorXd residuals = VectorXd::Ones(200);
  FaultEstimator estimator = Regressed(regressors, residuals, 1, 1.0);
  EXPECT_THAT(estimator.Inseparable(), ElementsAre(0, 2));
  EXPECT_THROW(estimator.Estimate(), NumericalError);
  VectorXd value = VectorXd::Ones(kFaults);
  estimator.Solve(value);
  EXPECT_EQ(value, VectorXd::Zero(kFaults));
}

TEST(Inseparable, NamesAFaultThatNothingExcites) {
  MatrixXd regressors = Regressors(100);
  regressors.col(1).setZero();
  FaultEstimator estimator = Regressed(regressors, VectorXd::Ones(200), 1, 1.0);
  EXPECT_THAT(estimator.Inseparable(), ElementsAre(1));
  EXPECT_THROW(estimator.Estimate(), NumericalError);
  VectorXd value = VectorXd::Ones(kFaults);
  estimator.Solve(value);
  EXPECT_EQ(value, VectorXd::Zero(kFaults));
}

TEST(Inseparable, IsEmptyOnceTheDataDetermineAll) {
  FaultEstimator estimator(kFaults, Noise(1), 1.0);
  EXPECT_THAT(estimator.Inseparable(), ElementsAre(0, 1, 2));
  EXPECT_THAT(Regressed(Regressors(100), VectorXd::Ones(200), 1, 1.0).Inseparable(),
              IsEmpty());
}

TEST(FaultEstimator, OfNoFaultsHasNothingToSay) {
  FaultEstimator estimator(0, Noise(1), 1.0);
  estimator.Add(VectorXd::Ones(kResiduals), MatrixXd(0, kResiduals));
  VectorXd value(0);
  estimator.Solve(value);
  EXPECT_THAT(estimator.Inseparable(), IsEmpty());
  EXPECT_EQ(estimator.Estimate().value.size(), 0);
}

TEST(FaultEstimator, RefusesAForgettingFactorOutOfRange) {
  for (const double forgetting : {0.0, -0.5, 1.01, std::nan("")}) {
    EXPECT_THROW(FaultEstimator(1, Noise(1), forgetting), InputError) << forgetting;
  }
}

}  // namespace
}  // namespace mjdiag
