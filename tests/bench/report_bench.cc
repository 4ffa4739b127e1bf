// What a report costs: the page of a diagnosis of a 20,000-sample run of the bonder
// (2.5 s at 8 kHz, its default motion), from what the monitor holds to the HTML file on
// disk, by way of the page's own file. Counters: seconds (median of the repetitions)
// and megabytes of report.html.

#include <benchmark/benchmark.h>

#include <filesystem>
#include <string>
#include <vector>

#include "bench/timing.h"
#include "mjdiag/plugin/design/diagnosis.h"
#include "mjdiag/plugin/runtime/simulation.h"
#include "mjdiag/report/diagnosis_page.h"
#include "mjdiag/report/page/page_file.h"
#include "mjdiag/report/report.h"
#include "support/bonder.h"
#include "support/temporary_folder.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;

void ReportOfADiagnosis(benchmark::State& state) {
  const Machine machine = test::Bonder();
  const Setup& setup = machine.setup();
  DiagnosisSource source;
  source.nominal.linear = true;
  source.nominal.runs = 2;
  const PreparedDiagnosis prepared = PrepareDiagnosis(machine, source);
  const Record record = SimulateLinear(
      machine.With({{{"zeta_x", 1.2}}, {}}),
      FollowTrajectory(setup, setup.trajectories.Find(setup.trajectories.fallback)),
      {});
  const Diagnosis diagnosis = Diagnose(machine, prepared, record);

  const test::TemporaryFolder folder;
  std::vector<double> seconds;
  for (auto _ : state) {
    const double start = ClockTime();
    WritePage(folder.path(), "diagnosis",
              DiagnosisPage(prepared.design, diagnosis.result, diagnosis.log,
                            {"cmd", "record.csv", {}}));
    WriteReport(folder.path());
    seconds.push_back(ClockTime() - start);
  }
  state.counters["samples"] = static_cast<double>(record.samples());
  state.counters["s_report"] = Median(seconds);
  state.counters["MB_report"] =
      1e-6 * static_cast<double>(fs::file_size(folder / "report.html"));
}

BENCHMARK(ReportOfADiagnosis)->Unit(benchmark::kMillisecond)->Iterations(11);

}  // namespace
}  // namespace mjdiag

BENCHMARK_MAIN();
