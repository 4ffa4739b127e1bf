#include "mjdiag/report/diagnosis_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/diagnosis/diagnosis_verdict.h"
#include "mjdiag/plugin/design/diagnosis.h"
#include "mjdiag/report/diagnosis_plots.h"
#include "mjdiag/report/report.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;

/// A diagnosis of the bonder over 0.3 s of its linear plant.
struct Example {
  explicit Example(double zeta_x) {
    const Machine bonder = test::Bonder();
    mjdiag::Setup setup = bonder.setup();
    setup.diagnosis.trajectories.clear();
    for (Trajectory& trajectory : setup.trajectories.all) trajectory.duration = 0.3;
    const Machine machine = bonder.WithSetup(setup);
    DiagnosisSource source;
    source.nominal.linear = true;
    const PreparedDiagnosis prepared = PrepareDiagnosis(machine, source);
    const Record record =
        SimulateLinear(machine.With({{{"zeta_x", zeta_x}}, {}}),
                       FollowTrajectory(setup, setup.trajectories.Find("multi")), {});
    design = prepared.design;
    const Diagnosis diagnosis = Diagnose(machine, prepared, record);
    log = diagnosis.log;
    result = diagnosis.result;
  }

  DiagnosisDesign design;
  MonitorLog log;
  DiagnosisResult result;
};

TEST(DiagnosisPage, SaysWhatIsWrongFirst) {
  const Example faulty(1.01);
  const std::string page = ReportHtml(
      DiagnosisPage(faulty.design, faulty.result, faulty.log, {"cmd", "r", {}}));
  EXPECT_EQ(DiagnosisVerdict(faulty.result), "Detected: zeta_x = 1.01.");
  EXPECT_LT(page.find("Detected: zeta_x"), page.find("<table"));
  EXPECT_THAT(page, HasSubstr("threshold"));
}

TEST(DiagnosisPlots, MarkTheMomentOfDetection) {
  const Example faulty(1.01);
  ASSERT_TRUE(faulty.result.first_detection.has_value());
  const TimePlot plot = ResidualPlot(faulty.result, faulty.log);
  ASSERT_FALSE(plot.marks.empty());
  EXPECT_EQ(plot.marks[0].value, *faulty.result.first_detection);
  const Example healthy(1.0);
  EXPECT_TRUE(ResidualPlot(healthy.result, healthy.log).marks.empty());
}

TEST(DiagnosisPlots, CountEverySampleOfTheResidual) {
  const Example faulty(1.01);
  const HistogramPlot plot = RunHistogram(faulty.design, faulty.result, faulty.log);
  EXPECT_EQ(plot.counts.sum(), static_cast<double>(faulty.result.samples));
}

// The verdict takes noise that is higher than the setup says into account, the bound
// does not: they agree to a few percent on this run.
TEST(DiagnosisPlots, EndTheEstimatesAndTheirBoundAtTheVerdict) {
  const Example faulty(1.01);
  const std::vector<TimePlot> plots =
      EstimatePlots(faulty.design, faulty.result, faulty.log);
  ASSERT_EQ(plots.size(), faulty.result.faults.size());
  for (std::size_t i = 0; i < plots.size(); ++i) {
    const TimePlot& plot = plots[i];
    const FaultVerdict& fault = faulty.result.faults[i];
    const Eigen::Index last = plot.curves[0].values.size() - 1;
    const double factor = plot.unit == "%" ? 1e2 : 1e6;
    EXPECT_NEAR(plot.curves[0].values[last], factor * fault.deviation,
                0.1 * factor * fault.sd)
        << fault.name;
    EXPECT_NEAR(plot.curves[1].values[last] / (1.96 * factor * fault.sd), 1.0, 0.1)
        << fault.name;
    EXPECT_EQ(plot.curves[2].values, -plot.curves[1].values);
  }
}

TEST(DiagnosisPage, SaysThatNothingIsWrong) {
  EXPECT_EQ(DiagnosisVerdict(Example(1.0).result),
            "Nothing is wrong that this run shows.");
}

}  // namespace
}  // namespace mjdiag
