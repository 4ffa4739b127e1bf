// The residual of the wire bonder with friction in its guides, over a quarter of a
// second.

#include "mjdiag/plugin/design/robust_design.h"

#include <gtest/gtest.h>

#include "mjdiag/diagnosis/diagnosis_recording.h"
#include "mjdiag/plugin/design/filter_design.h"
#include "mjdiag/signals/error.h"
#include "support/bonder.h"
#include "support/message_of.h"

namespace mjdiag {
namespace {

using Eigen::VectorXd;

class RobustDesign : public testing::Test {
 protected:
  RobustDesign()
      : machine_(test::Bonder(
            {"diagnosis.robust.runs=3", "trajectories.multi.duration=0.25"})),
        motion_(FollowTrajectory(setup_, setup_.trajectories.Find("multi"))) {}

  DiagnosisDesign Robust(const std::string& fault, bool baseline = false) const {
    return DesignRobustFilters(machine_, fault, motion_, baseline);
  }
  /// Of a run of the nonlinear plant in noise that the design has not seen.
  VectorXd Residual(const DiagnosisDesign& design,
                    const std::vector<Fault>& faults = {}) const {
    RunOptions options;
    options.seed = 7;
    const Record record = Simulate(machine_.With({faults, {}}), motion_, options);
    return RecordDiagnosis(design, record).recorder.Log().residual;
  }

  Machine machine_;
  const mjdiag::Setup& setup_ = machine_.setup();
  Excitation motion_;
};

TEST_F(RobustDesign, SeesItsFaultBetterAboveWhatHealthyRunsLeave) {
  const Fault worn{"zeta_x", 1.3};
  // What the fault adds, over what is there without it: noise is the same in both.
  const auto contrast = [&](const DiagnosisDesign& design) {
    const VectorXd healthy = Residual(design);
    return (Residual(design, {worn}) - healthy).norm() / healthy.norm();
  };
  const double common = contrast(DesignFilters(machine_));
  const double robust = contrast(Robust(worn.name));
  EXPECT_GT(robust, 1.5 * common);
}

TEST_F(RobustDesign, IsExcitedLessByAHealthyMachineWithFriction) {
  // Both residuals have unit noise, so they compare as they are.
  const double common = Residual(DesignFilters(machine_)).norm();
  EXPECT_LT(Residual(Robust("zeta_x")).norm(), 0.5 * common);
}

TEST_F(RobustDesign, HasOneResidualOfItsOwnDegreeAndPrefiltersForAllFaults) {
  const DiagnosisDesign design = Robust("eta_y");
  EXPECT_EQ(design.bank.residuals, 1);
  EXPECT_EQ(design.options.estimation_residuals, 1);
  EXPECT_EQ(design.options.residual.degree, setup_.diagnosis.robust.residual.degree);
  EXPECT_EQ(design.bank.relations.size(), design.options.residual.degree + 1);
  EXPECT_EQ(design.bank.filters.outputs(), 1 + design.bank.faults.size());
}

TEST_F(RobustDesign, IsBlindToNominalMotionOfTheLinearPlant) {
  const DiagnosisDesign design = Robust("zeta_x");
  const Eigen::MatrixXd outputs =
      FilterSignals(design.bank.filters, Signals(design, LinearRun(machine_)));
  EXPECT_LT(outputs.row(0).cwiseAbs().maxCoeff(), 0.3);
  EXPECT_GT(outputs.bottomRows(7).rowwise().norm().minCoeff(), 1.0);
}

// Against a baseline what every run leaves alike costs nothing: another is best.
TEST_F(RobustDesign, DependsOnWhetherABaselineIsSubtracted) {
  EXPECT_NE(Robust("zeta_x", true).bank.relations[0],
            Robust("zeta_x", false).bank.relations[0]);
}

TEST_F(RobustDesign, SeesADisturbanceOfTheSetupToo) {
  const std::string name = setup_.disturbances.at(0).name;
  EXPECT_EQ(Robust(name).bank.residuals, 1);
}

TEST_F(RobustDesign, NamesTheFaultsThatThereAre) {
  EXPECT_EQ(
      test::MessageOf<InputError>([&] { Robust("zeta_q"); }),
      "robust residual: there is no fault 'zeta_q'; expected one of zeta_x, zeta_y, "
      "beta_x, beta_y, eta_x, eta_y, eta_z, gamma");
}

}  // namespace
}  // namespace mjdiag
