// Tones and noise in the disturbance residual: [AB383], section 5.6.

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/studies/answer.h"

namespace mjdiag {
namespace {

/// The disturbances of a run: "gamma = 0.01"; of one without, the name of its case.
std::string WhatOf(const StudyPlan& plan, const PlannedRun& run) {
  std::string what;
  for (const auto& [name, value] : FaultsOf(run)) {
    what += (what.empty() ? "" : ", ") + name + " = " + Cell(value).text;
  }
  return what.empty() ? plan.cases[static_cast<std::size_t>(run.in_case)].name : what;
}

/// That are there [Hz].
std::vector<double> FrequenciesOf(const Setup& setup, const PlannedRun& run) {
  std::vector<double> frequencies;
  for (const SizedFault& fault : FaultsOf(run)) {
    for (const MultisineSetup& source : setup.disturbances) {
      if (source.name != fault.name) continue;
      frequencies.insert(frequencies.end(), source.frequencies.begin(),
                         source.frequencies.end());
    }
  }
  return frequencies;
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

std::vector<StudyTable> AnswerTo(const AskDisturbances&, const LoadedPlan& loaded,
                                 const StudyOptions& options) {
  const StudyPlan& plan = loaded.plan;
  const Machine& machine = loaded.machine;
  const RunPlanner planner(plan);
  const RunMaker maker(loaded);
  const DiagnosisDesign design = DiagnosisOn(machine, plan.linear).design;
  const double cell = design.limits.disturbance.nominal.resolution();

  StudyTable table{"Disturbances and noise, " + std::to_string(plan.replications) +
                       " runs each, " + PlantName(plan.linear),
                   {"what", "tones found in", "other tones in", "noise raised in",
                    "noise ratio", "magnitude", "sd claimed", "sd found"},
                   {},
                   {"A tone counts as found within one cell of the spectrum, " +
                    Cell(cell).text + " Hz."}};
  for (const PointRuns& point : RunsByPoint(planner)) {
    const std::vector<double> frequencies =
        FrequenciesOf(machine.setup(), point.front());
    const std::vector<SizedFault> faults = FaultsOf(point.front());
    const double truth = faults.empty() ? 0.0 : faults.front().value;
    std::vector<DiagnosisResult> results(point.size());
    ParallelFor(
        static_cast<int>(point.size()),
        [&](int i) {
          const auto run = static_cast<std::size_t>(i);
          results[run] = Conclude(RecordDiagnosis(design, maker.Simulate(point[run])));
        },
        options.progress);
    std::string found;
    for (const double frequency : frequencies) {
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
            return std::none_of(frequencies.begin(), frequencies.end(),
                                [&](double frequency) {
                                  return std::abs(tone.frequency - frequency) < cell;
                                });
          });
      raised += result.disturbance.noise_raised ? 1 : 0;
      const auto runs = static_cast<double>(point.size());
      ratio += result.disturbance.noise_ratio / runs;
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
    table.rows.push_back({WhatOf(plan, point.front()), found.empty() ? "-" : found,
                          Cell(static_cast<double>(others)),
                          Cell(static_cast<double>(raised)), ratio, mean, claimed,
                          std::sqrt(square)});
  }
  return {table};
}

}  // namespace mjdiag
