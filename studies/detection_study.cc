#include "mjdiag/studies/detection_study.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>

#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/studies/bound_study.h"
#include "mjdiag/studies/count_cells.h"
#include "mjdiag/studies/detector.h"
#include "mjdiag/studies/looked_at_runs.h"
#include "mjdiag/studies/run_bound.h"
#include "mjdiag/studies/seen_size.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kSeeds = 40;
constexpr double kResolution = 1.1;
constexpr double kCoarseResolution = 1.2;  // a nonlinear run takes longer
/// Seeds of healthy runs are others than those of faulty ones.
constexpr std::uint64_t kHealthySeeds = 10000;
/// A fault of so many standard deviations of its bound is about to be seen.
constexpr double kAboutSeen = 6.0;

constexpr const char* kTwinSees =
    "The twin sees a fault that it names, and no other beside it.";

/// What is looked for, and by whom.
struct Plan {
  const Machine& machine;
  Excitation motion;
  bool linear;
  std::string study;  ///< [studies.<study>]: sizes of the thesis
  SeedsOfASize seeds;
  std::vector<Detector> detectors;
  VectorXd bound;  ///< of the healthy machine, standard deviations

  Record Run(const std::vector<SizedFault>& faults, std::uint64_t seed) const {
    const FaultyMachine faulty = WithFaults(machine, faults, seed);
    return RunOf(motion, faulty, linear);
  }
};

std::optional<double> PublishedDeviation(const Machine& machine,
                                         const FaultSizes& sizes,
                                         const std::string& fault) {
  for (const auto& [name, value] : sizes.values) {
    if (name == fault) return value - HealthyValue(machine.setup(), fault);
  }
  return std::nullopt;
}

/// A deviation as people write it: +0.5 %; of a disturbance its magnitude.
Cell DeviationCell(const Setup& setup, const std::string& fault, double deviation) {
  Cell cell(deviation);
  if (IsDisturbance(setup, fault)) return cell;
  cell.text = (deviation > 0.0 ? "+" : "") + Cell(100.0 * deviation).text + " %";
  return cell;
}

StudyTable EmptySizes(const Plan& plan, const std::string& title) {
  return {
      title,
      {"fault", "seen by", "thesis", "seen there [%]", "95 % see", "seen there [%]",
       "at half of it [%]", "times better than the thesis", "over the bound"},
      {},
      {"Seen by " + std::to_string(plan.seeds.count) +
           " seeds a size; a size that 95 % see is accurate to " +
           Cell(100.0 * ((plan.linear ? kResolution : kCoarseResolution) - 1.0)).text +
           " %.",
       "The bound is the standard deviation that no estimate can be better than, all "
       "faults" +
           std::string(plan.linear ? "" : ", dry friction") +
           " and phases of disturbances unknown. That of a fault that is known to be "
           "alone is lower."}};
}

/// A way of seeing that fault, and the runs that it looks at.
struct Sight {
  const Detector& detector;
  SeesFault sees;
};

/// Looking at a run takes a twin longer than making it: what it sees is asked only where
/// that is wanted. The others share runs.
std::vector<Sight> SightsOf(const Plan& plan, const std::string& fault) {
  const double healthy = HealthyValue(plan.machine.setup(), fault);
  const auto run = [&plan, fault, healthy](double deviation, std::uint64_t seed) {
    return plan.Run({{fault, healthy + deviation}}, seed);
  };
  const auto look = [&fault](const Detector& detector) -> LookedAtRuns::Sees {
    return [&detector, fault](const Record& record) {
      return detector.sees(record, fault);
    };
  };
  std::vector<Sight> sights;
  std::vector<LookedAtRuns::Sees> shared;
  for (const Detector& detector : plan.detectors) {
    if (detector.meant_for && !detector.meant_for(fault)) continue;
    sights.push_back({detector, {}});
    if (!detector.at_bound) shared.push_back(look(detector));
  }
  const auto common = std::make_shared<LookedAtRuns>(run, shared);
  std::size_t next = 0;
  for (Sight& sight : sights) {
    const bool own = sight.detector.at_bound;
    const auto runs =
        own ? std::make_shared<LookedAtRuns>(run, std::vector{look(sight.detector)})
            : common;
    sight.sees = [runs, way = own ? 0 : next++](double deviation, std::uint64_t seed) {
      return runs->SeenBy(way, deviation, seed);
    };
  }
  return sights;
}

/// How one detector sees one fault.
/// @param published  the size of the thesis, if it has one
std::vector<Cell> RowOf(const Plan& plan, const Sight& sight, const std::string& fault,
                        double largest, std::optional<double> published) {
  const auto& [detector, sees] = sight;
  const Setup& setup = plan.machine.setup();
  const double sd = plan.bound[BoundIndex(plan.machine, fault)];
  std::optional<double> guess;
  if (detector.at_bound) guess = std::copysign(kAboutSeen * sd, largest);
  const SizeGrid grid(largest, plan.linear ? kResolution : kCoarseResolution);
  const auto seen = SurelySeenSize(grid, guess, plan.seeds, sees);
  const int seeds = plan.seeds.count;
  std::vector<Cell> row{
      fault, detector.name,
      published ? DeviationCell(setup, fault, *published) : Cell("undetectable"),
      published ? PerCent(CountSeen(*published, plan.seeds, sees), seeds) : Cell("-")};
  if (!seen) {
    row.insert(row.end(), {"nothing", "-", "-", "-", "-"});
    return row;
  }
  row.insert(row.end(),
             {DeviationCell(setup, fault, seen->deviation), PerCent(seen->seeds, seeds),
              PerCent(CountSeen(0.5 * seen->deviation, plan.seeds, sees), seeds),
              published ? Cell(*published / seen->deviation) : Cell("seen now"),
              Cell(std::abs(seen->deviation) / sd)});
  return row;
}

