#include "app/diagnosis_output.h"

#include "app/command.h"
#include "app/format.h"
#include "app/progress.h"
#include "mjdiag/diagnosis/diagnosis_verdict.h"
#include "mjdiag/report/diagnosis_page.h"

namespace mjdiag::app {
namespace {

constexpr int kMostRuns = 10000;

std::string TimeText(const std::optional<double>& time) {
  return time ? "at " + Short(*time) + " s" : "never";
}

std::string SpectrumText(const DisturbanceReport& report) {
  std::string text = "disturbance  power " + Short(report.total) + " (limit " +
                     Short(report.total_threshold) + "), noise " +
                     Short(report.noise_ratio) + " times nominal" +
                     (report.noise_raised ? ", raised" : "") + "\n";
  for (const DisturbanceTone& tone : report.tones) {
    text += "  tone at " + Short(tone.frequency) + " Hz, density " + Short(tone.psd) +
            " (limit " + Short(tone.threshold) + ")\n";
  }
  return text;
}

}  // namespace

void AddDiagnosisOptions(CLI::App& command, DiagnosisSource& source) {
  // A conversion of its own would end the path at its first space.
  command.add_option_function<std::string>(
      "--filters", [&source](const std::string& file) { source.filters = file; },
      "filters.json of `mjdiag design` instead of designing now");
  command.add_flag(
      "--baseline", source.baseline,
      "Subtract the residual that the healthy plant leaves on this motion");
  command.add_option("--robust", source.robust,
                     "Fault to be seen by the residual that nominal runs of the "
                     "nonlinear plant excite least");
  command
      .add_option("--nominal-runs", source.nominal.runs,
                  "Healthy runs a limit comes from")
      ->check(CLI::Range(2, kMostRuns));
}

PreparedDiagnosis Prepare(const Machine& machine, DiagnosisSource source,
                          const Excitation& motion) {
  ProgressBar bar("healthy runs");
  source.nominal.progress = bar.Shower();
  return PrepareDiagnosis(machine, source, motion);
}

NamedPage PageOf(const DiagnosisDesign& design, const Diagnosis& diagnosis,
                 const std::string& record) {
  const RunDescription run{CommandLine(), record, {{"mjdiag", MJDIAG_VERSION}}};
  return {"diagnosis", DiagnosisPage(design, diagnosis.result, diagnosis.log, run)};
}

std::string DiagnosisText(const DiagnosisResult& result) {
  std::string text = DiagnosisVerdict(result) + "\n\n";
  text += "residual     " + Short(result.residual.min) + " to " +
          Short(result.residual.max) + ", limits " + Short(result.limits.min) + " to " +
          Short(result.limits.max) + "; left them " + TimeText(result.first_detection) +
          ", lasting " + TimeText(result.lasting) + "\n";
  text += SpectrumText(result.disturbance) + "\n";
  // A value of 0.999998 reads as 1: what counts is how far it is from healthy.
  Table table({"fault", "value", "from healthy", "sd", "detected"});
  for (const FaultVerdict& fault : RankedFaults(result)) {
    table.Add({fault.name, Short(fault.value), Short(fault.deviation), Short(fault.sd),
               DetectionText(fault)});
  }
  text += table.ToString();
  const std::string model = ModelText(result);
  return model.empty() ? text : text + "\n" + model + "\n";
}

}  // namespace mjdiag::app
