#include "mjdiag/studies/detection_study.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/studies/bound_study.h"

namespace mjdiag {
namespace {

constexpr double kResolution = 1.02;
constexpr int kHealthyRuns = 20;
constexpr double kCoarseResolution = 1.15;  // a nonlinear run takes longer

std::optional<double> PublishedSize(const FaultSizes& sizes, const std::string& fault) {
  for (const auto& [name, value] : sizes.values) {
    if (name == fault) return value;
  }
  return std::nullopt;
}

Cell SizeCell(const std::optional<double>& deviation, double healthy) {
  return deviation ? Cell(healthy + *deviation) : Cell("not seen");
}

/// A deviation as people write it: +0.5 %.
Cell DeviationCell(const std::optional<double>& deviation) {
  if (!deviation) return "not seen";
  Cell cell(*deviation);
  cell.text = (*deviation > 0.0 ? "+" : "") + Cell(100.0 * *deviation).text + " %";
  return cell;
}

Cell Seen(bool seen) { return seen ? "yes" : "no"; }

/// Progress of a part of a study within the whole.
std::function<void(double)> Stage(const StudyOptions& options, double from, double to) {
  if (!options.progress) return {};
  return [&options, from, to](double fraction) {
    options.progress(from + (to - from) * fraction);
  };
}

struct LinearResult {
  Detection published;
  std::optional<double> by_residual;
  std::optional<double> by_spectrum;
  std::optional<double> by_estimate;
};

}  // namespace

std::vector<StudyTable> LinearDetectionStudy(const Machine& machine,
                                             const StudyOptions& options) {
  const Excitation motion = DefaultMotion(machine.setup());
  const PreparedDiagnosis detector = LinearDiagnosis(machine);

  const auto look = [&](const std::string& fault, double deviation,
                        std::uint64_t seed) {
    const double healthy = HealthyValue(machine.setup(), fault);
    const std::vector<SizedFault> faults{{fault, healthy + deviation}};
    const Record record = RunLinear(motion, WithFaults(machine, faults, seed));
    return Look(detector, record, fault);
  };

  const auto& largest = machine.setup().Study("largest").values;
  const FaultSizes& published = machine.setup().Study("table2");
  std::vector<LinearResult> results(largest.size());
  ParallelFor(
      static_cast<int>(largest.size()),
      [&](int i) {
        // Lambdas below capture both, which Clang 14 does not let structured bindings be.
        const std::string& fault = largest[static_cast<std::size_t>(i)].first;
        const double value = largest[static_cast<std::size_t>(i)].second;
        const double healthy = HealthyValue(machine.setup(), fault);
        LinearResult& result = results[static_cast<std::size_t>(i)];
        if (const auto size = PublishedSize(published, fault)) {
          result.published = look(fault, *size - healthy, options.seed);
        }
        const auto smallest = [&](const std::function<bool(const Detection&)>& seen) {
          return SmallestDeviation(value - healthy, kResolution, [&](double deviation) {
            return seen(look(fault, deviation, options.seed));
          });
        };
        result.by_residual =
            smallest([](const Detection& d) { return d.residual.has_value(); });
        result.by_estimate = smallest([](const Detection& d) { return d.estimate; });
        if (healthy == 0.0) {
          result.by_spectrum = smallest([](const Detection& d) { return d.spectrum; });
        }
      },
      Stage(options, 0.0, 0.5));

  const InformationBound bound = FaultBound(machine, motion);
  StudyTable table{
      "Smallest detectable faults, linear plant",
      {"fault", "published", "seen at that size", "at time [s]", "smallest by residual",
       "deviation", "smallest by estimate", "by spectrum", "bound (sd)"},
      {},
      {}};
  for (std::size_t i = 0; i < results.size(); ++i) {
    const std::string& fault = largest[i].first;
    const double healthy = HealthyValue(machine.setup(), fault);
    const auto size = PublishedSize(published, fault);
    const LinearResult& result = results[i];
    const bool any = result.published.residual || result.published.spectrum;
    table.rows.push_back(
        {fault, size ? Cell(*size) : Cell("undetectable"), size ? Seen(any) : Cell("-"),
         result.published.residual ? Cell(*result.published.residual) : Cell("-"),
         SizeCell(result.by_residual, healthy), DeviationCell(result.by_residual),
         DeviationCell(result.by_estimate),
         healthy == 0.0 ? SizeCell(result.by_spectrum, 0.0) : Cell("-"),
         Cell(bound.together[static_cast<Eigen::Index>(BoundIndex(machine, fault))])});
  }
  table.notes = {
      "The faults are there from the start: the time is the delay of detection, most "
      "of which is the wait for the first move of that axis."};

  std::vector<Detection> healthy_runs(static_cast<std::size_t>(options.runs));
  std::vector<int> estimates(static_cast<std::size_t>(options.runs));
  ParallelFor(
      options.runs,
      [&](int i) {
        const Record record = RunLinear(
            motion, WithFaults(machine, {},
                               options.seed + 10000 + static_cast<std::uint64_t>(i)));
        const DiagnosisResult result =
            Conclude(RecordDiagnosis(detector.design, record));
        auto& run = healthy_runs[static_cast<std::size_t>(i)];
        run.residual = result.first_detection;
        run.spectrum = result.disturbance.disturbed;
        estimates[static_cast<std::size_t>(i)] = static_cast<int>(
            std::count_if(result.faults.begin(), result.faults.end(),
                          [](const FaultVerdict& fault) { return fault.detected; }));
      },
      Stage(options, 0.5, 1.0));
  const auto count = [&](auto&& predicate) {
    return static_cast<double>(
        std::count_if(healthy_runs.begin(), healthy_runs.end(), predicate));
  };
  StudyTable alarms{
      "False alarms in healthy runs",
      {"runs", "by residual", "by spectrum", "by estimates"},
      {{Cell(static_cast<double>(options.runs)),
        Cell(count([](const Detection& d) { return d.residual.has_value(); })),
        Cell(count([](const Detection& d) { return d.spectrum; })),
        Cell(static_cast<double>(
            std::count_if(estimates.begin(), estimates.end(),
                          [](int detected) { return detected > 0; })))}},
      {}};
  return {table, alarms};
}

std::vector<StudyTable> NonlinearDetectionStudy(const Machine& machine,
                                                const std::string& study, bool baseline,
                                                const StudyOptions& options) {
  const Excitation motion = DefaultMotion(machine.setup());
  DiagnosisSource source;
  source.baseline = baseline;
  source.nominal.runs = 8;
  const PreparedDiagnosis common = PrepareDiagnosis(machine, source, motion);

  const auto& largest = machine.setup().Study("largest").values;
  const FaultSizes& published = machine.setup().Study(study);
  StudyTable table{
      baseline ? "Smallest detectable faults, nonlinear plant, baseline "
                 "subtracted"
               : "Smallest detectable faults, nonlinear plant",
      {"fault", "published", "seen by residual", "by robust residual", "by estimate",
       "smallest by residual", "by robust residual", "by estimate"},
      {},
      {}};
  StudyTable alarms{"False alarms in " + std::to_string(kHealthyRuns) +
                        " healthy runs of the nonlinear plant",
                    {"fault", "by residual", "by robust residual", "by estimate"},
                    {},
                    {}};
  std::vector<Record> healthy_runs(kHealthyRuns);
  ParallelFor(kHealthyRuns, [&](int i) {
    healthy_runs[static_cast<std::size_t>(i)] = RunNonlinear(
        motion,
        WithFaults(machine, {}, options.seed + 20000 + static_cast<std::uint64_t>(i)));
  });
  for (std::size_t i = 0; i < largest.size(); ++i) {
    const auto& [fault, value] = largest[i];
    const double healthy = HealthyValue(machine.setup(), fault);
    source.robust = fault;
    const PreparedDiagnosis robust = PrepareDiagnosis(machine, source, motion);
    const auto record_at = [&, &name = fault](double deviation) {
      return RunNonlinear(
          motion, WithFaults(machine, {{name, healthy + deviation}}, options.seed));
    };
    // Three ways to see it; an estimate may come from either residual.
    enum Way { kResidual, kRobust, kEstimate, kWays };
    const auto sees = [&, &name = fault](Way way, const Record& record) {
      switch (way) {
        case kResidual: {
          const Detection seen = Look(common, record, name);
          return seen.residual.has_value() || (healthy == 0.0 && seen.spectrum);
        }
        case kRobust:
          return Look(robust, record, name).residual.has_value();
        default:
          return Look(common, record, name).estimate ||
                 Look(robust, record, name).estimate;
      }
    };
    const auto size = PublishedSize(published, fault);
    std::vector<Cell> row{fault, size ? Cell(*size) : Cell("undetectable")};
    std::optional<Record> at_published;
    if (size) at_published = record_at(*size - healthy);
    for (int way = 0; way < kWays; ++way) {
      row.push_back(at_published ? Seen(sees(static_cast<Way>(way), *at_published))
                                 : Cell("-"));
    }
    std::vector<std::optional<double>> smallest(kWays);
    ParallelFor(kWays, [&, &limit = value](int way) {
      smallest[static_cast<std::size_t>(way)] =
          SmallestDeviation(limit - healthy, kCoarseResolution, [&](double deviation) {
            return sees(static_cast<Way>(way), record_at(deviation));
          });
    });
    for (const auto& deviation : smallest) row.push_back(DeviationCell(deviation));
    table.rows.push_back(std::move(row));
    std::vector<Cell> false_alarms{fault};
    for (int way = 0; way < kWays; ++way) {
      const auto count = std::count_if(
          healthy_runs.begin(), healthy_runs.end(),
          [&](const Record& run) { return sees(static_cast<Way>(way), run); });
      false_alarms.emplace_back(static_cast<double>(count));
    }
    alarms.rows.push_back(std::move(false_alarms));
    if (options.progress) {
      options.progress(static_cast<double>(i + 1) /
                       static_cast<double>(largest.size()));
    }
  }
  table.notes = {
      "The robust residual is, of all residuals of the robust degree, the one that "
      "nominal runs excite least while the fault is seen; its limits come from nominal "
      "runs, too.",
      "An estimate counts when it is outside what nominal runs of this motion gave."};
  return {table, alarms};
}

}  // namespace mjdiag
