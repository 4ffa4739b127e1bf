#include "mjdiag/diagnosis/residuals/parity_programs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "diagnosis/five_masses.h"
#include "mjdiag/diagnosis/model/left_null_space.h"
#include "mjdiag/diagnosis/model/mechanical_model.h"
#include "mjdiag/signals/decompositions.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;
using test::kMasses;

SignalEntry None(const StateSpace& system) {
  return {MatrixXd(system.states(), 0), MatrixXd(system.outputs(), 0)};
}

SignalEntry InStates(const StateSpace& system, const MatrixXd& columns) {
  return {columns, MatrixXd::Zero(system.outputs(), columns.cols())};
}

/// [AB383], Example 4 with k = c = m = 1: a force fault on a mass on a spring.
DaeModel MassSpringDamper() {
  StateSpace system;
  system.A = (Eigen::Matrix2d() << 0.0, 1.0, -1.0, -1.0).finished();
  system.B = Eigen::Vector2d(0.0, 1.0);
  system.C = Eigen::RowVector2d(1.0, 0.0);
  system.D = MatrixXd::Zero(1, 1);
  return MakeDae(system, None(system), InStates(system, system.B));
}

/// Five masses, motors on the first and the third, a scale on each of `scales`. The unit
/// of time is `unit` times that of the fastest mode. With scales on the outer two,
/// relations exist from degree 4 on, with one, two, four and six independent ones.
StateSpace Chain(const std::vector<Index>& scales = {0, 4}, double unit = 1.0) {
  MechanicalModel model = test::FiveMasses();
  model.Gamma = MatrixXd::Zero(kMasses, 2);
  model.Gamma(0, 0) = model.Gamma(2, 1) = 1.0;
  model.b = MatrixXd::Identity(kMasses, kMasses)(Eigen::all, scales);
  return UnitMassStateSpace(model, unit * FastTimeUnit(model));
}

/// A force on mass `i` in the coordinates of Chain, in which a mass has a diagonal
/// root.
VectorXd ForceOn(Index i) { return VectorXd::Unit(2 * kMasses, kMasses + i); }

/// Forces on the first, second and last mass as the faults.
DaeModel ChainWithFaults(const StateSpace& system = Chain()) {
  MatrixXd faults(2 * kMasses, 3);
  faults << ForceOn(0), ForceOn(1), ForceOn(4);
  return MakeDae(system, None(system), InStates(system, faults));
}

RowVectorXd Coefficients(const PolynomialMatrix& relation) {
  RowVectorXd all(relation.cols() * (relation.degree() + 1));
  for (int i = 0; i <= relation.degree(); ++i) {
    all.segment(i * relation.cols(), relation.cols()) =
        relation.coefficients[static_cast<std::size_t>(i)];
  }
  return all;
}

/// Rows that span the left null space of Hbar, by a decomposition without scaling.
MatrixXd NullSpaceBasis(const DaeModel& dae, int degree) {
  const MatrixXd hbar = BarMatrix(dae.H, degree);
  const SingularValues svd = SingularValueDecomposition(hbar);
  const VectorXd& values = svd.values;
  const Index rank = (values.array() > 1e-12 * values[0]).count();
  return svd.U.rightCols(hbar.rows() - rank).transpose();
}

/// The columns of Fbar that some relation of the null space sees.
int SeenColumns(const DaeModel& dae, int degree) {
  const MatrixXd seen = NullSpaceBasis(dae, degree) * BarMatrix(dae.F, degree);
  return static_cast<int>((seen.colwise().norm().array() > 1e-11).count());
}

double Size(const RowVectorXd& nbar, RelationNorm norm) {
  return norm == RelationNorm::kOne ? nbar.lpNorm<1>() : nbar.lpNorm<Eigen::Infinity>();
}

