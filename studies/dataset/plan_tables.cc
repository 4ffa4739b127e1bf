#include "mjdiag/studies/dataset/plan_tables.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "mjdiag/diagnosis/statistics/distributions.h"
#include "mjdiag/studies/count_cells.h"

namespace mjdiag {
namespace {

constexpr std::size_t kSizes = 8;        // bins of a size that is drawn
constexpr std::size_t kMostListed = 16;  // sizes that are listed as they are
constexpr std::size_t kMostDrawn = 400;  // points of a plot

/// A run with what was planned for it.
struct FinishedRun {
  PlannedRun plan;
  const RunResult* result;

  std::optional<double> ValueOf(const std::string& name) const {
    for (const DrawnAxis& drawn : plan.axes) {
      if (drawn.axis->name == name && drawn.present()) return drawn.value;
    }
    return std::nullopt;
  }
};

std::vector<FinishedRun> FinishedRuns(const PlanOutcome& outcome) {
  std::vector<FinishedRun> runs;
  for (std::size_t i = 0; i < outcome.results.size(); ++i) {
    if (outcome.results[i].diverged()) continue;
    runs.push_back({outcome.work->planner().Run(static_cast<std::int64_t>(i)),
                    &outcome.results[i]});
  }
  return runs;
}

StudyTable CaseTable(const PlanOutcome& outcome) {
  const StudyPlan& plan = outcome.work->loaded().plan;
  const bool judged = plan.keep.Diagnoses();
  StudyTable table{"Runs", {"case", "runs", "diverged"}, {}, {}};
  if (judged) {
    table.columns.insert(table.columns.end(), {"detected", "[%]", "95 % interval [%]"});
  }
  struct Count {
    int runs = 0, diverged = 0, detected = 0;
  };
  std::vector<Count> counts(plan.cases.size());
  for (std::size_t i = 0; i < outcome.results.size(); ++i) {
    const PlannedRun run = outcome.work->planner().Run(static_cast<std::int64_t>(i));
    Count& count = counts[static_cast<std::size_t>(run.in_case)];
    ++count.runs;
    count.diverged += outcome.results[i].diverged() ? 1 : 0;
    count.detected += outcome.results[i].detected ? 1 : 0;
  }
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const Count& count = counts[i];
    table.rows.push_back({plan.cases[i].name, Cell(count.runs), Cell(count.diverged)});
    if (!judged) continue;
    const int of = count.runs - count.diverged;
    table.rows.back().insert(table.rows.back().end(),
                             {Cell(count.detected), PerCent(count.detected, of),
                              IntervalCell(count.detected, of)});
  }
  if (judged) {
    table.notes.emplace_back(
        "Detected is what the diagnosis calls wrong, by its residual, an estimate or a "
        "disturbance: in healthy runs a false alarm.");
  }
  return table;
}

/// Runs of about one size.
struct SizeBin {
  double low = 0.0;
  double high = 0.0;
  int runs = 0;
  int named = 0;
  int detected = 0;
};

/// @param sizes  deviation from healthy, and the run
std::vector<SizeBin> BinSizes(std::vector<std::pair<double, const FinishedRun*>> sizes,
                              std::size_t fault) {
  std::ranges::sort(sizes, [](const auto& a, const auto& b) {
    return std::abs(a.first) < std::abs(b.first) ||
           (std::abs(a.first) == std::abs(b.first) && a.first < b.first);
  });
  std::size_t distinct = sizes.empty() ? 0 : 1;
  for (std::size_t i = 1; i < sizes.size(); ++i) {
    distinct += sizes[i].first != sizes[i - 1].first ? 1 : 0;
  }
  const bool listed = distinct <= kMostListed;
  std::vector<SizeBin> bins;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const auto& [size, run] = sizes[i];
    const bool begins = listed
                            ? i == 0 || size != sizes[i - 1].first
                            : i * kSizes / sizes.size() !=
                                  (i == 0 ? kSizes : (i - 1) * kSizes / sizes.size());
    if (begins) bins.push_back({size, size});
    SizeBin& bin = bins.back();
    bin.high = size;
    ++bin.runs;
    bin.named += run->result->faults[fault].named ? 1 : 0;
    bin.detected += run->result->detected ? 1 : 0;
  }
  return bins;
}

