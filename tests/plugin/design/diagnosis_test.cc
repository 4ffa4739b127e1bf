// The whole diagnosis of the wire bonder, from its setup to the verdict, over a quarter
// of a second.

#include "mjdiag/plugin/design/diagnosis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

// Prefilters about the healthy machine are off by the square of a fault.
TEST(Diagnose, RefinesLargeFaultsIfAskedTo) {
  const Bench bonder;
  const PreparedDiagnosis prepared = bonder.Prepared();
  const Record record = bonder.LinearRunWith({"zeta_x", 3.0});
  ASSERT_EQ(prepared.design.bank.faults[0], "zeta_x");
  // Error in standard deviations.
  const auto error = [&](EstimateMethod method) {
    const Diagnosis diagnosis = Diagnose(bonder.machine, prepared, record, method);
    const FaultVerdict& fault = diagnosis.result.faults[0];
    return std::abs(fault.value - 3.0) / fault.sd;
  };
  EXPECT_GT(error(EstimateMethod::kLinear), 20.0);
  EXPECT_LT(error(EstimateMethod::kRefined), 5.0);
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

TEST(Diagnose, RefusesToRefineAgainstABaseline) {
  Bench bonder;
  bonder.source.baseline = true;
  const PreparedDiagnosis prepared = bonder.Prepared();
  EXPECT_EQ(prepared.baseline.cols(), bonder.motion.samples());
  EXPECT_THROW(
      Diagnose(bonder.machine, prepared, bonder.LinearRunWith({"zeta_x", 1.01}),
               EstimateMethod::kRefined),
      InputError);
}

}  // namespace
}  // namespace mjdiag
