#include "mjdiag/studies/dataset/dataset_file.h"

#include <utility>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/file_replacement.h"
#include "mjdiag/signals/text_file.h"
#include "mjdiag/studies/dataset/hdf5_writer.h"

namespace mjdiag {
#ifdef MJDIAG_HDF5
namespace {

std::string KindName(AxisKind kind) {
  switch (kind) {
    case AxisKind::kFault:
      return "fault";
    case AxisKind::kDisturbance:
      return "disturbance";
    case AxisKind::kEffect:
      return "effect";
    case AxisKind::kKey:
      return "key";
    default:
      return "noise";
  }
}

/// Writes what one asks of every run, column by column.
class Table {
 public:
  Table(Hdf5Writer& writer, const RunWork& work, const DatasetSource& source)
      : writer_(writer), work_(work), source_(source) {
    const std::int64_t runs = work.planner().runs();
    runs_.reserve(static_cast<std::size_t>(runs));
    for (std::int64_t i = 0; i < runs; ++i) runs_.push_back(work.planner().Run(i));
  }

  template <typename Value, typename Of>
  void OfPlan(const std::string& path, const Hdf5Notes& notes, const Of& of) {
    std::vector<Value> values;
    values.reserve(runs_.size());
    for (const PlannedRun& run : runs_) values.push_back(Value(of(run)));
    writer_.Column(path, values, notes);
  }

  template <typename Value, typename Of>
  void OfResult(const std::string& path, const Hdf5Notes& notes, const Of& of) {
    std::vector<Value> values;
    values.reserve(runs_.size());
    for (const PlannedRun& run : runs_) {
      values.push_back(Value(of(source_.result(run.index))));
    }
    writer_.Column(path, values, notes);
  }

  /// @param of  the row of a run, NaN or 0 where there is none
  template <typename Value, typename Of>
  void Rows(const std::string& path, const Hdf5Notes& notes, const Of& of) {
    std::vector<Value> values;
    values.reserve(runs_.size() * notes.columns.size());
    for (const PlannedRun& run : runs_) {
      for (std::size_t i = 0; i < notes.columns.size(); ++i) {
        values.push_back(Value(of(run, source_.result(run.index), i)));
      }
    }
    writer_.Matrix(path, values, notes.columns.size(), notes);
  }

  void WriteSeries() {
    std::vector<std::size_t> numbers;
    for (const Series& series : work_.layout().series) {
      numbers.push_back(writer_.BeginSeries(
          series.group + "/" + series.name, runs_.size(),
          static_cast<std::size_t>(series.samples), series.single,
          {series.name + " of every run, a row each", series.unit}));
    }
    for (std::size_t row = 0; row < runs_.size(); ++row) {
      if (numbers.empty() || source_.result(runs_[row].index).diverged()) continue;
      const std::vector<std::string> packed = source_.series(runs_[row].index);
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        writer_.SeriesRow(numbers[i], row, packed.at(i));
      }
    }
  }

 private:
  Hdf5Writer& writer_;
  const RunWork& work_;
  const DatasetSource& source_;
  std::vector<PlannedRun> runs_;
};

void WriteRuns(Table& table, const StudyPlan& plan) {
  table.OfPlan<std::int64_t>("runs/index", {"number of the run"},
                             [](const PlannedRun& run) { return run.index; });
  table.OfPlan<std::int64_t>("runs/machine", {"number of the machine"},
                             [](const PlannedRun& run) { return run.machine; });
  table.OfPlan<std::string>("runs/split",
                            {"part of the data set that the machine is for"},
                            [](const PlannedRun& run) { return SplitName(run.split); });
  table.OfPlan<std::string>("runs/case", {"case of the plan"}, [&](const auto& run) {
    return plan.cases[static_cast<std::size_t>(run.in_case)].name;
  });
  table.OfPlan<std::int64_t>("runs/point",
                             {"point of the axes: runs that share it differ in "
                              "trajectory and noise only"},
                             [](const PlannedRun& run) { return run.point; });
  table.OfPlan<std::string>("runs/trajectory", {"motion"}, [&](const auto& run) {
    return plan.motions[static_cast<std::size_t>(run.motion)].name;
  });
  table.OfPlan<std::int64_t>("runs/replication", {"repetition of the point"},
                             [](const PlannedRun& run) { return run.replication; });
  table.OfPlan<std::uint64_t>("runs/seed", {"seed of the noise"},
                              [](const PlannedRun& run) { return run.seed; });
  table.OfPlan<std::string>("runs/label",
                            {"what is wrong, joined by \" + \"; \"healthy\""},
                            [](const PlannedRun& run) { return run.Label(); });
  table.OfResult<std::uint8_t>(
      "runs/diverged", {"1: the run diverged, and nothing was kept of it"},
      [](const RunResult& result) { return result.diverged(); });
  table.OfResult<std::int64_t>("runs/samples", {"samples at the control rate"},
                               [](const RunResult& result) { return result.samples; });
}

void WriteAxes(Hdf5Writer& writer, Table& table, const RunPlanner& planner) {
  const std::vector<PlanColumn>& columns = planner.columns();
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const PlanColumn& column = columns[i];
    const std::string path = "axes/" + column.name;
    table.OfPlan<double>(
        path, {"value in the run", column.unit},
        [&](const PlannedRun& run) { return planner.ValuesOf(run)[i]; });
    writer.Attribute(path, "kind", KindName(column.kind));
    if (column.kind != AxisKind::kKey)
      writer.Attribute(path, "healthy", column.healthy);
    table.OfPlan<double>(
        "since/" + column.name,
        {"time of the run from which on it has that value", "s"},
        [&](const PlannedRun& run) { return planner.TimesOf(run)[i]; });
  }
}

