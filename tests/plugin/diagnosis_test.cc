// The whole diagnosis of the wire bonder, from its setup to the verdict, over a quarter
// of a second.

#include "mjdiag/plugin/design/diagnosis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/diagnosis/diagnosis_json.h"
#include "mjdiag/diagnosis/diagnosis_verdict.h"
#include "mjdiag/diagnosis/filters_file.h"
#include "mjdiag/signals/error.h"
#include "support/message_of.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using testing::HasSubstr;

struct Bonder {
  explicit Bonder(const std::vector<std::string>& more = {})
      : setup(SetupWith(more)),
        plant(LoadPlant(setup)),
        motion(FollowTrajectory(setup, setup.trajectories.Find("multi"))) {
    source.nominal.linear = true;
    source.nominal.runs = 3;
  }

  static mjdiag::Setup SetupWith(const std::vector<std::string>& more) {
    std::vector<std::string> overrides = {"diagnosis.thresholds.trajectories=[]",
                                          "trajectories.multi.duration=0.25"};
    overrides.insert(overrides.end(), more.begin(), more.end());
    return ReadSetup(std::string(MJDIAG_SOURCE_DIR) + "/mjcf/ab383", overrides);
  }
  PreparedDiagnosis Prepared() const {
    return PrepareDiagnosis(setup, *plant, source, motion);
  }
  Record LinearRunWith(const Fault& fault) const {
    RunOptions options;
    options.faults = {fault};
    return SimulateLinear(setup, *plant, motion, options);
  }

  mjdiag::Setup setup;
  ModelPtr plant;
  Excitation motion;
  DiagnosisSource source;
};

TEST(Diagnose, NamesTheFaultOfARecord) {
  const Bonder bonder;
  const Diagnosis diagnosis = Diagnose(bonder.setup, *bonder.plant, bonder.Prepared(),
                                       bonder.LinearRunWith({"zeta_x", 1.01}));
  EXPECT_EQ(DiagnosisVerdict(diagnosis.result), "Detected: zeta_x = 1.01.");
  EXPECT_EQ(diagnosis.log.residual.size(), diagnosis.result.samples);
}

TEST(Diagnose, FindsNothingInAHealthyRun) {
  const Bonder bonder;
  const Diagnosis diagnosis = Diagnose(bonder.setup, *bonder.plant, bonder.Prepared(),
                                       bonder.LinearRunWith({"eta_z", 1.0}));
  EXPECT_EQ(DiagnosisVerdict(diagnosis.result),
            "Nothing is wrong that this run shows.");
}

TEST(DiagnoseRun, GivesInsideTheCallbackTheBitsOfTheRecord) {
  const Bonder bonder;
  const PreparedDiagnosis prepared = bonder.Prepared();
  RunOptions options;
  options.faults = {{"eta_z", 0.999}};
  const DiagnosedRun run =
      DiagnoseRun(bonder.setup, *bonder.plant, prepared, bonder.motion, options);
  const Diagnosis offline = Diagnose(bonder.setup, *bonder.plant, prepared, run.record);
  EXPECT_EQ(run.diagnosis.log.residual, offline.log.residual);
  EXPECT_EQ(DiagnosisJson(run.diagnosis.result), DiagnosisJson(offline.result));
  EXPECT_TRUE(run.diagnosis.result.detected);
}

// Prefilters about the healthy machine are off by the square of a fault.
TEST(Diagnose, RefinesLargeFaultsIfAskedTo) {
  const Bonder bonder;
  const PreparedDiagnosis prepared = bonder.Prepared();
  const Record record = bonder.LinearRunWith({"zeta_x", 3.0});
  ASSERT_EQ(prepared.design.bank.faults[0], "zeta_x");
  // Error in standard deviations.
  const auto error = [&](EstimateMethod method) {
    const Diagnosis diagnosis =
        Diagnose(bonder.setup, *bonder.plant, prepared, record, method);
    const FaultVerdict& fault = diagnosis.result.faults[0];
    return std::abs(fault.value - 3.0) / fault.sd;
  };
  EXPECT_GT(error(EstimateMethod::kLinear), 20.0);
  EXPECT_LT(error(EstimateMethod::kRefined), 5.0);
}

TEST(Diagnose, RegressesTheHorizonOnly) {
  const Record record = Bonder().LinearRunWith({"zeta_x", 1.01});
  const Bonder bonder({"diagnosis.estimation.horizon=0.1"});
  const Diagnosis diagnosis =
      Diagnose(bonder.setup, *bonder.plant, bonder.Prepared(), record);
  EXPECT_NEAR(diagnosis.log.estimate_time[0], 0.15, 1e-9);
  EXPECT_EQ(diagnosis.log.residual.size(), record.samples());
  const Bonder longer({"diagnosis.estimation.horizon=0.3"});
  EXPECT_THAT(test::MessageOf<InputError>([&] {
                Diagnose(longer.setup, *longer.plant, longer.Prepared(), record);
              }),
              HasSubstr("horizon: 300 ms; expected no more than the record's 250 ms"));
}

TEST(PrepareDiagnosis, TakesFiltersAndLimitsFromAFile) {
  const Bonder bonder;
  const PreparedDiagnosis designed = bonder.Prepared();
  const test::TemporaryFolder folder;
  WriteFilters(folder / "filters.json", designed.design);
  DiagnosisSource source;
  source.filters = folder / "filters.json";
  const PreparedDiagnosis read = PrepareDiagnosis(bonder.setup, *bonder.plant, source);
  EXPECT_EQ(FiltersJson(read.design), FiltersJson(designed.design));
}

TEST(PrepareDiagnosis, RefusesFiltersOfAnotherMachine) {
  const Bonder bonder;
  DiagnosisDesign design = DesignFilters(bonder.setup, *bonder.plant);
  const test::TemporaryFolder folder;
  DiagnosisSource source;
  source.filters = folder / "filters.json";
  const auto message = [&] {
    WriteFilters(source.filters, design);
    return test::MessageOf<InputError>(
        [&] { PrepareDiagnosis(bonder.setup, *bonder.plant, source); });
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
  Bonder bonder;
  bonder.source.baseline = true;
  const PreparedDiagnosis prepared = bonder.Prepared();
  EXPECT_EQ(prepared.baseline.cols(), bonder.motion.samples());
  EXPECT_THROW(
      Diagnose(bonder.setup, *bonder.plant, prepared,
               bonder.LinearRunWith({"zeta_x", 1.01}), EstimateMethod::kRefined),
      InputError);
}

}  // namespace
}  // namespace mjdiag
