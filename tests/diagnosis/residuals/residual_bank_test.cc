#include "mjdiag/diagnosis/residuals/residual_bank.h"

#include <gtest/gtest.h>

#include "diagnosis/test_stage.h"
#include "mjdiag/diagnosis/model/left_null_space.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr Index kSamples = 4000;

FilterBank Filters(const Numerators& relations, const SynthesisOptions& options) {
  return MakeFilterBank(relations, options.residual.denominator, options.timing.tick());
}

/// Largest |r| of every relation of the machine's residual space over a noise-free
/// motion, in standard deviations of its noise.
double Seen(const SynthesisOptions& options, const MatrixXd& signals) {
  const ResidualSpace space = MakeResidualSpace(test::Stage(), options);
  return FilterSignals(Filters(space.relations, options), signals)
      .cwiseAbs()
      .maxCoeff();
}

/// The bank of all residuals of the stage and of all its faults.
ResidualBank WholeBank(double magnitude, const SynthesisOptions& options) {
  const ResidualSpace space = MakeResidualSpace(test::Stage(), options);
  const Index size = space.relations.front().rows();
  return SynthesiseBank(space, MatrixXd::Identity(size, size),
                        test::PerturbedStages(magnitude), options);
}

/// z with a force on one coordinate that is none of the commands.
MatrixXd MotionWithForce(const Vector3d& force) {
  MechanicalModel model = test::Stage();
  model.Gamma.conservativeResize(3, 3);
  model.Gamma.col(2) = force;
  MatrixXd commands(3, kSamples);
  commands.topRows(2) = test::Drive(kSamples);
  commands.row(2) = test::WhiteNoise(1, kSamples, 10.0, 4);
  return test::Motion(model, commands).topRows(4);
}

class ResidualDegree : public testing::TestWithParam<int> {};

TEST_P(ResidualDegree, IsBlindToNominalMotionAtUnitNoise) {
  SynthesisOptions options = test::StageOptions();
  options.residual.degree = GetParam();
  options.residual.denominator.order = GetParam();
  const ResidualSpace space = MakeResidualSpace(test::Stage(), options);
  const FilterBank bank = Filters(space.relations, options);
  ASSERT_EQ(bank.outputs(), 2 * (options.residual.degree + 1) - 6);
  const VectorXd noise =
      (VectorXd(4) << test::kNoise, test::kNoise, 0.0, 0.0).finished();
  EXPECT_TRUE(OutputCovariance(bank, noise).isIdentity(1e-6));
  const MatrixXd signals = test::Motion(test::Stage(), test::Drive(kSamples));
  EXPECT_LT(FilterSignals(bank, signals).cwiseAbs().maxCoeff(), 1e-3);
  // The motion itself is five decades above the noise.
  EXPECT_GT(signals.topRows(2).cwiseAbs().maxCoeff(), 1e5 * test::kNoise);
}

INSTANTIATE_TEST_SUITE_P(ResidualSpace, ResidualDegree, testing::Values(3, 4, 6));

TEST(ResidualSpace, HasUnequalNoiseOnTheSensorsInItsUnit) {
  SynthesisOptions options = test::StageOptions();
  options.sensor_noise = Eigen::Vector2d(20e-9, 500e-9);
  const ResidualSpace space = MakeResidualSpace(test::Stage(), options);
  const VectorXd noise = (VectorXd(4) << 20e-9, 500e-9, 0.0, 0.0).finished();
  EXPECT_TRUE(
      OutputCovariance(Filters(space.relations, options), noise).isIdentity(1e-6));
}

TEST(ResidualSpace, DecoupledFromAForceIsBlindToItAndToNoOther) {
  const Vector3d on_base = Vector3d::UnitX();
  const Vector3d on_load = Vector3d::UnitZ();
  SynthesisOptions decoupled = test::StageOptions();
  decoupled.residual.degree = 6;
  decoupled.residual.denominator.order = 6;
  EXPECT_GT(Seen(decoupled, MotionWithForce(on_base)), 10.0);
  decoupled.unknown_inputs.forces = on_base;
  EXPECT_LT(Seen(decoupled, MotionWithForce(on_base)), 1e-3);
  EXPECT_GT(Seen(decoupled, MotionWithForce(on_load)), 10.0);
}

