#include "app/diagnosis_output.h"

#include "app/command.h"
#include "app/format.h"
#include "app/progress.h"
#include "mjdiag/plugin/design/cross_terms.h"
#include "mjdiag/plugin/design/robust_design.h"
#include "mjdiag/report/diagnosis_page.h"
#include "mjdiag/report/diagnosis_verdict.h"
#include "mjdiag/report/filters_file.h"
#include "mjdiag/signals/error.h"

namespace mjdiag::app {
namespace {

constexpr int kMostRuns = 10000;

template <typename Element>
std::vector<std::string> ChannelsOf(const std::vector<Element>& elements) {
  std::vector<std::string> channels;
  for (const Element& element : elements) channels.push_back(element.channel);
  return channels;
}

void RequireSameMachine(const std::string& file, const DiagnosisDesign& design,
                        const Setup& setup) {
  if (design.outputs != ChannelsOf(setup.channels.sensors) ||
      design.inputs != ChannelsOf(setup.channels.actuators)) {
    throw InputError(file, "its channels are not those of '" + setup.name + "'",
                     "filters designed for this setup");
  }
  if (std::abs(design.sample_time() * setup.rates.control - 1.0) > 1e-9) {
    throw InputError(
        file, "made for a tick of " + Short(design.sample_time() * 1e3) + " ms",
        "the control tick of the setup, " + Short(setup.rates.tick() * 1e3) + " ms");
  }
}

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
  command.add_option("--filters", source.filters,
                     "filters.json of `mjdiag design` instead of designing now");
  command.add_flag(
      "--baseline", source.baseline,
      "Subtract the residual that the healthy plant leaves on this motion");
  command.add_option("--robust", source.robust,
                     "Fault to be seen by the residual row that nominal runs of the "
                     "nonlinear plant excite least");
  command.add_option("--nominal-runs", source.runs, "Healthy runs a limit comes from")
      ->check(CLI::Range(2, kMostRuns));
}

ReadyDiagnosis PrepareDiagnosis(const DiagnosisSource& source, const Machine& machine,
                                const Excitation& excitation, bool linear) {
  const Setup& setup = machine.setup();
  ReadyDiagnosis ready;
  if (!source.filters.empty()) {
    ready.design = ReadFilters(source.filters);
    RequireSameMachine(source.filters, ready.design, setup);
  } else if (!source.robust.empty()) {
    ready.design = DesignRobustFilters(machine, source.robust, excitation,
                                       source.baseline);
  } else {
    ready.design = DesignFilters(machine);
  }
  ProgressBar bar("healthy runs");
  ready.runs.linear = linear;
  ready.runs.runs = source.runs;
  NominalRuns runs = ready.runs;
  runs.progress = [&bar](double fraction) { bar.Show(fraction); };
  if (source.baseline) {
    ready.baseline =
        ResidualBaseline(ready.design, machine, excitation, runs);
    runs.seed += static_cast<std::uint64_t>(source.runs);
    ready.design.limits = CalibrateLimits(ready.design, machine,
                                          excitation, ready.baseline, runs);
  } else if (!ready.design.limits.known) {
    ready.design.limits = CalibrateLimits(ready.design, machine, runs);
  }
  return ready;
}

DiagnosisResult Conclude(const ReadyDiagnosis& ready, const Machine& machine,
                         const Excitation& excitation,
                         const DiagnosisMonitor& monitor) {
  DiagnosisResult result = Conclude(ready.design, monitor);
  if (ready.baseline.size() > 0) {
    RemoveCrossTerms(
        result, ready.design, machine,
        {excitation, ready.baseline, monitor.first_regressed(), ready.runs});
  }
  return result;
}

NamedPage PageOf(const DiagnosisDesign& design, const DiagnosisMonitor& monitor,
                 const DiagnosisResult& result, const std::string& record) {
  const RunDescription run{CommandLine(), record, {{"mjdiag", MJDIAG_VERSION}}};
  return {"diagnosis", DiagnosisPage(design, result, monitor.Log(), run)};
}

std::string Describe(const DiagnosisResult& result) {
  std::string text = DiagnosisVerdict(result) + "\n\n";
  text += "residual     " + Short(result.residual.min) + " to " +
          Short(result.residual.max) + ", limits " + Short(result.limits.min) + " to " +
          Short(result.limits.max) + "; left them " + TimeText(result.first_detection) +
          ", lasting " + TimeText(result.lasting) + "\n";
  text += SpectrumText(result.disturbance) + "\n";
  // A knob of 0.999998 reads as 1: what counts is how far it is from healthy.
  Table table({"fault", "value", "from healthy", "sd", "detected"});
  for (const FaultVerdict& fault : RankedFaults(result)) {
    table.Add({fault.name, Short(fault.value), Short(fault.deviation), Short(fault.sd),
               DetectionText(fault)});
  }
  return text + table.ToString();
}

}  // namespace mjdiag::app