/// How often a fault is named, over its size.
std::optional<StudyTable> DetectionTable(const std::vector<FinishedRun>& runs,
                                         const std::string& fault, std::size_t at,
                                         double healthy) {
  std::vector<std::pair<double, const FinishedRun*>> sizes;
  for (const FinishedRun& run : runs) {
    if (const auto value = run.ValueOf(fault))
      sizes.emplace_back(*value - healthy, &run);
  }
  if (sizes.empty()) return std::nullopt;
  StudyTable table{
      "How often " + fault + " is named, over its deviation from healthy",
      {"from", "to", "runs", "named [%]", "95 % interval [%]", "anything detected [%]"},
      {},
      {"Other faults may be there as well. Intervals of Clopper and "
       "Pearson."}};
  StudyPlot plot{"Probability that " + fault + " is named",
                 "log10 of the deviation from healthy",
                 "share of runs",
                 {},
                 {}};
  for (const SizeBin& bin : BinSizes(sizes, at)) {
    table.rows.push_back(
        {Cell(bin.low), Cell(bin.high), Cell(bin.runs), PerCent(bin.named, bin.runs),
         IntervalCell(bin.named, bin.runs), PerCent(bin.detected, bin.runs)});
    const auto [low, high] = ProbabilityInterval(bin.runs, bin.named, kConfidence);
    const double size = std::sqrt(std::abs(bin.low) * std::abs(bin.high));
    plot.points.push_back(
        {std::log10(size), static_cast<double>(bin.named) / bin.runs, low, high});
  }
  std::ranges::sort(plot.points, {}, &StudyPlot::Point::x);
  table.plot = std::move(plot);
  return table;
}

std::string NamesOf(const RunResult& result, const std::vector<std::string>& faults) {
  std::string names;
  int count = 0;
  for (std::size_t i = 0; i < faults.size(); ++i) {
    if (!result.faults[i].named) continue;
    names = faults[i];
    ++count;
  }
  return count == 0 ? "nothing" : count == 1 ? names : "several";
}

std::string TruthOf(const PlannedRun& run) {
  const std::string label = run.Label();
  return label.find(" + ") == label.npos ? label : "several";
}

StudyTable ConfusionTable(const std::vector<FinishedRun>& runs,
                          const std::vector<std::string>& faults) {
  std::vector<std::string> truths;
  std::vector<std::string> names{"nothing"};
  names.insert(names.end(), faults.begin(), faults.end());
  names.emplace_back("several");
  std::map<std::pair<std::string, std::string>, int> counts;
  for (const FinishedRun& run : runs) {
    const std::string truth = TruthOf(run.plan);
    if (std::ranges::find(truths, truth) == truths.end()) truths.push_back(truth);
    ++counts[{truth, NamesOf(*run.result, faults)}];
  }
  // In the order in which columns are.
  std::ranges::stable_sort(truths, {}, [&](const std::string& truth) {
    const std::string& as_name = truth == "healthy" ? names.front() : truth;
    return std::ranges::find(names, as_name) - names.begin();
  });
  StudyTable table{"What is taken for what", {"there is"}, {}, {}};
  for (const std::string& name : names) {
    table.columns.push_back(name == "nothing" || name == "several" ? name + " named"
                                                                   : name);
  }
  for (const std::string& truth : truths) {
    std::vector<Cell> row{truth};
    for (const std::string& name : names) row.emplace_back(counts[{truth, name}]);
    table.rows.push_back(row);
  }
  table.notes.emplace_back("Runs, by what was wrong in them and what was named.");
  return table;
}

/// The errors of one fault's estimates.
struct Errors {
  std::vector<double> deviations, errors, sds;

  void Add(double deviation, double error, double sd) {
    deviations.push_back(deviation);
    errors.push_back(error);
    sds.push_back(sd);
  }
};