TEST(ResidualSpace, DecoupledFromAReadingIsBlindToItAndToNoOther) {
  const auto motion_with_error = [](Index sensor) {
    MatrixXd signals = test::Motion(test::Stage(), test::Drive(kSamples));
    signals.row(sensor) += test::WhiteNoise(1, kSamples, 1e-4, 4);
    return signals;
  };
  SynthesisOptions decoupled = test::StageOptions();
  decoupled.residual.degree = 6;
  decoupled.residual.denominator.order = 6;
  EXPECT_GT(Seen(decoupled, motion_with_error(1)), 10.0);
  decoupled.unknown_inputs.readings = Eigen::Vector2d(0.0, 1.0);
  EXPECT_LT(Seen(decoupled, motion_with_error(1)), 1e-3);
  EXPECT_GT(Seen(decoupled, motion_with_error(0)), 10.0);
}

TEST(ResidualSpace, RefusesUnknownInputsThatDoNotFitTheMachine) {
  SynthesisOptions options = test::StageOptions();
  // Column j of both is one signal, so both need as many, or none.
  options.unknown_inputs.forces = Vector3d::UnitX();
  options.unknown_inputs.readings = MatrixXd::Zero(2, 2);
  EXPECT_THROW(MakeResidualSpace(test::Stage(), options), InputError);
  options.unknown_inputs.forces.resize(0, 0);
  options.unknown_inputs.readings = MatrixXd::Zero(3, 1);
  EXPECT_THROW(MakeResidualSpace(test::Stage(), options), InputError);
}

TEST(ResidualSpace, SaysWhichDegreeIsEnough) {
  SynthesisOptions options = test::StageOptions();
  options.residual.degree = 2;
  EXPECT_EQ(
      test::MessageOf<InputError>([&] { MakeResidualSpace(test::Stage(), options); }),
      "residual: no parity relation of degree 2; expected a degree of at least 3");
}

TEST(ResidualSpace, RefusesADenominatorOfLowerOrder) {
  SynthesisOptions options = test::StageOptions();
  options.residual.denominator.order = 2;
  EXPECT_THROW(MakeResidualSpace(test::Stage(), options), InputError);
}

TEST(ResidualBank, PhiIsMinusTheDerivativeOfTheResidual) {
  // On the machine that has the fault, r - sum_i phi_i f_i is of second order: half of
  // the fault leaves a quarter.
  const ResidualBank bank = WholeBank(1e-4, test::StageOptions());
  const Index n = bank.residuals;
  const auto rest = [&](const Vector3d& fault) {
    const MatrixXd outputs = FilterSignals(
        bank.filters,
        test::Motion(test::Stage(test::Moved(fault)), test::Drive(kSamples)));
    MatrixXd residual = outputs.topRows(n);
    const double seen = residual.norm();
    for (Index i = 0; i < 3; ++i) {
      residual -= fault[i] * outputs.middleRows((i + 1) * n, n);
    }
    EXPECT_LT(residual.norm(), 0.05 * seen) << fault.transpose();
    return residual.norm();
  };
  for (const Vector3d& fault : {Vector3d(0.02, 0.0, 0.0), Vector3d(0.0, 0.02, 0.0),
                                Vector3d(0.02, -0.01, 0.01)}) {
    EXPECT_NEAR(rest(fault) / rest(0.5 * fault), 4.0, 0.1) << fault.transpose();
  }
  // Commands enter the residual linearly: phi of a gain is exact.
  EXPECT_LT(rest(Vector3d(0.0, 0.0, 0.02)), 1e-3);
}

/// Filter coefficients of each output as a row: linear in its numerator.
MatrixXd Coefficients(const FilterBank& bank) {
  const Index m = bank.outputs();
  MatrixXd rows(m, (bank.order() + 1) * bank.inputs());
  rows.leftCols(bank.inputs()) = bank.D;
  for (Index k = 0; k < bank.order(); ++k) {
    rows.middleCols((k + 1) * bank.inputs(), bank.inputs()) =
        bank.B.middleRows(k * m, m);
  }
  return rows;
}

