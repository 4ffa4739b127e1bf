#include "mjdiag/report/design_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mjdiag/plugin/design/filter_design.h"
#include "mjdiag/report/report.h"
#include "support/bonder.h"

namespace mjdiag {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

ParityProgramFacts Solved() {
  ParityProgramFacts facts;
  facts.degree = 7;
  facts.norm = "one";
  facts.fault_inputs = 2;
  facts.programs = 16;
  facts.feasible = 12;
  facts.objective = 2.5;
  facts.defect = 1e-17;
  facts.angle = 2e-11;
  return facts;
}

TEST(ResidualHistogram, HasTheAreaOfItsNormalCurve) {
  // Whatever the shape of the bars.
  const Eigen::VectorXd samples = Eigen::VectorXd::LinSpaced(4001, -3.0, 3.0);
  ThresholdDesign design = ThresholdsByMargin({samples}, 2.0);
  design.fit = {0.1, 0.4};  // within the range: all but 1e-12 of it
  const HistogramPlot plot = ResidualHistogram(design);
  EXPECT_EQ(plot.counts.sum(), 4001.0);
  const XyCurve& curve = plot.curves.at(0);
  const double step = curve.x[1] - curve.x[0];
  const double width = plot.edges[1] - plot.edges[0];
  EXPECT_NEAR(curve.y.sum() * step / (width * 4001.0), 1.0, 1e-9);
  ASSERT_EQ(plot.marks.size(), 2u);
  EXPECT_DOUBLE_EQ(plot.marks[0].value, -6.0);
  EXPECT_DOUBLE_EQ(plot.marks[1].value, 6.0);
}

TEST(DesignPage, SaysWhichParityRelationsExistAndWhatIsHealthy) {
  const Machine bonder = test::Bonder();
  mjdiag::Setup setup = bonder.setup();
  setup.diagnosis.trajectories.clear();
  for (Trajectory& trajectory : setup.trajectories.all) trajectory.duration = 0.3;
  const Machine machine = bonder.WithSetup(setup);
  DiagnosisDesign design = DesignFilters(machine);
  DesignFacts facts;
  facts.minimal_degree = 6;
  facts.observability_ranks = {3, 6, 20};
  facts.states = 20;
  facts.healthy = machine.linear();
  const RunDescription run{"mjdiag design", "", {}};

  const std::string without = ReportHtml(DesignPage(design, facts, run));
  EXPECT_THAT(without, HasSubstr("from degree 6 on; the residual has degree 7."));
  EXPECT_THAT(without, HasSubstr("3, 6, 20 of 20 states"));
  EXPECT_THAT(without, Not(HasSubstr("Residual of healthy runs")));
  EXPECT_THAT(without, Not(HasSubstr("Linear programs")));
  EXPECT_THAT(without, Not(HasSubstr("lost stiffness")));

  NominalRuns nominal;
  nominal.linear = true;
  design.limits = CalibrateLimits(design, machine, nominal);
  facts.changed = {{"beta = 0.01", facts.healthy}};
  facts.linear_program = Solved();
  const std::string whole = ReportHtml(DesignPage(design, facts, run));
  EXPECT_THAT(whole, HasSubstr("and is healthy between -"));
  EXPECT_THAT(whole, HasSubstr("Residual of healthy runs"));
  EXPECT_THAT(whole, HasSubstr("Linear programs: 12 of 16"));
  EXPECT_THAT(whole, HasSubstr("beta = 0.01"));
}

TEST(DescribeParityPrograms, GivesNoFiguresOfARelationThatIsNotThere) {
  EXPECT_EQ(
      DescribeParityPrograms(Solved()),
      "Linear programs: 12 of 16 at degree 7 for 2 fault inputs have a solution; the "
      "smallest in the one-norm has size 2.50, leaves 1.0e-17 of the unknowns "
      "and lies 2.0e-11 rad from the null space of the singular value "
      "decomposition.");
  ParityProgramFacts none = Solved();
  none.feasible = 0;
  EXPECT_EQ(DescribeParityPrograms(none),
            "Linear programs: 0 of 16 at degree 7 for 2 fault inputs have a solution.");
}

}  // namespace
}  // namespace mjdiag