void WriteMachines(Hdf5Writer& writer, const LoadedPlan& loaded,
                   const RunPlanner& planner) {
  const PlanMachines& machines = loaded.plan.machines;
  std::vector<std::string> splits;
  std::vector<double> factors;
  std::vector<std::string> names;
  for (const auto& [number, sd] : machines.numbers) {
    names.push_back(ModelParameterName(loaded.machine.plant(), number));
  }
  for (int machine = 0; machine < machines.count; ++machine) {
    splits.push_back(SplitName(planner.SplitOf(machine)));
    for (const auto& [number, factor] : planner.NumbersOf(machine)) {
      factors.push_back(factor);
    }
  }
  writer.Column("machines/split", splits, {"part of the data set that it is for"});
  if (names.empty()) return;
  writer.Matrix("machines/numbers", factors, names.size(),
                {"numbers of the plant over those of the model", "1", names});
}

void WriteAnswers(Table& table, const PlanKeep& keep, const DatasetLayout& layout) {
  if (keep.verdicts) {
    table.OfResult<std::uint8_t>("verdicts/detected", {"1: something is wrong"},
                                 [](const RunResult& r) { return r.detected; });
    table.OfResult<double>("verdicts/first_detection",
                           {"when the residual left its limits; NaN: never", "s"},
                           [](const RunResult& r) { return r.first_detection; });
    table.OfResult<double>("verdicts/lasting",
                           {"when its windowed mean left its limit; NaN: never", "s"},
                           [](const RunResult& r) { return r.lasting; });
    table.OfResult<std::uint8_t>("verdicts/disturbed", {"1: tones, or raised noise"},
                                 [](const RunResult& r) { return r.disturbed; });
    table.OfResult<double>("verdicts/misfit",
                           {"squared innovations of the twin over those expected", "1"},
                           [](const RunResult& r) { return r.nis; });
    table.OfResult<double>("verdicts/residual_low", {"least of the residual", "1"},
                           [](const RunResult& r) { return r.residual_low; });
    table.OfResult<double>("verdicts/residual_high", {"most of the residual", "1"},
                           [](const RunResult& r) { return r.residual_high; });
    table.Rows<std::uint8_t>("verdicts/named",
                             {"1: this fault is named", "", layout.faults},
                             [](const PlannedRun&, const RunResult& r, std::size_t i) {
                               return i < r.faults.size() && r.faults[i].named;
                             });
  }
  if (keep.estimates) {
    table.Rows<double>("estimates/value",
                       {"estimated value of every fault", "1", layout.faults},
                       [](const PlannedRun&, const RunResult& r, std::size_t i) {
                         return i < r.faults.size() ? r.faults[i].value : kNoValue;
                       });
    table.Rows<double>("estimates/sd",
                       {"its standard deviation, as claimed", "1", layout.faults},
                       [](const PlannedRun&, const RunResult& r, std::size_t i) {
                         return i < r.faults.size() ? r.faults[i].sd : kNoValue;
                       });
  }
  if (!layout.features.empty()) {
    table.Rows<double>(
        "features", {"time and frequency features of the signals", "", layout.features},
        [](const PlannedRun&, const RunResult& r, std::size_t i) {
          return i < r.features.size() ? r.features[i] : kNoValue;
        });
  }
}

}  // namespace

void WriteDataset(const std::filesystem::path& file, const RunWork& work,
                  const DatasetSource& source) {
  const LoadedPlan& loaded = work.loaded();
  const Setup& setup = loaded.machine.setup();
  FileReplacement replacement(file);
  Hdf5Writer writer(replacement.temporary());
  writer.Attribute("/", "schema", "mjdiag.dataset/1");
  writer.Attribute("/", "name", loaded.plan.name);
  writer.Attribute("/", "setup", setup.name);
  writer.Attribute("/", "control_rate", setup.rates.control);
  writer.Text("plan", loaded.plan.text, {"the plan, as it was given"});
  writer.Text("setup", ReadTextFile(FindSetupFile(loaded.plan.setup)),
              {"the setup that it names"});
  writer.Text("plant", ReadTextFile(setup.plant), {"the MJCF file of that"});
  Table table(writer, work, source);
  WriteRuns(table, loaded.plan);
  WriteAxes(writer, table, work.planner());
  WriteMachines(writer, loaded, work.planner());
  WriteAnswers(table, loaded.plan.keep, work.layout());
  const std::vector<Series>& series = work.layout().series;
  table.WriteSeries();
  if (!series.empty()) {
    std::vector<double> time;
    for (Eigen::Index k = 0; k < series.front().samples; ++k) {
      time.push_back(static_cast<double>(k) * work.layout().sample_time);
    }
    writer.Column("time", time, {"of the samples of records and residual", "s"});
  }
  writer.Finish();
  replacement.Commit();
}
#else
void WriteDataset(const std::filesystem::path& file, const RunWork&,
                  const DatasetSource&) {
  throw InputError(file.string(), "mjdiag was built without HDF5",
                   "a build with libhdf5-dev");
}
#endif

}  // namespace mjdiag