/// Over the standard deviations that were claimed, of runs that have the fault, with the
/// lines between which 95 of 100 lie.
StudyPlot ErrorPlot(const std::string& fault, const Errors& of) {
  const double half = TwoSidedNormalQuantile(1.0 - kConfidence);
  StudyPlot plot{
      "Errors of the estimates of " + fault + "; 95 of 100 belong between the lines",
      "log10 of the deviation from healthy",
      "error over standard deviation",
      {},
      {}};
  const std::size_t every = of.errors.size() / kMostDrawn + 1;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (std::size_t i = 0; i < of.errors.size(); i += every) {
    if (of.deviations[i] == 0.0) continue;
    const double size = std::log10(std::abs(of.deviations[i]));
    const double error = of.errors[i] / of.sds[i];
    plot.points.push_back({size, error, error, error});
    low = std::min(low, size);
    high = std::max(high, size);
  }
  constexpr double kBreak = std::numeric_limits<double>::quiet_NaN();
  plot.curve = {{low, half}, {high, half}, {high, kBreak}, {low, -half}, {high, -half}};
  return plot;
}

std::vector<StudyTable> ErrorTables(const std::vector<FinishedRun>& runs,
                                    const PlanOutcome& outcome) {
  const std::vector<std::string>& faults = outcome.work->layout().faults;
  const double half = TwoSidedNormalQuantile(1.0 - kConfidence);
  StudyTable table{"Errors of the estimates",
                   {"fault", "runs", "mean error", "rms error", "sd claimed, rms",
                    "inside 95 % interval [%]", "95 % interval of that [%]"},
                   {},
                   {"All runs, whether the fault is there or not. A disturbance is "
                    "counted where it is there: its magnitude has a floor at 0."}};
  std::vector<StudyTable> plots;
  for (std::size_t i = 0; i < faults.size(); ++i) {
    const bool disturbance =
        IsDisturbance(outcome.work->loaded().machine.setup(), faults[i]);
    const double healthy = disturbance ? 0.0 : 1.0;
    Errors errors;
    double sum = 0.0;
    double square = 0.0;
    double claimed = 0.0;
    int inside = 0;
    for (const FinishedRun& run : runs) {
      const auto truth = run.ValueOf(faults[i]);
      const KeptEstimate& said = run.result->faults[i];
      if ((disturbance && !truth) || !std::isfinite(said.value) || !(said.sd > 0.0)) {
        continue;
      }
      const double error = said.value - truth.value_or(healthy);
      errors.Add(truth.value_or(healthy) - healthy, error, said.sd);
      sum += error;
      square += error * error;
      claimed += said.sd * said.sd;
      inside += std::abs(error) <= half * said.sd ? 1 : 0;
    }
    const auto count = static_cast<int>(errors.errors.size());
    if (count == 0) continue;
    table.rows.push_back({faults[i], Cell(count), Cell(sum / count),
                          Cell(std::sqrt(square / count)),
                          Cell(std::sqrt(claimed / count)), PerCent(inside, count),
                          IntervalCell(inside, count)});
    const bool varies = std::ranges::any_of(runs, [&](const FinishedRun& run) {
      return run.ValueOf(faults[i]).has_value();
    });
    if (varies) {
      plots.push_back(
          {"Errors of " + faults[i], {}, {}, {}, ErrorPlot(faults[i], errors)});
    }
  }
  std::vector<StudyTable> tables;
  if (!table.rows.empty()) tables.push_back(std::move(table));
  for (StudyTable& plot : plots) tables.push_back(std::move(plot));
  return tables;
}

}  // namespace

std::vector<StudyTable> PlanTables(const PlanOutcome& outcome) {
  std::vector<StudyTable> tables{CaseTable(outcome)};
  if (!outcome.work->loaded().plan.keep.Diagnoses()) return tables;
  const std::vector<FinishedRun> runs = FinishedRuns(outcome);
  const std::vector<std::string>& faults = outcome.work->layout().faults;
  for (std::size_t i = 0; i < faults.size(); ++i) {
    const bool disturbance =
        IsDisturbance(outcome.work->loaded().machine.setup(), faults[i]);
    if (auto table = DetectionTable(runs, faults[i], i, disturbance ? 0.0 : 1.0)) {
      tables.push_back(std::move(*table));
    }
  }
  tables.push_back(ConfusionTable(runs, faults));
  for (StudyTable& table : ErrorTables(runs, outcome))
    tables.push_back(std::move(table));
  return tables;
}

}  // namespace mjdiag
