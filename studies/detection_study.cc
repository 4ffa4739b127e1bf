// How small a fault is seen: [AB383], Tables 2, 3 and 5, by the residuals of the thesis
// and by the twin side by side. A fault counts as seen at a size at which 95 % of the seeds
// see it (`seeds`, or as many as the plan has replications, if that is less); false alarms
// are counted in as many healthy runs as replications, at the same setting. Faults are those
// of the case "largest", in the direction of the value there, which is also the largest
// that is tried; those of the case "published" are compared with. Seeds and noise differ
// from those of the design.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>

#include "mjdiag/plugin/design/fault_family.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/studies/answer.h"
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

/// Seeds of healthy runs are others than those of faulty ones.
constexpr std::uint64_t kHealthySeeds = 10000;
/// A fault of so many standard deviations of its bound is about to be seen.
constexpr double kAboutSeen = 6.0;

/// What is looked for, and by whom.
struct Search {
  const AskSmallestSize& ask;
  const LoadedPlan& loaded;
  const RunMaker& maker;
  SeedsOfASize seeds;
  std::vector<Detector> detectors;
  VectorXd bound;  ///< of the healthy machine, standard deviations

  const Machine& machine() const { return loaded.machine; }
  bool linear() const { return loaded.plan.linear; }
  Record Healthy(std::uint64_t seed) const {
    PlannedRun run;
    run.seed = seed;
    return maker.Simulate(run);
  }
};

std::optional<double> PublishedDeviation(const StudyPlan& plan,
                                         const std::string& fault) {
  for (const PlanAxis& axis : CaseOf(plan, "published").axes) {
    if (axis.name == fault) return axis.values.front() - axis.healthy;
  }
  return std::nullopt;
}

/// A deviation as people write it: +0.5 %; of a disturbance its magnitude.
Cell DeviationCell(const PlanAxis& fault, double deviation) {
  Cell cell(deviation);
  if (fault.kind == AxisKind::kDisturbance) return cell;
  cell.text = (deviation > 0.0 ? "+" : "") + Cell(100.0 * deviation).text + " %";
  return cell;
}

