#include "mjdiag/diagnosis/model/left_null_space.h"

#include <gtest/gtest.h>

#include <cmath>

#include "diagnosis/five_masses.h"
#include "diagnosis/test_stage.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Five masses, force on the first, scales on the outer two.
MechanicalModel Chain() {
  MechanicalModel model = test::FiveMasses();
  model.Gamma = VectorXd::Unit(test::kMasses, 0);
  model.b = MatrixXd::Zero(test::kMasses, 2);
  model.b(0, 0) = model.b(4, 1) = 1.0;
  model.inputs = {"u"};
  model.outputs = {"y1", "y5"};
  return model;
}

TEST(ObservabilityRanks, GrowByTheOutputsUntilAResidualExists) {
  // The middle mass is reached from either scale through two springs with their
  // dampers. All springs have the same ratio of damping to stiffness, so those factors
  // cancel, and equating both ways gives one residual of degree 4: one of the ten rows
  // of that degree is not new.
  const MechanicalModel model = Chain();
  const StateSpace system = UnitMassStateSpace(model, FastTimeUnit(model));
  EXPECT_EQ(ObservabilityRanks(system, 6), (std::vector<int>{2, 4, 6, 8, 9, 10, 10}));
}

TEST(ObservabilityRanks, SeeWhatNoSensorSees) {
  // Without the coupling the last mass is out of sight of the first scale.
  MechanicalModel model = Chain();
  model.K(3, 4) = model.K(4, 3) = model.D(3, 4) = model.D(4, 3) = 0.0;
  model.b = model.b.leftCols(1).eval();
  const StateSpace system = UnitMassStateSpace(model, FastTimeUnit(model));
  EXPECT_EQ(ObservabilityRanks(system, 9).back(), 8);
}

TEST(LeftNullVector, AnnihilatesH) {
  const MechanicalModel model = Chain();
  const StateSpace system = UnitMassStateSpace(model, FastTimeUnit(model));
  const PolynomialMatrix vector = LeftNullVector(system, 4, {{1, 4, 1.0}});
  const PolynomialMatrix product = vector * MakeDae(system).H;
  double largest = 0.0;
  for (const MatrixXd& coefficient : vector.coefficients) {
    largest = std::max(largest, coefficient.cwiseAbs().maxCoeff());
  }
  for (const MatrixXd& coefficient : product.coefficients) {
    EXPECT_LT(coefficient.cwiseAbs().maxCoeff(), 1e-12 * largest);
  }
  EXPECT_DOUBLE_EQ(vector.coefficients[4](0, system.states() + 1), 1.0);
}

TEST(LeftNullVector, RefusesPinsThatLeaveAChoice) {
  const MechanicalModel model = Chain();
  const StateSpace system = UnitMassStateSpace(model, FastTimeUnit(model));
  EXPECT_THROW(LeftNullVector(system, 5, {{1, 5, 1.0}}), NumericalError);
}

TEST(LeftNullVector, RefusesPinsThatNoVectorHas) {
  // Below the observability index there is no residual at all.
  const MechanicalModel model = Chain();
  const StateSpace system = UnitMassStateSpace(model, FastTimeUnit(model));
  EXPECT_THROW(LeftNullVector(system, 3, {{1, 3, 1.0}}), NumericalError);
}

TEST(PinnedParityRelation, IsZeroOnTheMachinesOwnResponse) {
  // r_y(s) G(s) + r_u(s) = 0 at any s, in SI units.
  const MechanicalModel model = Chain();
  const ParityRelation relation =
      PinnedParityRelation(model, 5, {{0, 5, 0.0}, {1, 0, -3e7}});
  EXPECT_NEAR(relation.outputs(1, 0), -3e7, 1.0);
  const std::complex<double> s(3.0, 40.0);
  const Eigen::MatrixXcd stiffness =
      s * s * model.M + s * model.D + Eigen::MatrixXcd(model.K);
  const Eigen::VectorXcd response =
      model.b.transpose() * SolveComplex(stiffness, Eigen::MatrixXcd(model.Gamma));
  std::complex<double> residual = 0.0;
  double size = 0.0;
  for (int k = 0; k <= 5; ++k) {
    const std::complex<double> power = std::pow(s, k);
    for (int i = 0; i < 2; ++i) {
      residual += relation.outputs(i, k) * power * response[i];
      size += std::abs(relation.outputs(i, k) * power * response[i]);
    }
    residual += relation.inputs(0, k) * power;
    size += std::abs(relation.inputs(0, k) * power);
  }
  EXPECT_LT(std::abs(residual), 1e-11 * size);
}

/// The largest coefficient.
double Largest(const PolynomialMatrix& polynomial) {
  double largest = 0.0;
  for (const MatrixXd& coefficient : polynomial.coefficients) {
    largest = std::max(largest, coefficient.cwiseAbs().maxCoeff());
  }
  return largest;
}