StudyTable FalseAlarms(const Plan& plan, const StudyOptions& options) {
  std::vector<std::atomic<int>> alarms(plan.detectors.size());
  ParallelFor(
      options.runs,
      [&](int i) {
        const Record record =
            plan.Run({}, options.seed + kHealthySeeds + static_cast<std::uint64_t>(i));
        for (std::size_t k = 0; k < alarms.size(); ++k) {
          if (plan.detectors[k].alarms(record)) ++alarms[k];
        }
      },
      options.progress);
  GrowingTable table(
      {"False alarms in " + std::to_string(options.runs) + " healthy runs, " +
           (plan.linear ? "" : "non") + "linear plant",
       {"by", "alarms", "[%]", "95 % interval [%]"},
       {},
       {}},
      options.row);
  for (std::size_t k = 0; k < alarms.size(); ++k) {
    const int count = alarms[k];
    table.Add({plan.detectors[k].name, static_cast<double>(count),
               PerCent(count, options.runs), IntervalCell(count, options.runs)});
  }
  return table.table();
}

/// Sizes, then false alarms.
std::vector<StudyTable> Detect(const Plan& plan, const std::string& title,
                               const StudyOptions& options) {
  const Setup& setup = plan.machine.setup();
  const auto& largest = setup.Study("largest").values;
  GrowingTable sizes(EmptySizes(plan, title), options.row);
  const auto parts = static_cast<double>(largest.size() + 1);
  double done = 0.0;
  for (const auto& [fault, value] : largest) {
    const auto published =
        PublishedDeviation(plan.machine, setup.Study(plan.study), fault);
    for (const Sight& sight : SightsOf(plan, fault)) {
      sizes.Add(
          RowOf(plan, sight, fault, value - HealthyValue(setup, fault), published));
    }
    done += 1.0 / parts;
    if (options.progress) options.progress(done);
  }
  StudyOptions last = options;
  last.progress = [&](double fraction) {
    if (options.progress) options.progress(done + fraction / parts);
  };
  return {sizes.table(), FalseAlarms(plan, last)};
}

Plan PlanFor(const Machine& machine, const std::string& study, bool linear,
             const StudyOptions& options) {
  Plan plan{machine, DefaultMotion(machine.setup()), linear, study, {}, {}, {}};
  plan.seeds = {std::min(kSeeds, options.runs), options.seed};
  const auto faults = static_cast<Index>(MakeFaultFamily(machine).Names().size());
  plan.bound =
      RunBound(machine, VectorXd::Zero(faults), plan.Run({}, options.seed), 0, linear);
  return plan;
}

/// When the residual leaves its limits at the sizes of the thesis.
StudyTable Delays(const Plan& plan, const PreparedDiagnosis& detector,
                  const StudyOptions& options) {
  StudyTable table{
      "Delay of the residual at the sizes of the thesis",
      {"fault", "thesis", "at time [s]"},
      {},
      {"The faults are there from the start: most of it is the wait for the "
       "first move of that axis."}};
  for (const auto& [fault, value] : plan.machine.setup().Study(plan.study).values) {
    const Detection seen =
        Look(detector, plan.Run({{fault, value}}, options.seed), fault);
    table.rows.push_back(
        {fault, value, seen.residual ? Cell(*seen.residual) : Cell("-")});
  }
  return table;
}

}  // namespace

std::vector<StudyTable> LinearDetectionStudy(const Machine& machine,
                                             const StudyOptions& options) {
  Plan plan = PlanFor(machine, "table2", true, options);
  const PreparedDiagnosis prepared = LinearDiagnosis(machine);
  plan.detectors = {ByResidual("residual", prepared),
                    BySpectrum(machine.setup(), prepared), ByEstimate(prepared),
                    ByTwin(machine, true)};
  std::vector<StudyTable> tables =
      Detect(plan, "Smallest detectable faults, linear plant", options);
  tables.front().notes.emplace_back(kTwinSees);
  tables.push_back(Delays(plan, prepared, options));
  return tables;
}

std::vector<StudyTable> NonlinearDetectionStudy(const Machine& machine,
                                                const std::string& study, bool baseline,
                                                const StudyOptions& options) {
  Plan plan = PlanFor(machine, study, false, options);
  DiagnosisSource source;
  source.baseline = baseline;
  source.nominal.runs = 8;
  const PreparedDiagnosis common = PrepareDiagnosis(machine, source, plan.motion);
  plan.detectors = {ByResidual("residual", common), BySpectrum(machine.setup(), common),
                    ByEstimate(common)};
  for (const auto& [fault, value] : machine.setup().Study("largest").values) {
    source.robust = fault;
    plan.detectors.push_back(ByResidual(
        "robust residual of " + fault, PrepareDiagnosis(machine, source, plan.motion)));
    plan.detectors.back().meant_for = [meant = fault](const std::string& other) {
      return other == meant;
    };
  }
  // It takes most of the time, and knows nothing of baselines.
  if (!baseline) plan.detectors.push_back(ByTwin(machine, false));
  std::vector<StudyTable> tables =
      Detect(plan,
             std::string("Smallest detectable faults, nonlinear plant") +
                 (baseline ? ", baseline subtracted" : ""),
             options);
  tables.front().notes.emplace_back(
      "The robust residual is, of all residuals of the robust degree, the one that "
      "nominal runs excite least while the fault is seen; its limits come from nominal "
      "runs, too. An estimate counts when it is outside what nominal runs of this "
      "motion "
      "gave.");
  tables.front().notes.emplace_back(
      baseline ? "The twin takes no residuals: that of Table 3 is that of this one."
               : kTwinSees);
  return tables;
}

}  // namespace mjdiag
