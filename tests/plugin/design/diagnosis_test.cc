// The whole diagnosis of the wire bonder, from its setup to the verdict, over a quarter
// of a second.

#include "mjdiag/plugin/design/diagnosis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "mjdiag/diagnosis/diagnosis_json.h"
#include "mjdiag/diagnosis/diagnosis_verdict.h"
#include "mjdiag/diagnosis/filters_file.h"
#include "mjdiag/signals/error.h"
#include "support/bonder.h"
#include "support/message_of.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using testing::HasSubstr;

struct Bench {
  explicit Bench(const std::vector<std::string>& more = {})
      : machine(MachineWith(more)),
        motion(FollowTrajectory(machine.setup(),
                                machine.setup().trajectories.Find("multi"))) {
    source.nominal.linear = true;
    source.nominal.runs = 3;
  }

  static Machine MachineWith(const std::vector<std::string>& more) {
    std::vector<std::string> overrides = {"diagnosis.thresholds.trajectories=[]",
                                          "trajectories.multi.duration=0.25"};
    overrides.insert(overrides.end(), more.begin(), more.end());
    return test::Bonder(overrides);
  }
  PreparedDiagnosis Prepared() const {
    return PrepareDiagnosis(machine, source, motion);
  }
  Record LinearRunWith(const Fault& fault) const {
    return SimulateLinear(machine.With({{fault}, {}}), motion, {});
  }

  Machine machine;
  Excitation motion;
  DiagnosisSource source;
};

TEST(Diagnose, NamesTheFaultOfARecord) {
  const Bench bonder;
  const Diagnosis diagnosis = Diagnose(bonder.machine, bonder.Prepared(),
                                       bonder.LinearRunWith({"zeta_x", 1.01}));
  EXPECT_EQ(DiagnosisVerdict(diagnosis.result), "Detected: zeta_x = 1.01.");
  EXPECT_EQ(diagnosis.log.residual.size(), diagnosis.result.samples);
}

TEST(Diagnose, FindsNothingInAHealthyRun) {
  const Bench bonder;
  const Diagnosis diagnosis =
      Diagnose(bonder.machine, bonder.Prepared(), bonder.LinearRunWith({"eta_z", 1.0}));
  EXPECT_EQ(DiagnosisVerdict(diagnosis.result),
            "Nothing is wrong that this run shows.");
}

TEST(DiagnoseRun, GivesInsideTheCallbackTheBitsOfTheRecord) {
  const Bench bonder;
  const PreparedDiagnosis prepared = bonder.Prepared();
  const DiagnosedRun run =
      DiagnoseRun(bonder.machine, prepared, bonder.motion, {{{"eta_z", 0.999}}, {}});
  const Diagnosis offline = Diagnose(bonder.machine, prepared, run.record);
  EXPECT_EQ(run.diagnosis.log.residual, offline.log.residual);
  EXPECT_EQ(DiagnosisJson(run.diagnosis.result), DiagnosisJson(offline.result));
  EXPECT_TRUE(run.diagnosis.result.detected);
}

TEST(Diagnose, IsExactForLargeFaults) {
  const Bench bonder;
  const Diagnosis diagnosis = Diagnose(bonder.machine, bonder.Prepared(),
                                       bonder.LinearRunWith({"zeta_x", 3.0}));
  const FaultVerdict& fault = diagnosis.result.faults[0];
  ASSERT_EQ(fault.name, "zeta_x");
  EXPECT_LT(std::abs(fault.value - 3.0), 5.0 * fault.sd);
  EXPECT_LT(fault.sd, 1e-4);
  EXPECT_EQ(DiagnosisVerdict(diagnosis.result), "Detected: zeta_x = 3.");
}