/// The smallest vector of a null space of two dimensions, by trying every vertex: there
/// the 1-norm has one zero coefficient, and the infinity norm two of equal magnitude.
double SmallestByEnumeration(const MatrixXd& basis, const MatrixXd& fbar,
                             RelationNorm norm) {
  const MatrixXd seen = basis * fbar;
  double smallest = std::numeric_limits<double>::infinity();
  const auto attempt = [&](const Eigen::Vector2d& normal) {
    const RowVectorXd weights = Eigen::RowVector2d(-normal[1], normal[0]);
    const double size = Size(weights * basis, norm);
    const double sight = (weights * seen).lpNorm<Eigen::Infinity>();
    if (sight > 1e-11 * size) smallest = std::min(smallest, size / sight);
  };
  for (Index i = 0; i < basis.cols(); ++i) {
    if (norm == RelationNorm::kOne) attempt(basis.col(i));
    for (Index k = 0; norm == RelationNorm::kInfinity && k < i; ++k) {
      attempt(basis.col(i) + basis.col(k));
      attempt(basis.col(i) - basis.col(k));
    }
  }
  return smallest;
}

TEST(SolveParityPrograms, FindTheRelationOfExample4) {
  const DaeModel dae = MassSpringDamper();
  // N = [s + 1, 1, s^2 + s + 1]; the fault column sees N_2 = 1, so the scale is given.
  const RowVectorXd published =
      (RowVectorXd(9) << 1, 1, 1, 1, 0, 1, 0, 0, 1).finished();
  for (const RelationNorm norm : {RelationNorm::kOne, RelationNorm::kInfinity}) {
    const std::optional<ParityProgramSolution> solution =
        SolveParityPrograms(dae, 2, {norm});
    ASSERT_TRUE(solution.has_value());
    EXPECT_LT((Coefficients(solution->N) - published).norm(), 1e-13);
    EXPECT_EQ(solution->column, 0);
    EXPECT_NEAR(solution->objective, Size(published, norm), 1e-13);
    EXPECT_LT(solution->defect, 1e-15);
    EXPECT_EQ(solution->programs, 3);
    EXPECT_EQ(solution->feasible, 1);
  }
}

TEST(SolveParityPrograms, CountOneProgramForEachColumnOfFbar) {
  // m = n_f (d_F + d_N + 1), with a fault that enters through its derivative too.
  DaeModel dae = MassSpringDamper();
  EXPECT_EQ(SolveParityPrograms(dae, 4)->programs, 5);
  dae.F.coefficients.push_back(dae.F.coefficients[0]);
  EXPECT_EQ(SolveParityPrograms(dae, 4)->programs, 6);
  EXPECT_EQ(SolveParityPrograms(ChainWithFaults(), 5)->programs, 3 * 6);
}

TEST(SolveParityPrograms, AnnihilateTheUnknownsAndSeeTheFaultAtEveryDegree) {
  const DaeModel dae = ChainWithFaults();
  for (int degree = 4; degree <= 8; ++degree) {
    for (const RelationNorm norm : {RelationNorm::kOne, RelationNorm::kInfinity}) {
      const std::optional<ParityProgramSolution> solution =
          SolveParityPrograms(dae, degree, {norm});
      ASSERT_TRUE(solution.has_value()) << degree;
      ASSERT_EQ(solution->N.degree(), degree);
      const RowVectorXd nbar = Coefficients(solution->N);
      const MatrixXd hbar = BarMatrix(dae.H, degree);
      const double defect = (nbar * hbar).norm() / (nbar.norm() * hbar.norm());
      EXPECT_LT(defect, 1e-15);
      EXPECT_NEAR(solution->defect, defect, 1e-16);
      const RowVectorXd seen = nbar * BarMatrix(dae.F, degree);
      EXPECT_NEAR(seen[solution->column], 1.0, 1e-13);
      EXPECT_NEAR(seen.lpNorm<Eigen::Infinity>(), 1.0, 1e-9);
      EXPECT_NEAR(solution->objective, Size(nbar, norm), 1e-12 * solution->objective);
    }
  }
}

TEST(SolveParityPrograms, LieInTheNullSpaceOfTheDecomposition) {
  const DaeModel dae = ChainWithFaults();
  for (int degree = 4; degree <= 7; ++degree) {
    const MatrixXd basis = NullSpaceBasis(dae, degree);
    ASSERT_EQ(basis.rows(), degree == 4 ? 1 : 2 * degree - 8);
    const RowVectorXd nbar = Coefficients(SolveParityPrograms(dae, degree)->N);
    const RowVectorXd outside = nbar - (nbar * basis.transpose()) * basis;
    EXPECT_LT(outside.norm(), 1e-10 * nbar.norm()) << degree;
  }
}

