#include "mjdiag/studies/disturbance_study.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/runtime/parallel.h"

namespace mjdiag {
namespace {

struct Scenario {
  std::string what;
  std::vector<SizedFault> faults;
  std::vector<double> frequencies;  ///< that are there [Hz]
  double noise = 1.0;
};

std::vector<Scenario> Scenarios(const Setup& setup) {
  std::vector<Scenario> scenarios{{"healthy", {}, {}, 1.0},
                                  {"tenfold noise", {}, {}, 10.0}};
  for (const MultisineSetup& source : setup.disturbances) {
    for (const double magnitude : {0.01, 0.001}) {
      scenarios.push_back({source.name + " = " + Cell(magnitude).text,
                           {{source.name, magnitude}},
                           source.frequencies,
                           1.0});
    }
  }
  return scenarios;
}

/// How many runs show a tone within a resolution cell of the frequency.
int Found(const std::vector<DiagnosisResult>& results, double frequency, double cell) {
  return static_cast<int>(
      std::count_if(results.begin(), results.end(), [&](const DiagnosisResult& result) {
        return std::any_of(result.disturbance.tones.begin(),
                           result.disturbance.tones.end(),
                           [&](const DisturbanceTone& tone) {
                             return std::abs(tone.frequency - frequency) < cell;
                           });
      }));
}

}  // namespace

std::vector<StudyTable> DisturbanceStudy(const Machine& machine,
                                         const StudyOptions& options) {
  const Excitation motion = DefaultMotion(machine.setup());
  const DiagnosisDesign design = LinearDiagnosis(machine).design;
  const double cell = design.limits.disturbance.nominal.resolution();

  StudyTable table{"Disturbances and noise, " + std::to_string(options.runs) +
                       " runs each, linear plant",
                   {"what", "tones found in", "other tones in", "noise raised in",
                    "noise ratio", "magnitude", "sd claimed", "sd found"},
                   {},
                   {"A tone counts as found within one cell of the spectrum, " +
                    Cell(cell).text + " Hz."}};
  for (const Scenario& scenario : Scenarios(machine.setup())) {
    std::vector<DiagnosisResult> results(static_cast<std::size_t>(options.runs));
    ParallelFor(
        options.runs,
        [&](int i) {
          FaultyMachine run = WithFaults(machine, scenario.faults,
                                         options.seed + static_cast<std::uint64_t>(i));
          run.options.noise_scale = scenario.noise;
          const Record record = RunLinear(motion, run);
          results[static_cast<std::size_t>(i)] =
              Conclude(RecordDiagnosis(design, record));
        },
        options.progress);
    std::string found;
    for (const double frequency : scenario.frequencies) {
      found += (found.empty() ? "" : ", ") + Cell(frequency).text +
               " Hz: " + std::to_string(Found(results, frequency, cell));
    }
    int others = 0;
    int raised = 0;
    double ratio = 0.0;
    double mean = 0.0;
    double square = 0.0;
    double claimed = 0.0;
    for (const DiagnosisResult& result : results) {
      const auto& tones = result.disturbance.tones;
      others +=
          std::any_of(tones.begin(), tones.end(), [&](const DisturbanceTone& tone) {
            return std::none_of(scenario.frequencies.begin(),
                                scenario.frequencies.end(), [&](double frequency) {
                                  return std::abs(tone.frequency - frequency) < cell;
                                });
          });
      raised += result.disturbance.noise_raised ? 1 : 0;
      const auto runs = static_cast<double>(options.runs);
      ratio += result.disturbance.noise_ratio / runs;
      const double truth =
          scenario.faults.empty() ? 0.0 : scenario.faults.front().value;
      for (const FaultVerdict& fault : result.faults) {
        if (machine.setup().disturbances.empty() ||
            fault.name != machine.setup().disturbances.front().name) {
          continue;
        }
        mean += fault.value / runs;
        square += (fault.value - truth) * (fault.value - truth) / runs;
        claimed += fault.sd / runs;
      }
    }
    table.rows.push_back(
        {scenario.what, found.empty() ? "-" : found, Cell(static_cast<double>(others)),
         Cell(static_cast<double>(raised)), ratio, mean, claimed, std::sqrt(square)});
  }
  return {table};
}

}  // namespace mjdiag