// Dry friction is unknown beside the faults, and nothing is subtracted.
TEST(Diagnose, NamesTheFaultsOfTheNonlinearMachineAndNothingElse) {
  const Machine machine = test::Bonder({"trajectories.multi.duration=0.8"});
  const PreparedDiagnosis prepared = PrepareDiagnosis(machine);
  Excitation motion = DefaultMotion(machine.setup());
  const DiagnosedRun run =
      DiagnoseRun(machine, prepared, motion,
                  {{{"zeta_x", 1.001}, {"beta_y", 0.98}, {"eta_z", 0.7}}, {}});
  const DiagnosisResult& result = run.diagnosis.result;
  EXPECT_TRUE(result.by_twin);
  EXPECT_LT(result.nis, 2.0);
  for (const FaultVerdict& fault : result.faults) {
    const double truth = fault.name == "zeta_x"   ? 0.001
                         : fault.name == "beta_y" ? -0.02
                         : fault.name == "eta_z"  ? -0.3
                                                  : 0.0;
    EXPECT_EQ(fault.detected, truth != 0.0) << fault.name;
    if (fault.name == "gamma") continue;  // not negative
    EXPECT_NEAR(fault.deviation, truth, 5.0 * fault.sd) << fault.name;
  }
}

TEST(Diagnose, NamesAFaultThatAppearsInTheCourseOfARun) {
  const Machine machine = test::Bonder();
  DiagnosisSource source;
  source.nominal.linear = true;
  source.nominal.runs = 3;
  RunOptions options;
  options.late_faults = {{{"eta_x", 0.7}, 0.83}};
  const Record record =
      SimulateLinear(machine, DefaultMotion(machine.setup()), options);
  const Diagnosis diagnosis =
      Diagnose(machine, PrepareDiagnosis(machine, source), record);
  EXPECT_LT(diagnosis.result.nis, 2.0);
  for (const FaultVerdict& fault : diagnosis.result.faults) {
    EXPECT_EQ(fault.detected, fault.name == "eta_x") << fault.name;
    if (fault.name != "eta_x") continue;
    EXPECT_NEAR(fault.value, 0.7, 5.0 * fault.sd);
  }
}

// There it could as well be a bad estimate of a machine that was faulty from the start.
TEST(Diagnose, NamesAFaultThatAppearsATenthOfASecondAfterTheStart) {
  const Machine machine = test::Bonder();
  RunOptions options;
  options.late_faults = {{{"eta_x", 0.7}, 0.1}};
  const Record record = Simulate(machine, DefaultMotion(machine.setup()), options);
  const Diagnosis diagnosis = Diagnose(machine, PrepareDiagnosis(machine), record);
  EXPECT_LT(diagnosis.result.nis, 2.0);
  for (const FaultVerdict& fault : diagnosis.result.faults) {
    EXPECT_EQ(fault.detected, fault.name == "eta_x") << fault.name;
    if (fault.name != "eta_x") continue;
    EXPECT_NEAR(fault.value, 0.7, 5.0 * fault.sd);
  }
}

// A resonance that rings a thousand times longer is told by no first order of nominal.
TEST(Diagnose, NamesWhatIsOrdersOfMagnitudeOff) {
  const Machine machine = test::Bonder();
  DiagnosisSource source;
  source.nominal.linear = true;
  source.nominal.runs = 3;
  const PreparedDiagnosis prepared = PrepareDiagnosis(machine, source);
  using Faults = std::vector<Fault>;
  for (const Faults& faults : {Faults{{"beta_y", 0.001}}, Faults{{"beta_x", 0.001}},
                               Faults{{"beta_y", 0.0001}}, Faults{{"beta_y", 0.03}},
                               Faults{{"beta_x", 0.003}, {"beta_y", 0.001}},
                               Faults{{"beta_y", 0.002}, {"zeta_x", 1.2}}}) {
    const Record record =
        SimulateLinear(machine.With({faults, {}}), DefaultMotion(machine.setup()), {});
    const DiagnosisResult result = Diagnose(machine, prepared, record).result;
    EXPECT_LT(result.nis, 2.0);
    for (const FaultVerdict& fault : result.faults) {
      const auto truth = std::ranges::find(faults, fault.name, &Fault::name);
      EXPECT_EQ(fault.detected, truth != faults.end()) << fault.name;
      if (truth == faults.end()) continue;
      EXPECT_NEAR(fault.value, truth->value, 5.0 * fault.sd);
      EXPECT_LT(fault.sd, 1e-3 * truth->value);
    }
  }
}

