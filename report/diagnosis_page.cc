#include "mjdiag/report/diagnosis_page.h"

#include "mjdiag/diagnosis/diagnosis_verdict.h"
#include "mjdiag/report/diagnosis_plots.h"
#include "mjdiag/report/page/page.h"
#include "mjdiag/signals/quantity.h"

namespace mjdiag {
namespace {

std::string When(const std::optional<double>& time) {
  return time ? FormatQuantity(*time, "s") : "never";
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

void AddEstimates(Page& page, const std::vector<TimePlot>& plots) {
  if (plots.empty()) return;
  page.AddHeading("Estimates over time");
  page.AddParagraph(
      "As the recursive estimation inside the control callback has them, sample by "
      "sample. Of a healthy machine, 95 of 100 estimates stay inside the bound, which "
      "comes from the noise of the sensors and from healthy runs.");
  for (const TimePlot& plot : plots) page.AddPlot(plot);
}

}  // namespace

Table FaultTable(const DiagnosisResult& result) {
  Table table;
  table.columns = {{"Fault"},
                   {"Value", true},
                   {"From healthy", true},
                   {"Standard deviation", true},
                   {"Detected"}};
  for (const FaultVerdict& fault : RankedFaults(result)) {
    table.rows.push_back({fault.name, ParameterText(fault.value),
                          FormatNumber(fault.deviation), FormatNumber(fault.sd),
                          DetectionText(fault)});
  }
  return table;
}

Page DiagnosisPage(const DiagnosisDesign& design, const DiagnosisResult& result,
                   const MonitorLog& log, const RunDescription& run) {
  Page page("Diagnosis of " + result.setup);
  page.SetVerdict(result.detected ? Tone::kBad : Tone::kGood, DiagnosisVerdict(result));
  page.AddFacts({{"Setup", result.setup},
                 {"Record", run.record},
                 {"Length", std::to_string(result.samples) + " samples at " +
                                FormatQuantity(1.0 / result.sample_time, "Hz")},
                 {"Residual left its thresholds", When(result.first_detection)},
                 {"Lasting", When(result.lasting)},
                 {"Noise over nominal", FormatNumber(result.disturbance.noise_ratio)}});
  page.AddHeading("Faults");
  page.AddTable(FaultTable(result));
  page.AddHeading("Residual");
  page.AddParagraph(
      "In units of its own noise. A fault that lasts also lifts the mean magnitude, a "
      "passing disturbance does not.");
  page.AddPlot(ResidualPlot(result, log));
  page.AddPlot(IntegralPlot(design, result, log));
  page.AddPlot(RunHistogram(design, result, log));
  page.AddHeading("Disturbances");
  page.AddPlot(DisturbanceSpectrum(design, result));
  AddTones(page, result.disturbance);
  AddEstimates(page, EstimatePlots(design, result, log));
  page.SetRun(run);
  return page;
}

}  // namespace mjdiag
