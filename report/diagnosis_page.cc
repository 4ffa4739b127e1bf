#include "mjdiag/report/diagnosis_page.h"

#include <array>
#include <cstdio>

#include "mjdiag/report/diagnosis_verdict.h"
#include "mjdiag/report/page.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

using Eigen::Index;

/// Of a knob, which is near 1 more often than not: 1.01, not 1.0100.
std::string KnobText(double value) {
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%.5g", value);
  return digits.data();
}

std::string When(const std::optional<double>& time) {
  return time ? FormatQuantity(*time, "s") : "never";
}

void AddFaultTable(Page& page, const DiagnosisResult& result) {
  page.AddHeading("Faults");
  Table table;
  table.columns = {{"Fault"},
                   {"Value", true},
                   {"From healthy", true},
                   {"Standard deviation", true},
                   {"Detected"}};
  for (const FaultVerdict& fault : RankedFaults(result)) {
    table.rows.push_back({fault.name, KnobText(fault.value),
                          FormatNumber(fault.deviation), FormatNumber(fault.sd),
                          fault.detected ? "yes" : "no"});
  }
  page.AddTable(table);
}

TimePlot ResidualPlot(const DiagnosisResult& result, const MonitorLog& log) {
  TimePlot plot;
  plot.caption = "Residual and its thresholds";
  plot.quantity = "residual";
  plot.unit = "1";
  plot.sample_time = result.sample_time;
  plot.curves = {{"residual", CurveRole::kMismatch, log.residual}};
  plot.levels = {{result.limits.min, "threshold"}, {result.limits.max, "threshold"}};
  return plot;
}

TimePlot IntegralPlot(const DiagnosisDesign& design, const DiagnosisResult& result,
                      const MonitorLog& log) {
  TimePlot plot;
  plot.caption = "Mean magnitude of the residual over " +
                 FormatQuantity(design.options.integral_window, "s");
  plot.quantity = "mean";
  plot.unit = "1";
  plot.sample_time = result.sample_time;
  plot.curves = {{"mean of |residual|", CurveRole::kMismatch, log.integral}};
  plot.levels = {{design.limits.integral, "threshold"}};
  plot.height = 160;
  return plot;
}

/// The running estimate of a fault, after the first tenth of the run: what comes before
/// has no data behind it and would set the scale.
TimePlot EstimatePlot(const DiagnosisDesign& design, const FaultVerdict& fault,
                      const MonitorLog& log, Index index) {
  constexpr double kPpm = 1e6;
  const Index count = log.estimates.cols();
  const Index first = count / 10;
  TimePlot plot;
  plot.caption = fault.name + ", estimate from healthy in ppm";
  plot.quantity = "ppm";
  plot.unit = "1";
  plot.start_time = log.estimate_time[first];
  plot.sample_time = design.stride * design.sample_time();
  plot.curves = {{fault.name, CurveRole::kMeasured,
                  kPpm * log.estimates.row(index).tail(count - first)}};
  plot.levels = {{kPpm * fault.deviation, "final estimate"}};
  plot.height = 160;
  return plot;
}

SpectrumPlot DisturbanceSpectrum(const DiagnosisDesign& design,
                                 const DiagnosisResult& result) {
  const Spectrum& spectrum = result.disturbance.spectrum;
  const Spectrum& nominal = design.limits.disturbance.nominal;
  SpectrumPlot plot;
  plot.caption = "Spectrum of the disturbance residual";
  plot.quantity = "residual";
  plot.unit = "1";
  plot.frequency = spectrum.frequency;
  plot.curves = {{"this run", CurveRole::kMismatch, spectrum.density.cwiseSqrt()}};
  if (nominal.density.size() == spectrum.density.size()) {
    plot.curves.push_back(
        {"healthy machine", CurveRole::kNoise, nominal.density.cwiseSqrt()});
  }
  return plot;
}

void AddTones(Page& page, const DisturbanceReport& report) {
  if (report.tones.empty()) return;
  Table table;
  table.columns = {{"Tone", true}, {"Density, 1/Hz", true}, {"Threshold, 1/Hz", true}};
  for (const DisturbanceTone& tone : report.tones) {
    table.rows.push_back({FormatQuantity(tone.frequency, "Hz"), FormatNumber(tone.psd),
                          FormatNumber(tone.threshold)});
  }
  page.AddTable(table);
}

}  // namespace

std::string DiagnosisPage(const DiagnosisDesign& design, const DiagnosisResult& result,
                          const MonitorLog& log, const RunDescription& run) {
  Page page("Diagnosis of " + result.setup);
  page.AddVerdict(result.detected ? Tone::kBad : Tone::kGood, DiagnosisVerdict(result));
  page.AddFacts({{"Setup", result.setup},
                 {"Record", run.record},
                 {"Length", std::to_string(result.samples) + " samples at " +
                                FormatQuantity(1.0 / result.sample_time, "Hz")},
                 {"Residual left its thresholds", When(result.first_detection)},
                 {"Lasting", When(result.lasting)},
                 {"Noise over nominal", FormatNumber(result.disturbance.noise_ratio)}});
  AddFaultTable(page, result);
  page.AddHeading("Residual");
  page.AddParagraph(
      "In units of its own noise. A fault that lasts also lifts the mean magnitude, a "
      "passing disturbance does not.");
  page.AddPlot(ResidualPlot(result, log));
  page.AddPlot(IntegralPlot(design, result, log));
  page.AddHeading("Disturbances");
  page.AddPlot(DisturbanceSpectrum(design, result));
  AddTones(page, result.disturbance);
  page.AddHeading("Estimates inside the control callback");
  for (std::size_t i = 0; i < result.faults.size(); ++i) {
    if (log.estimates.cols() < 20) break;
    page.AddPlot(EstimatePlot(design, result.faults[i], log, static_cast<Index>(i)));
  }
  page.AddHeading("To do it again");
  page.AddCode(run.command);
  page.AddFacts(run.versions);
  return page.Html();
}

}  // namespace mjdiag
