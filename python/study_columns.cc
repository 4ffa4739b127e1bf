// The runs of a study, column by column.

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "python/study.h"

namespace mjdiag::python {

namespace py = pybind11;

namespace {

/// An array of what `of` says of every run.
template <typename Value, typename Items, typename Of>
py::array_t<Value> ArrayOf(const Items& items, const Of& of) {
  py::array_t<Value> array(static_cast<py::ssize_t>(items.size()));
  auto values = array.mutable_unchecked();
  py::ssize_t i = 0;
  for (const auto& item : items) values(i++) = static_cast<Value>(of(item));
  return array;
}

template <typename Items, typename Of>
py::array TextsOf(const Items& items, const Of& of) {
  py::list texts;
  for (const auto& item : items) texts.append(of(item));
  return py::module_::import("numpy").attr("array")(texts, py::arg("dtype") = "object");
}

}  // namespace

py::dict RunColumns(const StudyResultObject& result) {
  const StudyPlan& plan = result.study.loaded->plan;
  const RunPlanner& planner = *result.study.planner;
  const std::vector<RunResult>& results = result.outcome.results;
  std::vector<PlannedRun> runs;
  for (std::int64_t i = 0; i < planner.runs(); ++i) runs.push_back(planner.Run(i));

  py::dict columns;
  const auto number = [&](const char* name, const auto& of) {
    columns[name] = ArrayOf<std::int64_t>(runs, of);
  };
  number("machine", [](const PlannedRun& run) { return run.machine; });
  columns["split"] =
      TextsOf(runs, [](const PlannedRun& run) { return SplitName(run.split); });
  columns["case"] = TextsOf(runs, [&](const PlannedRun& run) {
    return plan.cases[static_cast<std::size_t>(run.in_case)].name;
  });
  number("point", [](const PlannedRun& run) { return run.point; });
  columns["trajectory"] = TextsOf(runs, [&](const PlannedRun& run) {
    return plan.motions[static_cast<std::size_t>(run.motion)].name;
  });
  number("replication", [](const PlannedRun& run) { return run.replication; });
  columns["seed"] =
      ArrayOf<std::uint64_t>(runs, [](const PlannedRun& run) { return run.seed; });
  columns["label"] = TextsOf(runs, [](const PlannedRun& run) { return run.Label(); });
  for (std::size_t i = 0; i < planner.columns().size(); ++i) {
    columns[planner.columns()[i].name.c_str()] = ArrayOf<double>(
        runs, [&](const PlannedRun& run) { return planner.ValuesOf(run)[i]; });
  }
  columns["diverged"] =
      ArrayOf<bool>(results, [](const RunResult& run) { return run.diverged(); });
  if (plan.keep.Diagnoses()) {
    columns["detected"] =
        ArrayOf<bool>(results, [](const RunResult& run) { return run.detected; });
    columns["first_detection"] = ArrayOf<double>(
        results, [](const RunResult& run) { return run.first_detection; });
    columns["disturbed"] =
        ArrayOf<bool>(results, [](const RunResult& run) { return run.disturbed; });
    columns["misfit"] =
        ArrayOf<double>(results, [](const RunResult& run) { return run.nis; });
  }
  return columns;
}

}  // namespace mjdiag::python