TEST(SolveParityPrograms, SolveAsManyAsTheNullSpaceSees) {
  const DaeModel dae = ChainWithFaults();
  for (int degree = 4; degree <= 7; ++degree) {
    const std::optional<ParityProgramSolution> solution =
        SolveParityPrograms(dae, degree);
    EXPECT_EQ(solution->feasible, SeenColumns(dae, degree)) << degree;
    EXPECT_LT(solution->feasible, solution->programs) << degree;
  }
}

TEST(SolveParityPrograms, ReachTheSmallestSizeThatEnumerationFinds) {
  const DaeModel dae = ChainWithFaults(Chain({0, 2, 4}));
  const MatrixXd basis = NullSpaceBasis(dae, 3);
  ASSERT_EQ(basis.rows(), 2);
  const MatrixXd fbar = BarMatrix(dae.F, 3);
  const ParityProgramSolution one = *SolveParityPrograms(dae, 3);
  const ParityProgramSolution infinity =
      *SolveParityPrograms(dae, 3, {RelationNorm::kInfinity});
  EXPECT_NEAR(one.objective / SmallestByEnumeration(basis, fbar, RelationNorm::kOne),
              1.0, 1e-9);
  EXPECT_NEAR(
      infinity.objective / SmallestByEnumeration(basis, fbar, RelationNorm::kInfinity),
      1.0, 1e-9);
  // The two norms ask for different relations.
  EXPECT_GT(Size(Coefficients(infinity.N), RelationNorm::kOne), 1.1 * one.objective);
}

TEST(SolveParityPrograms, AreNotTakenInByTheToleranceOfTheSolver) {
  // In a unit of time a hundred times shorter than the fastest mode Clp meets the
  // equations with a vector, smaller by a fifth, that is not in the null space.
  const StateSpace system = Chain({0, 4}, 0.01);
  const DaeModel short_unit = ChainWithFaults(system);
  const RowVectorXd least = Coefficients(LeftNullVector(system, 4, {{1, 4, 1.0}}));
  MatrixXd basis = MatrixXd::Zero(2, least.size() / 5 * 6);  // N and p N
  basis.row(0).head(least.size()) = least;
  basis.row(1).tail(least.size()) = least;
  const ParityProgramSolution solution = *SolveParityPrograms(short_unit, 5);
  EXPECT_LT(solution.defect, 1e-15);
  EXPECT_NEAR(
      solution.objective /
          SmallestByEnumeration(basis, BarMatrix(short_unit.F, 5), RelationNorm::kOne),
      1.0, 1e-5);
  // In one a thousand times longer Clp finds relations where there are none.
  const DaeModel long_unit = ChainWithFaults(Chain({0, 4}, 1e3));
  EXPECT_EQ(SolveParityPrograms(long_unit, 3), std::nullopt);
  EXPECT_EQ(SolveParityPrograms(long_unit, 3, {RelationNorm::kInfinity}), std::nullopt);
}

TEST(SolveParityPrograms, GrowNoLargerWithTheDegree) {
  // A relation of a lower degree is one of a higher degree too.
  const DaeModel dae = ChainWithFaults();
  double last = std::numeric_limits<double>::infinity();
  for (int degree = 4; degree <= 8; ++degree) {
    const double size = SolveParityPrograms(dae, degree)->objective;
    EXPECT_LE(size, last * (1.0 + 1e-7)) << degree;
    last = size;
  }
}

TEST(SolveParityPrograms, FindNothingBelowTheLeastDegree) {
  EXPECT_EQ(SolveParityPrograms(MassSpringDamper(), 1), std::nullopt);
  EXPECT_EQ(SolveParityPrograms(ChainWithFaults(), 3), std::nullopt);
  EXPECT_NE(SolveParityPrograms(ChainWithFaults(), 4), std::nullopt);
}

TEST(SolveParityPrograms, FindNothingForAFaultThatActsAsTheUnknownsDo) {
  // F in the range of H: rank [H F] = rank H.
  DaeModel dae = ChainWithFaults();
  const PolynomialMatrix combination{{VectorXd::LinSpaced(2 * kMasses, -1.0, 2.0)}};
  dae.F = dae.H * combination;
  for (const int degree : {4, 5, 7}) {
    EXPECT_EQ(SolveParityPrograms(dae, degree), std::nullopt) << degree;
    EXPECT_EQ(SolveParityPrograms(dae, degree, {RelationNorm::kInfinity}),
              std::nullopt);
  }
}