// It shows as soon as a start in motion would, and is a machine at rest all the same.
TEST(Diagnose, NamesADamperOfTheNonlinearMachineThatIsGone) {
  const Machine machine = test::Bonder({"trajectories.multi.duration=0.6"});
  const Record record = Simulate(machine.With({{{"beta_y", 0.01}}, {}}),
                                 DefaultMotion(machine.setup()), {});
  const DiagnosisResult result =
      Diagnose(machine, PrepareDiagnosis(machine), record).result;
  EXPECT_LT(result.nis, 2.0);
  for (const FaultVerdict& fault : result.faults) {
    EXPECT_EQ(fault.detected, fault.name == "beta_y") << fault.name;
    if (fault.name != "beta_y") continue;
    EXPECT_NEAR(fault.value, 0.01, 5.0 * fault.sd);
  }
}

// A quarter of a second into the motion nothing is at rest.
TEST(Diagnose, NamesAFaultOfTheNonlinearMachineInMidMotion) {
  const Machine machine = test::Bonder();
  const PreparedDiagnosis prepared = PrepareDiagnosis(machine);
  const Record whole = Simulate(machine.With({{{"eta_x", 0.999}}, {}}),
                                DefaultMotion(machine.setup()), {});
  const Record record = whole.Slice(2001, whole.samples() - 2001);
  const DiagnosisResult result = Diagnose(machine, prepared, record).result;
  EXPECT_LT(result.nis, 2.0);
  for (const FaultVerdict& fault : result.faults) {
    EXPECT_EQ(fault.detected, fault.name == "eta_x") << fault.name;
    if (fault.name != "eta_x") continue;
    EXPECT_NEAR(fault.value, 0.999, 5.0 * fault.sd);
  }
}

TEST(Diagnose, RegressesTheHorizonOnly) {
  const Record record = Bench().LinearRunWith({"zeta_x", 1.01});
  const Bench bonder({"diagnosis.estimation.horizon=0.1"});
  const Diagnosis diagnosis = Diagnose(bonder.machine, bonder.Prepared(), record);
  EXPECT_NEAR(diagnosis.log.estimate_time[0], 0.15, 1e-9);
  EXPECT_EQ(diagnosis.log.residual.size(), record.samples());
  const Bench longer({"diagnosis.estimation.horizon=0.3"});
  EXPECT_THAT(test::MessageOf<InputError>(
                  [&] { Diagnose(longer.machine, longer.Prepared(), record); }),
              HasSubstr("horizon: 300 ms; expected no more than the record's 250 ms"));
}

TEST(PrepareDiagnosis, TakesFiltersAndLimitsFromAFile) {
  const Bench bonder;
  const PreparedDiagnosis designed = bonder.Prepared();
  const test::TemporaryFolder folder;
  WriteFilters(folder / "filters.json", designed.design);
  DiagnosisSource source;
  source.filters = folder / "filters.json";
  const PreparedDiagnosis read = PrepareDiagnosis(bonder.machine, source);
  EXPECT_EQ(FiltersJson(read.design), FiltersJson(designed.design));
}

TEST(PrepareDiagnosis, RefusesFiltersOfAnotherMachine) {
  const Bench bonder;
  DiagnosisDesign design = DesignFilters(bonder.machine);
  const test::TemporaryFolder folder;
  DiagnosisSource source;
  source.filters = folder / "filters.json";
  const auto message = [&] {
    WriteFilters(source.filters, design);
    return test::MessageOf<InputError>(
        [&] { PrepareDiagnosis(bonder.machine, source); });
  };
  design.bank.filters.sample_time *= 2.0;
  EXPECT_THAT(message(), HasSubstr("made for a tick of 250 µs; expected the control "
                                   "tick of the setup, 125 µs"));
  design.outputs[0] = "w";
  EXPECT_THAT(message(),
              HasSubstr("its channels are not those of 'AB383 wire bonder'"));
}

TEST(PrepareDiagnosis, AsksForTheMotionOfABaselineAndOfARobustResidual) {
  DiagnosisSource source;
  EXPECT_FALSE(NeedsMotion(source));
  source.baseline = true;
  EXPECT_TRUE(NeedsMotion(source));
  source = {};
  source.robust = "zeta_x";
  EXPECT_TRUE(NeedsMotion(source));
}

}  // namespace
}  // namespace mjdiag