StudyTable EmptySizes(const Search& search, const std::string& title) {
  return {
      title,
      {"fault", "seen by", "thesis", "seen there [%]", "95 % see", "seen there [%]",
       "at half of it [%]", "times better than the thesis", "over the bound"},
      {},
      {"Seen by " + std::to_string(search.seeds.count) +
           " seeds a size; a size that 95 % see is accurate to " +
           Cell(100.0 * (search.ask.resolution - 1.0)).text + " %.",
       "The bound is the standard deviation that no estimate can be better than, all "
       "faults" +
           std::string(search.linear() ? "" : ", dry friction") +
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
std::vector<Sight> SightsOf(const Search& search, const PlanAxis& fault) {
  const auto run = [&search, &fault](double deviation, std::uint64_t seed) {
    return search.maker.Simulate(RunWith(fault, fault.healthy + deviation, seed));
  };
  const auto look = [&fault](const Detector& detector) -> LookedAtRuns::Sees {
    return [&detector, &fault](const Record& record) {
      return detector.sees(record, fault.name);
    };
  };
  std::vector<Sight> sights;
  std::vector<LookedAtRuns::Sees> shared;
  for (const Detector& detector : search.detectors) {
    if (detector.meant_for && !detector.meant_for(fault.name)) continue;
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
std::vector<Cell> RowOf(const Search& search, const Sight& sight,
                        const PlanAxis& fault) {
  const auto& [detector, sees] = sight;
  const double largest = fault.values.front() - fault.healthy;
  const auto published = PublishedDeviation(search.loaded.plan, fault.name);
  const double sd = search.bound[BoundIndex(search.machine(), fault.name)];
  std::optional<double> guess;
  if (detector.at_bound) guess = std::copysign(kAboutSeen * sd, largest);
  const SizeGrid grid(largest, search.ask.resolution);
  const auto seen = SurelySeenSize(grid, guess, search.seeds, sees);
  const int seeds = search.seeds.count;
  std::vector<Cell> row{
      fault.name, detector.name,
      published ? DeviationCell(fault, *published) : Cell("undetectable"),
      published ? PerCent(CountSeen(*published, search.seeds, sees), seeds)
                : Cell("-")};
  if (!seen) {
    row.insert(row.end(), {"nothing", "-", "-", "-", "-"});
    return row;
  }
  row.insert(row.end(),
             {DeviationCell(fault, seen->deviation), PerCent(seen->seeds, seeds),
              PerCent(CountSeen(0.5 * seen->deviation, search.seeds, sees), seeds),
              published ? Cell(*published / seen->deviation) : Cell("seen now"),
              Cell(std::abs(seen->deviation) / sd)});
  return row;
}

StudyTable FalseAlarms(const Search& search, const StudyOptions& options) {
  const int runs = search.loaded.plan.replications;
  std::vector<std::atomic<int>> alarms(search.detectors.size());
  ParallelFor(
      runs,
      [&](int i) {
        const Record record = search.Healthy(search.loaded.plan.seed + kHealthySeeds +
                                             static_cast<std::uint64_t>(i));
        for (std::size_t k = 0; k < alarms.size(); ++k) {
          if (search.detectors[k].alarms(record)) ++alarms[k];
        }
      },
      options.progress);
  GrowingTable table({"False alarms in " + std::to_string(runs) + " healthy runs, " +
                          PlantName(search.linear()),
                      {"by", "alarms", "[%]", "95 % interval [%]"},
                      {},
                      {}},
                     options.row);
  for (std::size_t k = 0; k < alarms.size(); ++k) {
    const int count = alarms[k];
    table.Add({search.detectors[k].name, static_cast<double>(count),
               PerCent(count, runs), IntervalCell(count, runs)});
  }
  return table.table();
}

/// When the residual leaves its limits at the published sizes.
StudyTable Delays(const Search& search, const PreparedDiagnosis& prepared) {
  StudyTable table{
      "Delay of the residual at the sizes of the thesis",
      {"fault", "thesis", "at time [s]"},
      {},
      {"The faults are there from the start: most of it is the wait for the "
       "first move of that axis."}};
  for (const PlanAxis& fault : CaseOf(search.loaded.plan, "published").axes) {
    const double value = fault.values.front();
    const Record record =
        search.maker.Simulate(RunWith(fault, value, search.loaded.plan.seed));
    const auto seen =
        Conclude(RecordDiagnosis(prepared.design, record, prepared.baseline))
            .first_detection;
    table.rows.push_back({fault.name, value, seen ? Cell(*seen) : Cell("-")});
  }
  return table;
}

/// Filters, with limits from healthy runs of that plant.
DiagnosisSource SourceOf(const AskSmallestSize& ask, bool linear) {
  DiagnosisSource source;
  source.nominal.linear = linear;
  source.baseline = ask.baseline;
  if (ask.limits_from > 0) source.nominal.runs = ask.limits_from;
  return source;
}

/// Those that the plan names.
std::vector<Detector> DetectorsOf(const AskSmallestSize& ask, const LoadedPlan& loaded,
                                  const Excitation& motion,
                                  const PreparedDiagnosis& prepared) {
  std::vector<Detector> detectors;
  for (const std::string& judge : ask.judges) {
    if (judge == "residual") {
      detectors.push_back(ByResidual("residual", prepared));
    } else if (judge == "spectrum") {
      detectors.push_back(BySpectrum(loaded.machine.setup(), prepared));
    } else if (judge == "estimate") {
      detectors.push_back(ByEstimate(prepared));
    } else if (judge == "twin") {
      detectors.push_back(ByTwin(loaded.machine, loaded.plan.linear));
    } else {
      DiagnosisSource source = SourceOf(ask, loaded.plan.linear);
      for (const PlanAxis& fault : CaseOf(loaded.plan, "largest").axes) {
        source.robust = fault.name;
        detectors.push_back(
            ByResidual("robust residual of " + fault.name,
                       PrepareDiagnosis(loaded.machine, source, motion)));
        detectors.back().meant_for = [meant = fault.name](const std::string& other) {
          return other == meant;
        };
      }
    }
  }
  return detectors;
}

std::vector<std::string> NotesOn(const AskSmallestSize& ask) {
  const auto has = [&](const char* judge) {
    return std::ranges::find(ask.judges, judge) != ask.judges.end();
  };
  std::vector<std::string> notes;
  if (has("robust residual")) {
    notes.emplace_back(
        "The robust residual is, of all residuals of the robust degree, the one that "
        "nominal runs excite least while the fault is seen; its limits come from "
        "nominal "
        "runs, too. An estimate counts when it is outside what nominal runs of this "
        "motion gave.");
  }
  if (has("twin")) {
    notes.emplace_back("The twin sees a fault that it names, and no other beside it.");
  } else if (ask.baseline) {
    notes.emplace_back(
        "The twin takes no residuals: that of Table 3 is that of this one.");
  }
  return notes;
}

}  // namespace

std::vector<StudyTable> AnswerTo(const AskSmallestSize& ask, const LoadedPlan& loaded,
                                 const StudyOptions& options) {
  const StudyPlan& plan = loaded.plan;
  for (const char* name : {"largest", "published"}) {
    RequireFaults(CaseOf(plan, name), AxisValues::kListed);
  }
  const RunMaker maker(loaded);
  const Excitation& motion = maker.motions().front();
  Search search{ask, loaded, maker, {std::min(ask.seeds, plan.replications), plan.seed},
                {},  {}};
  const auto faults =
      static_cast<Index>(MakeFaultFamily(loaded.machine).Names().size());
  search.bound = RunBound(loaded.machine, VectorXd::Zero(faults),
                          search.Healthy(plan.seed), 0, plan.linear);
  const DiagnosisSource source = SourceOf(ask, plan.linear);
  const PreparedDiagnosis prepared =
      plan.linear ? PrepareDiagnosis(loaded.machine, source)
                  : PrepareDiagnosis(loaded.machine, source, motion);
  search.detectors = DetectorsOf(ask, loaded, motion, prepared);

  GrowingTable sizes(
      EmptySizes(search, "Smallest detectable faults, " + PlantName(plan.linear) +
                             (ask.baseline ? ", baseline subtracted" : "")),
      options.row);
  const std::vector<PlanAxis>& largest = CaseOf(plan, "largest").axes;
  const std::size_t parts = largest.size() + 1;
  for (std::size_t i = 0; i < largest.size(); ++i) {
    for (const Sight& sight : SightsOf(search, largest[i])) {
      sizes.Add(RowOf(search, sight, largest[i]));
    }
    if (options.progress) options.PartOf(i, parts).progress(1.0);
  }
  std::vector<StudyTable> tables{sizes.table(),
                                 FalseAlarms(search, options.PartOf(parts - 1, parts))};
  for (std::string& note : NotesOn(ask)) {
    tables.front().notes.push_back(std::move(note));
  }
  if (ask.delays) tables.push_back(Delays(search, prepared));
  return tables;
}

}  // namespace mjdiag
