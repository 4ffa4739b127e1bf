#include "mjdiag/report/design_page.h"

#include <cmath>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/report/filter_plots.h"
#include "mjdiag/report/page/page.h"
#include "mjdiag/signals/listed.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::string Number(double value) { return FormatNumber(value); }

bool HasNoise(const DiagnosisDesign& design) {
  return !design.sensor_noise.isZero(0.0);
}

std::string Ranks(const DesignFacts& facts) {
  std::string text;
  for (const int rank : facts.observability_ranks) {
    text += (text.empty() ? "" : ", ") + std::to_string(rank);
  }
  return text + " of " + std::to_string(facts.states) + " states";
}

std::string ListedOrNone(const std::vector<std::string>& names) {
  return names.empty() ? "none" : Listed(names);
}

void AddHealthyEstimates(Page& page, const DiagnosisDesign& design) {
  const std::vector<Interval>& estimates = design.limits.estimates;
  if (estimates.empty()) return;
  page.AddParagraph(
      "How far from healthy the estimates of healthy runs may be, in ppm:");
  Table table;
  table.columns = {{"Fault"}, {"From", true}, {"To", true}};
  const std::vector<std::string> names = design.FaultNames();
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    table.rows.push_back(
        {names.at(i), Number(1e6 * estimates[i].min), Number(1e6 * estimates[i].max)});
  }
  page.AddTable(table);
}

void AddFilters(Page& page, const DiagnosisDesign& design, const DesignFacts& facts) {
  page.AddHeading("What the filters let through");
  page.AddPlot(LowPassPlot(design));
  page.AddPlot(HighPassPlot(design));
  page.AddParagraph(
      HasNoise(design)
          ? "Residuals are in units of their own noise. Readings are in standard "
            "deviations of their noise, commands in SI units."
          : "No sensor of this setup has noise: residuals are in units of what noise "
            "of one SI unit on every reading would leave, readings and commands in SI "
            "units.");
  page.AddPlot(ReadingResponsePlot(design));
  page.AddPlot(CommandResponsePlot(design));
  page.AddPlot(DisturbanceResponsePlot(design));
  if (facts.changed.empty()) return;
  page.AddHeading("What lost stiffness changes");
  page.AddParagraph(
      "Difference between the responses of the worn and the healthy machine, in "
      "standard deviations of the readings per unit of every command.");
  page.AddPlot(ChangePlot(design, facts.healthy, facts.changed));
}

}  // namespace

std::string DesignVerdict(const DiagnosisDesign& design, const DesignFacts& facts) {
  std::string text =
      "Parity relations exist from degree " + std::to_string(facts.minimal_degree) +
      " on; the residual has degree " + std::to_string(design.options.residual.degree);
  if (!design.limits.known) return text + ".";
  const Interval& limits = design.limits.residual.limits;
  return text + " and is healthy between " + Number(limits.min) + " and " +
         Number(limits.max) + (HasNoise(design) ? " times its noise." : ".");
}

Table LimitTable(const DiagnosisLimits& limits) {
  Table table;
  table.columns = {{"Limit"}, {"From", true}, {"To", true}};
  table.rows = {
      {"Residual", Number(limits.residual.limits.min),
       Number(limits.residual.limits.max)},
      {"Mean of |residual|", "0", Number(limits.integral)},
      {"Peak of the disturbance spectrum", "0", Number(limits.disturbance.peak)},
      {"Power of the disturbance residual", "0", Number(limits.disturbance.total)}};
  return table;
}

std::string DescribeParityPrograms(const ParityProgramFacts& facts) {
  std::string text =
      "Linear programs: " + std::to_string(facts.feasible) + " of " +
      std::to_string(facts.programs) + " at degree " + std::to_string(facts.degree) +
      " for " + std::to_string(facts.fault_inputs) + " fault inputs have a solution";
  if (facts.feasible == 0) return text + ".";
  return text + "; the smallest in the " + facts.norm + "-norm has size " +
         FormatNumber(facts.objective) + ", leaves " + FormatNumber(facts.defect, 2) +
         " of the unknowns and lies " + FormatNumber(facts.angle, 2) +
         " rad from the null space of the singular value decomposition.";
}

HistogramPlot ResidualHistogram(const ThresholdDesign& thresholds) {
  constexpr Index kCurvePoints = 201;
  const Histogram& histogram = thresholds.histogram;
  const auto bins = static_cast<Index>(histogram.count.size());
  HistogramPlot plot;
  plot.caption = "Residual of healthy runs";
  plot.quantity = "residual";
  plot.unit = "1";
  plot.counted = "samples";
  plot.label = "healthy runs";
  plot.edges = VectorXd::Map(histogram.edges.data(), bins + 1);
  plot.counts = Eigen::Map<const Eigen::Vector<Index, Eigen::Dynamic>>(
                    histogram.count.data(), bins)
                    .cast<double>();
  const NormalFit& fit = thresholds.fit;
  const double first = plot.edges[0];
  const double last = plot.edges[bins];
  const double area = plot.counts.sum() * (last - first) / static_cast<double>(bins);
  const VectorXd x = VectorXd::LinSpaced(kCurvePoints, first, last);
  plot.curves = {{"normal distribution", CurveRole::kSimulated, x,
                  area * NormalDensity(x, fit.mean, fit.sd)}};
  plot.marks = {{thresholds.limits.min, "threshold"},
                {thresholds.limits.max, "threshold"}};
  return plot;
}

Page DesignPage(const DiagnosisDesign& design, const DesignFacts& facts,
                const RunDescription& run) {
  Page page("Diagnosis designed for " + design.setup);
  page.SetVerdict(Tone::kNeutral, DesignVerdict(design, facts));
  page.AddFacts({{"Setup", design.setup},
                 {"Faults estimated", ListedOrNone(design.FaultNames())},
                 {"Residuals", std::to_string(design.bank.residuals)},
                 {"Sampling rate", FormatQuantity(1.0 / design.sample_time(), "Hz")},
                 {"Ranks of the observability stack", Ranks(facts)}});
  if (facts.linear_program) {
    page.AddParagraph(DescribeParityPrograms(*facts.linear_program));
  }
  if (design.limits.known) {
    const ThresholdDesign& residual = design.limits.residual;
    page.AddHeading("Limits");
    page.AddTable(LimitTable(design.limits));
    page.AddParagraph("Margin of the thresholds over the extremes of healthy runs: " +
                      Number(residual.alpha) + ". Normal fit: mean " +
                      Number(residual.fit.mean) + ", standard deviation " +
                      Number(residual.fit.sd) + ".");
    page.AddPlot(ResidualHistogram(residual));
    AddHealthyEstimates(page, design);
  }
  AddFilters(page, design, facts);
  page.SetRun(run);
  return page;
}

}  // namespace mjdiag