TEST(ResidualBank, PhiIsEquation24UpToRelationsThatAreBlind) {
  // N (dH, dL) with N H = 0 give dN = -N dH H^+ and with it the derivative of N L,
  // N (dL - dH H^+ L): the negative of phi. Vectors of the null space may be added to
  // N, hence residuals to phi; both are compared in the complement of those. The
  // cut-off of 640 Hz makes powers of p comparable.
  SynthesisOptions options = test::StageOptions();
  options.residual.denominator = {4, 640.0};
  const int degree = options.residual.degree;
  constexpr double kStep = 1e-4;
  const StateSpace system = DeltaForm(test::Stage(), options.timing);
  const MatrixXd output_part = LeftNullSpace(system, degree).relations;
  const PolynomialMatrix null_vectors = CompleteRelations(system, output_part);
  MatrixXd N(null_vectors.rows(), (degree + 1) * null_vectors.cols());
  for (int k = 0; k <= degree; ++k) {
    N.middleCols(k * null_vectors.cols(), null_vectors.cols()) =
        null_vectors.coefficients[static_cast<std::size_t>(k)];
  }
  const auto filters_of = [&](const MatrixXd& bar_rows) {
    Numerators numerators;
    for (Index k = 0; k <= degree; ++k) {
      numerators.emplace_back(bar_rows.middleCols(4 * k, 4));
    }
    return Coefficients(Filters(numerators, options));
  };
  const auto bar_H = [&](const MechanicalModel& model) {
    return BarMatrix(MakeDae(DeltaForm(model, options.timing)).H, degree);
  };
  const auto bar_L = [&](const MechanicalModel& model) {
    return BarMatrix(MakeDae(DeltaForm(model, options.timing)).L, degree);
  };
  const MatrixXd H = bar_H(test::Stage());
  const MatrixXd L = bar_L(test::Stage());
  const MatrixXd H_plus = PseudoInverse(H);
  const MatrixXd blind = filters_of(N * L);
  const auto beyond_blind = [&](const MatrixXd& rows) -> MatrixXd {
    return rows - rows * PseudoInverse(blind) * blind;
  };

  // The same N in both: the bank's residuals are combinations of N L.
  const ResidualSpace space = MakeResidualSpace(test::Stage(), options);
  const Index n = space.relations.front().rows();
  const ResidualBank bank = SynthesiseBank(space, MatrixXd::Identity(n, n),
                                           test::PerturbedStages(kStep), options);
  const MatrixXd all = Coefficients(bank.filters);
  const MatrixXd mixing = all.topRows(n) * PseudoInverse(blind);
  ASSERT_LT((mixing * blind - all.topRows(n)).norm(), 1e-9 * all.topRows(n).norm());

  Index row = n;
  for (const PerturbedModels& fault : test::PerturbedStages(kStep)) {
    const MatrixXd dH = (bar_H(fault.plus) - bar_H(fault.minus)) / (2.0 * kStep);
    const MatrixXd dL = (bar_L(fault.plus) - bar_L(fault.minus)) / (2.0 * kStep);
    const MatrixXd equation_24 =
        beyond_blind(filters_of(mixing * N * (dL - dH * H_plus * L)));
    const MatrixXd phi = beyond_blind(all.middleRows(row, n));
    EXPECT_GT(phi.norm(), 1e-3 * all.middleRows(row, n).norm()) << fault.name;
    EXPECT_LT((phi + equation_24).norm(), 1e-5 * phi.norm()) << fault.name;
    row += n;
  }
}

TEST(ResidualBank, NoiseOfPhiIsUncorrelatedWithThatOfTheResiduals) {
  const ResidualBank bank = WholeBank(1e-3, test::StageOptions());
  const Index n = bank.residuals;
  const VectorXd noise =
      (VectorXd(4) << test::kNoise, test::kNoise, 0.0, 0.0).finished();
  const MatrixXd covariance = OutputCovariance(bank.filters, noise);
  const VectorXd sd = covariance.diagonal().cwiseSqrt();
  const MatrixXd correlation =
      sd.cwiseInverse().asDiagonal() * covariance * sd.cwiseInverse().asDiagonal();
  EXPECT_LT(correlation.topRightCorner(n, 3 * n).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_TRUE(correlation.topLeftCorner(n, n).isIdentity(1e-6));
}

TEST(ResidualBank, OfOneResidualIsTheMixOfAll) {
  const SynthesisOptions options = test::StageOptions();
  const ResidualSpace space = MakeResidualSpace(test::Stage(), options);
  const ResidualBank whole = WholeBank(1e-3, options);
  const MatrixXd combination = (MatrixXd(1, 4) << 0.6, 0.0, -0.8, 0.0).finished();
  const ResidualBank mixed = Mix(whole, combination);
  const ResidualBank direct =
      SynthesiseBank(space, combination, test::PerturbedStages(1e-3), options);
  EXPECT_EQ(mixed.residuals, 1);
  EXPECT_EQ(mixed.faults, test::kFaults);
  const MatrixXd expected = Coefficients(direct.filters);
  EXPECT_LT((Coefficients(mixed.filters) - expected).norm(), 1e-8 * expected.norm());
  const MatrixXd signals =
      test::Motion(test::Stage({.damping = 1.1}), test::Drive(200));
  const MatrixXd before = FilterSignals(whole.filters, signals);
  const MatrixXd after = FilterSignals(mixed.filters, signals);
  for (Index group = 0; group < 4; ++group) {
    EXPECT_TRUE(
        after.row(group).isApprox(combination * before.middleRows(4 * group, 4), 1e-9));
  }
}

}  // namespace
}  // namespace mjdiag