/// Relations N with N_y = `output_part` against H, relative to their size.
double Violation(const StateSpace& system, const SignalEntry& unknown,
                 const MatrixXd& output_part) {
  const PolynomialMatrix relations = CompleteRelations(system, output_part);
  const PolynomialMatrix H = MakeDae(system, unknown, NoSignal(system)).H;
  return Largest(relations * H) / (Largest(relations) * Largest(H));
}

TEST(LeftNullSpace, AnnihilatesHAtEveryDegreeAndIsAllOfIt) {
  const StateSpace system = DeltaForm(test::Stage(), test::kTiming);
  const std::vector<int> ranks = ObservabilityRanks(system, 9);
  for (int degree = 0; degree <= 9; ++degree) {
    const NullSpace null = LeftNullSpace(system, degree);
    const int expected = 2 * (degree + 1) - ranks[static_cast<std::size_t>(degree)];
    EXPECT_EQ(null.relations.rows(), expected) << degree;
    EXPECT_EQ(null.degree, degree);
    if (expected == 0) continue;
    EXPECT_LT(Violation(system, NoSignal(system), null.relations), 1e-13) << degree;
    const VectorXd singular = SingularValuesOf(null.relations);
    EXPECT_GT(singular[expected - 1], 1e-12 * singular[0]) << degree;
    // Ten decades apart from the rank tolerance is the delta form's promise.
    EXPECT_GT(null.separation, 1e-6) << degree;
  }
}

TEST(LeftNullSpace, AnnihilatesTheUnknownForceAndTheUnknownReading) {
  const MechanicalModel model = test::Stage();
  const StateSpace system = DeltaForm(model, test::kTiming);
  const SignalEntry force =
      HeldForces(model, test::kTiming, Eigen::Vector3d(1.0, 0.0, 0.0));
  SignalEntry reading = NoSignal(system);
  reading.B = MatrixXd::Zero(system.states(), 1);
  reading.D = Eigen::Vector2d(0.0, 1.0);
  for (const SignalEntry& unknown : {force, reading}) {
    int found = 0;
    for (int degree = 0; degree <= 9; ++degree) {
      const NullSpace null = LeftNullSpace(system, unknown, degree);
      EXPECT_LE(null.relations.rows(), LeftNullSpace(system, degree).relations.rows());
      if (null.relations.rows() == 0) continue;
      EXPECT_LT(Violation(system, unknown, null.relations), 1e-13) << degree;
      found = static_cast<int>(null.relations.rows());
    }
    // An unknown signal leaves one scalar relation: p^0 .. p^j times its shortest one.
    EXPECT_GT(found, 1);
    EXPECT_LT(found, 10);
  }
}

TEST(LeftNullSpace, RefusesANegativeDegree) {
  EXPECT_THROW(LeftNullSpace(DeltaForm(test::Stage(), test::kTiming), -1), InputError);
}

TEST(MinimalDegree, IsTheFirstThatTheObservabilityRanksAllow) {
  for (const MechanicalModel& model : {Chain(), test::Stage()}) {
    const StateSpace system = DeltaForm(model, test::kTiming);
    const std::vector<int> ranks = ObservabilityRanks(system, 8);
    int expected = 0;
    while (2 * (expected + 1) == ranks[static_cast<std::size_t>(expected)]) ++expected;
    EXPECT_EQ(MinimalDegree(system, NoSignal(system), 8), expected);
  }
}

TEST(MinimalDegree, SaysTheRanksWhereThereIsNone) {
  const StateSpace system = DeltaForm(test::Stage(), test::kTiming);
  SignalEntry readings;
  readings.B = MatrixXd::Zero(system.states(), 2);
  readings.D = MatrixXd::Identity(2, 2);
  const std::string message =
      test::MessageOf<InputError>([&] { (void)MinimalDegree(system, readings, 3); });
  EXPECT_EQ(message,
            "residual: no parity relation of degree 3 or less is blind to nominal "
            "motion (ranks 2 "
            "of 2, 4 of 4, 6 of 6, 8 of 8); expected a higher degree, more sensors or "
            "fewer unknown inputs");
}

TEST(CompleteRelations, SatisfyTheDivisionOfTheirOutputPart) {
  // N_x,k = sum_{i>k} N_y,i C A^(i-k-1), for any N_y.
  const StateSpace system = DeltaForm(test::Stage(), test::kTiming);
  const MatrixXd output_part = test::WhiteNoise(2, Eigen::Index{3} * 2, 1.0, 1);
  const PolynomialMatrix relations = CompleteRelations(system, output_part);
  ASSERT_EQ(relations.degree(), 2);
  const auto outputs = [&](Eigen::Index k) { return output_part.middleCols(2 * k, 2); };
  const MatrixXd first = outputs(1) * system.C + outputs(2) * system.C * system.A;
  EXPECT_TRUE(relations.coefficients[0].leftCols(6).isApprox(first, 1e-14));
  EXPECT_TRUE(
      relations.coefficients[1].leftCols(6).isApprox(outputs(2) * system.C, 1e-14));
  EXPECT_TRUE(relations.coefficients[2].leftCols(6).isZero(0.0));
  EXPECT_EQ(relations.coefficients[1].rightCols(2), outputs(1));
}

}  // namespace
}  // namespace mjdiag
