// The EMPS stage, really measured. The data belongs to its authors and is not part of
// this repository: the folder is named by MJDIAG_EMPS_DATA, see docs/tour.md.

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "discovery/candidate_place.h"
#include "mjdiag/comparison/comparison.h"
#include "mjdiag/discovery/fitting/cause_fit.h"
#include "mjdiag/discovery/fitting/parameter_covariance.h"
#include "mjdiag/discovery/hypotheses/candidate.h"
#include "mjdiag/discovery/hypotheses/problem.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/signals/record_file.h"
#include "support/changes.h"

namespace mjdiag {
namespace {

std::filesystem::path DataFolder() {
  const char* named = std::getenv("MJDIAG_EMPS_DATA");
  return named != nullptr ? named : "";
}

double RelativeError(const Comparison& comparison, const std::string& name) {
  for (const ChannelMismatch& channel : comparison.channels) {
    if (channel.name == name) return channel.relative_error_percent;
  }
  for (const DerivedMismatch& derived : comparison.derived) {
    if (derived.name == name) return derived.relative_error_percent;
  }
  ADD_FAILURE() << "no figure for " << name;
  return 0.0;
}

class Emps : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::filesystem::exists(DataFolder() / "DATA_EMPS.mat")) return;
    ASSERT_EQ(std::getenv("CI"), nullptr) << "no EMPS data in " << DataFolder();
    GTEST_SKIP() << "no EMPS data: MJDIAG_EMPS_DATA names no folder with DATA_EMPS.mat";
  }
  /// The closed loop on the measured reference, with effects on the incomplete plant.
  static Comparison CompareWith(const std::string& file,
                                const std::vector<std::string>& effects) {
    const Machine nominal = effects.empty() ? Given() : WithAuthorsMassAndDamping();
    const Record measured = ReadRecord(DataFolder() / file, nominal.setup().record);
    return Compare(nominal.With(test::With(effects)), measured, {});
  }
  static Machine Given() { return Machine(ReadSetup(MJDIAG_SOURCE_DIR "/mjcf/emps")); }
  /// The plant has them rounded.
  static Machine WithAuthorsMassAndDamping() {
    const Machine given = Given();
    const ModelPtr plant = CopyModel(given.plant());
    plant->body_mass[FindElement(*plant, mjOBJ_BODY, "load")] = 95.1089;
    plant->dof_damping[0] = 203.5034;
    return {given.setup(), *plant};
  }
  /// The other two of the authors' symmetric model. A positive offset of theirs opposes
  /// the motor.
  static inline const std::vector<std::string> kAuthors = {
      "coulomb_friction@load:force=20.3935", "force_offset@load:force=3.1648"};
};

TEST_F(Emps, AuthorsFourParametersReachTheIndependentSimulation) {
  const Comparison comparison = CompareWith("DATA_EMPS.mat", kAuthors);
  EXPECT_LE(RelativeError(comparison, "q"), 0.0015);
  EXPECT_LE(RelativeError(comparison, "q_velocity"), 0.13);
  EXPECT_LE(RelativeError(comparison, "force"), 4.6);
}

TEST_F(Emps, AuthorsFourParametersHoldOnTheUnseenPulses) {
  const Comparison comparison = CompareWith("DATA_EMPS_PULSES.mat", kAuthors);
  EXPECT_LE(RelativeError(comparison, "q"), 0.002);
  EXPECT_LE(RelativeError(comparison, "q_velocity"), 0.20);
  EXPECT_LE(RelativeError(comparison, "force"), 5.6);
}

TEST_F(Emps, IncompletePlantIsVisiblyWorseAndSaidToBe) {
  const Comparison incomplete = CompareWith("DATA_EMPS.mat", {});
  const Comparison authors = CompareWith("DATA_EMPS.mat", kAuthors);
  EXPECT_GT(RelativeError(incomplete, "force"), 3.0 * RelativeError(authors, "force"));
  EXPECT_TRUE(incomplete.exceeds_noise());
}

// The model class of the authors' asymmetric friction, fitted to the innovations of the
// observer that discovery ends with (20 Hz): mass, Coulomb force, viscous coefficients
// of both directions and the offset that their two Coulomb forces are. Both have an
// uncertainty; theirs is printed for the symmetric model only.
TEST_F(Emps, ParametersOfTheAuthorsModelClassAreTheirsWithinJointUncertainty) {
  const Machine machine = Given();
  const mjModel& plant = machine.plant();
  const DiscoveryProblem problem = PoseProblem(
      machine, ReadRecord(DataFolder() / "DATA_EMPS.mat", machine.setup().record), 1.0,
      20.0);
  const auto candidates = ListCandidates(machine);
  const std::vector<FittedCause> start = {
      {test::Place(candidates, "coulomb_friction@load"),
       Eigen::VectorXd::Constant(1, 15.0)},
      {test::Place(candidates, "asymmetric_viscous_friction@load"),
       Eigen::Vector2d(-10.0, 10.0)},
      {test::Place(candidates, "added_mass@load"), Eigen::VectorXd::Constant(1, 0.5)},
      {test::Place(candidates, "force_offset@load"),
       Eigen::VectorXd::Constant(1, 0.1)}};
  const CauseFit fit =
      FitCauses(problem, candidates, {start}, {.iterations = 30, .tolerance = 1e-8});
  Eigen::VectorXd authors(5);
  authors << 0.5 * (20.1440 + 20.6277), 166.7061 - plant.dof_damping[0],
      240.4236 - plant.dof_damping[0],
      95.1540 - plant.body_mass[FindElement(plant, mjOBJ_BODY, "load")],
      0.5 * (20.6277 - 20.1440);
  Eigen::VectorXd sd(5);
  sd << 0.10, 1.15, 1.15, 0.11, 0.04;
  const Eigen::MatrixXd joint = ParameterCovariance(problem, candidates, fit) +
                                Eigen::MatrixXd(sd.cwiseAbs2().asDiagonal());
  const Eigen::VectorXd off = Flatten(fit.causes) - authors;
  RecordProperty("chi_squared", std::to_string(off.dot(joint.inverse() * off)));
  constexpr double kChiSquared95 = 11.07;  // five degrees of freedom
  EXPECT_LT(off.dot(joint.inverse() * off), kChiSquared95) << off.transpose();
  for (Eigen::Index i = 0; i < 5; ++i) {
    EXPECT_LT(std::abs(off[i]), 1.96 * std::sqrt(joint(i, i))) << i;
  }
}

}  // namespace
}  // namespace mjdiag