TEST(SolveParityPrograms, FindNothingForAFaultThatNoSensorSees) {
  // A second oscillator without a sensor or a coupling, and the fault on it.
  StateSpace system;
  system.A = MatrixXd::Zero(4, 4);
  system.A.topLeftCorner(2, 2) << 0.0, 1.0, -1.0, -1.0;
  system.A.bottomRightCorner(2, 2) << 0.0, 1.0, -0.5, -0.2;
  system.B = VectorXd::Unit(4, 1);
  system.C = RowVectorXd::Unit(4, 0);
  system.D = MatrixXd::Zero(1, 1);
  const auto fault_at = [&](int state) {
    return MakeDae(system, None(system), InStates(system, VectorXd::Unit(4, state)));
  };
  EXPECT_EQ(SolveParityPrograms(fault_at(3), 4), std::nullopt);
  EXPECT_NE(SolveParityPrograms(fault_at(1), 4), std::nullopt);
}

TEST(SolveParityPrograms, AreBlindToUnknownInputs) {
  // A force d on the fourth mass that the first scale picks up as well. With one output
  // to spare there is no relation blind to it below degree 10, the number of states.
  const StateSpace system = Chain();
  SignalEntry unknown = InStates(system, ForceOn(3));
  unknown.D(0, 0) = 0.5;
  const SignalEntry fault = InStates(system, ForceOn(0));
  const DaeModel dae = MakeDae(system, unknown, fault);
  PolynomialMatrix disturbance;
  disturbance.coefficients = {dae.H.coefficients[0].rightCols(1)};
  int found = 0;
  for (int degree = 8; degree <= 12; ++degree) {
    const std::optional<ParityProgramSolution> solution =
        SolveParityPrograms(dae, degree);
    ASSERT_EQ(solution.has_value(), SeenColumns(dae, degree) > 0) << degree;
    if (!solution) continue;
    ++found;
    EXPECT_LT(solution->defect, 1e-15);
    const RowVectorXd nbar = Coefficients(solution->N);
    EXPECT_LT((nbar * BarMatrix(disturbance, degree)).norm(), 1e-13 * nbar.norm());
    // Without being told, the relation of the same degree sees d.
    const RowVectorXd untold = Coefficients(
        SolveParityPrograms(MakeDae(system, None(system), fault), degree)->N);
    EXPECT_GT((untold * BarMatrix(disturbance, degree)).norm(), 1e-4 * untold.norm());
  }
  EXPECT_EQ(found, 3);
}

TEST(SolveParityPrograms, ScaleWithTheUnitOfTheFault) {
  // Eight decades in the unit of f are eight in the size of the relation, no more.
  DaeModel dae = ChainWithFaults();
  const std::optional<ParityProgramSolution> solution = SolveParityPrograms(dae, 6);
  dae.F.coefficients[0] *= 1e8;
  const std::optional<ParityProgramSolution> small = SolveParityPrograms(dae, 6);
  EXPECT_EQ(small->column, solution->column);
  EXPECT_EQ(small->feasible, solution->feasible);
  EXPECT_LT((1e8 * Coefficients(small->N) - Coefficients(solution->N)).norm(),
            1e-10 * Coefficients(solution->N).norm());
}

TEST(SolveParityPrograms, RefuseAModelInWhichRoundingHidesTheRank) {
  const DaeModel long_unit = ChainWithFaults(Chain({0, 4}, 1e3));
  EXPECT_THROW(SolveParityPrograms(long_unit, 4), NumericalError);
}

TEST(SolveParityPrograms, RefuseWhatIsNoProblem) {
  const DaeModel dae = MassSpringDamper();
  EXPECT_THROW(SolveParityPrograms(dae, -1), InputError);
  DaeModel without_faults = dae;
  without_faults.F = {{MatrixXd(3, 0)}};
  EXPECT_THROW(SolveParityPrograms(without_faults, 2), InputError);
  DaeModel mismatched = dae;
  mismatched.F = {{MatrixXd::Ones(2, 1)}};
  EXPECT_THROW(SolveParityPrograms(mismatched, 2), InputError);
}

}  // namespace
}  // namespace mjdiag
