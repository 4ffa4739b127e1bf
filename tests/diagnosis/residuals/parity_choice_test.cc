#include "mjdiag/diagnosis/residuals/parity_choice.h"

#include <gtest/gtest.h>

#include "diagnosis/test_stage.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kSize = 5;

/// Positive definite, with a condition number of 1e4 or so.
MatrixXd Energy(std::uint64_t seed) {
  const MatrixXd rows = test::WhiteNoise(kSize, kSize, 1.0, seed);
  VectorXd scale(kSize);
  scale << 10.0, 3.0, 1.0, 0.3, 0.1;
  return rows.transpose() * scale.array().square().matrix().asDiagonal() * rows +
         1e-3 * MatrixXd::Identity(kSize, kSize);
}

double Power(const VectorXd& a, const MatrixXd& energy) { return a.dot(energy * a); }

/// Calls `check` with random unit vectors and with small changes of `best`.
template <typename Check>
void Compare(const VectorXd& best, const Check& check) {
  EXPECT_NEAR(best.norm(), 1.0, 1e-12);
  for (std::uint64_t k = 0; k < 500; ++k) {
    const VectorXd random = test::WhiteNoise(kSize, 1, 1.0, 50 + k);
    check(random.normalized());
    check((best + 0.01 * random).normalized());
  }
}

TEST(LeastExcitedRelation, HasTheLeastEnergyOfAllThatSeeTheFault) {
  const MatrixXd nuisance = Energy(1);
  const MatrixXd response = test::WhiteNoise(kSize, 7, 1.0, 2);
  const VectorXd chosen = LeastExcitedRelation(nuisance, response);
  // Scaled so that the best instant has g a = 1, its energy is the programme's value.
  Index best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (Index j = 0; j < response.cols(); ++j) {
    const double seen = response.col(j).dot(chosen);
    const double value = Power(chosen, nuisance) / (seen * seen);
    if (value < least) best = j;
    least = std::min(least, value);
  }
  EXPECT_GT(response.col(best).dot(chosen), 0.0);
  Compare(chosen, [&](const VectorXd& other) {
    for (Index j = 0; j < response.cols(); ++j) {
      const double seen = response.col(j).dot(other);
      EXPECT_GE(Power(other, nuisance) / (seen * seen), least * (1.0 - 1e-9));
    }
  });
}

TEST(LeastExcitedRelation, RefusesANuisanceThatIsNotPositiveDefinite) {
  MatrixXd nuisance = MatrixXd::Identity(kSize, kSize);
  nuisance(2, 2) = 0.0;
  EXPECT_THROW(LeastExcitedRelation(nuisance, MatrixXd::Ones(kSize, 1)),
               NumericalError);
}

TEST(BestRatioRelation, HasTheLargestRatio) {
  const MatrixXd energy = Energy(3);
  const MatrixXd nuisance = Energy(4);
  const VectorXd chosen = BestRatioRelation(energy, nuisance);
  const double best = Power(chosen, energy) / Power(chosen, nuisance);
  Compare(chosen, [&](const VectorXd& other) {
    EXPECT_LE(Power(other, energy) / Power(other, nuisance), best * (1.0 + 1e-9));
  });
}

TEST(MostSensitiveRelation, HasTheLargestProductAtEveryScaleOfAFault) {
  std::vector<MatrixXd> energies{Energy(5), 1e6 * Energy(6), Energy(7)};
  const VectorXd chosen = MostSensitiveRelation(energies);
  const auto product = [&](const VectorXd& a) {
    return Power(a, energies[0]) * Power(a, energies[1]) * Power(a, energies[2]);
  };
  const double best = product(chosen);
  Compare(chosen, [&](const VectorXd& other) {
    EXPECT_LE(product(other), best * (1.0 + 1e-6));
  });
  energies[1] *= 1e-9;
  const VectorXd rescaled = MostSensitiveRelation(energies);
  EXPECT_NEAR(std::abs(rescaled.dot(chosen)), 1.0, 1e-9);
}

TEST(BestRatioRelation, OfSeveralHasTheLargestProductOfRatios) {
  const std::vector<MatrixXd> energies{Energy(5), 1e6 * Energy(6)};
  const std::vector<MatrixXd> nuisances{Energy(9), 1e-3 * Energy(10)};
  const VectorXd chosen = BestRatioRelation(energies, nuisances);
  const auto product = [&](const VectorXd& a) {
    return Power(a, energies[0]) * Power(a, energies[1]) / Power(a, nuisances[0]) /
           Power(a, nuisances[1]);
  };
  const double best = product(chosen);
  Compare(chosen, [&](const VectorXd& other) {
    EXPECT_LE(product(other), best * (1.0 + 1e-6));
  });
}

TEST(MostSensitiveRelation, GivesUpNoneOfTwoFaultsThatPullApart) {
  const MatrixXd first =
      VectorXd::Unit(kSize, 0) * VectorXd::Unit(kSize, 0).transpose();
  const MatrixXd second =
      VectorXd::Unit(kSize, 1) * VectorXd::Unit(kSize, 1).transpose();
  const VectorXd chosen = MostSensitiveRelation({first, second});
  EXPECT_NEAR(chosen[0] * chosen[0], 0.5, 1e-6);
  EXPECT_NEAR(chosen[1] * chosen[1], 0.5, 1e-6);
}

TEST(CompleteBasis, IsOrthonormalAndBeginsWithTheVector) {
  const VectorXd first = VectorXd(test::WhiteNoise(kSize, 1, 1.0, 8)).normalized();
  for (const int n : {1, 3, 5, 0, 9}) {
    const MatrixXd basis = CompleteBasis(first, n);
    EXPECT_EQ(basis.rows(), n == 0 || n > kSize ? kSize : n);
    EXPECT_TRUE((basis * basis.transpose()).isIdentity(1e-12)) << n;
    EXPECT_EQ(basis.row(0), first.transpose());
  }
}

TEST(FaultEnergies, AreThoseOfThePrefilteredSignals) {
  const SynthesisOptions options = test::StageOptions();
  const ResidualBank bank =
      SynthesiseBank(MakeResidualSpace(test::Stage(), options),
                     MatrixXd::Identity(4, 4), test::PerturbedStages(), options);
  const MatrixXd signals = test::Motion(test::Stage(), test::Drive(500));
  const std::vector<MatrixXd> energies = FaultEnergies(bank, signals);
  ASSERT_EQ(energies.size(), 3U);
  // A relation mixed into the bank has the energy a' G a in every fault.
  const VectorXd a = Eigen::Vector4d(0.6, 0.0, 0.8, 0.0);
  const MatrixXd mixed = FilterSignals(Mix(bank, a.transpose()).filters, signals);
  for (Index i = 0; i < 3; ++i) {
    const double expected = mixed.row(i + 1).squaredNorm();
    EXPECT_NEAR(Power(a, energies[static_cast<std::size_t>(i)]), expected,
                1e-9 * expected);
  }
}

}  // namespace
}  // namespace mjdiag
