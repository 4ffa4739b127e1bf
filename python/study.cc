// Study: a plan of runs of one's own, its runs, and what they found.

#include "python/study.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>
#include <optional>
#include <utility>

#include "mjdiag/report/study_page.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/studies/dataset/plan_tables.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/diagnosis.h"
#include "python/long_call.h"
#include "python/record.h"

namespace mjdiag::python {

namespace py = pybind11;

namespace {

std::int64_t IndexOf(const StudyObject& study, std::int64_t index) {
  const std::int64_t runs = study.planner->runs();
  if (index >= 0 && index < runs) return index;
  throw InputError("index", std::to_string(index), "0 to " + std::to_string(runs - 1));
}

/// "runs 734 of 2000, 61 a second".
std::string Told(const PlanProgress& progress) {
  std::string text = progress.doing;
  if (text != "runs") return text;
  text =
      std::to_string(progress.done) + " of " + std::to_string(progress.total) + " runs";
  if (const auto left = progress.SecondsLeft()) {
    text += ", " + Digits(std::ceil(*left)) + " s to go";
  }
  return text;
}

StudyResultObject RunStudy(const StudyObject& study, const py::object& folder,
                           bool restart, const py::object& progress) {
  PlanRunOptions options;
  options.folder = PathOf(folder, "Study.run");
  options.restart = restart;
  std::optional<StudyResultObject> made;
  RunLong(progress, false, [&](LongCall& call) {
    options.progress = [&call](const PlanProgress& so_far) {
      if (call.IsStopped()) throw Stopped{};
      call.Tell(static_cast<double>(so_far.done) / static_cast<double>(so_far.total),
                Told(so_far));
    };
    PlanOutcome outcome = RunPlan(*study.loaded, options);
    std::vector<StudyTable> tables = PlanTables(outcome);
    made = StudyResultObject{study, std::move(outcome), std::move(tables)};
  });
  return std::move(*made);
}

Record SimulateRun(const StudyObject& study, std::int64_t index,
                   const py::object& progress) {
  IndexOf(study, index);
  Record record;
  RunLong(progress, false, [&](LongCall&) {
    record = RunMaker(*study.loaded).Simulate(study.planner->Run(index));
  });
  return record;
}

py::dict DescribeRun(const StudyObject& study, std::int64_t index) {
  const StudyPlan& plan = study.loaded->plan;
  const PlannedRun run = study.planner->Run(IndexOf(study, index));
  py::dict values;
  const std::vector<double> drawn = study.planner->ValuesOf(run);
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    values[study.planner->columns()[i].name.c_str()] = drawn[i];
  }
  py::dict numbers;
  for (const auto& [number, factor] : run.numbers) {
    numbers[ModelParameterName(study.loaded->machine.plant(), number).c_str()] = factor;
  }
  py::dict told;
  told["machine"] = run.machine;
  told["split"] = SplitName(run.split);
  told["case"] = plan.cases[static_cast<std::size_t>(run.in_case)].name;
  told["trajectory"] = plan.motions[static_cast<std::size_t>(run.motion)].name;
  told["replication"] = run.replication;
  told["seed"] = run.seed;
  told["label"] = run.Label();
  told["values"] = values;
  told["numbers"] = numbers;
  return told;
}

/// A row for every run.
template <typename Of>
py::array_t<double> Rows(const StudyResultObject& result, std::size_t columns,
                         const Of& of) {
  const auto& results = result.outcome.results;
  py::array_t<double> array({results.size(), columns});
  auto values = array.mutable_unchecked<2>();
  for (std::size_t i = 0; i < results.size(); ++i) {
    for (std::size_t j = 0; j < columns; ++j) {
      values(static_cast<py::ssize_t>(i), static_cast<py::ssize_t>(j)) =
          of(results[i], j);
    }
  }
  return array;
}

py::object CellOf(const Cell& cell) {
  if (cell.is_number) return py::float_(cell.number);
  return py::str(cell.text);
}

py::list TablesOf(const StudyResultObject& result) {
  py::list tables;
  for (const StudyTable& table : result.tables) {
    if (table.rows.empty()) continue;
    py::list rows;
    for (const std::vector<Cell>& cells : table.rows) {
      py::list row;
      for (const Cell& cell : cells) row.append(CellOf(cell));
      rows.append(row);
    }
    py::dict one;
    one["title"] = table.title;
    one["columns"] = table.columns;
    one["rows"] = rows;
    one["notes"] = table.notes;
    tables.append(one);
  }
  return tables;
}

Page PageOf(const StudyResultObject& result) {
  const LoadedPlan& loaded = *result.study.loaded;
  StudyFacts facts{loaded.machine.setup().name, loaded.plan.name,
                   static_cast<int>(loaded.plan.Runs()), loaded.plan.seed};
  facts.is_plan = true;
  return StudyPage(facts, result.tables,
                   {"study.run(folder)", "", {{"mjdiag", MJDIAG_VERSION}}});
}

py::object RunFrame(const StudyResultObject& result) {
  py::object pandas;
  try {
    pandas = py::module_::import("pandas");
  } catch (const py::error_already_set& error) {
    if (!error.matches(PyExc_ImportError)) throw;
    throw InputError("StudyResult.to_pandas", "pandas is not installed",
                     "python3-pandas, or runs");
  }
  return pandas.attr("DataFrame")(RunColumns(result));
}

void BindPlan(py::module_& module) {
  py::class_<StudyObject>(module, "Study",
                          R"(
                          Runs of a machine by a plan: what varies, how often, and what is
                          kept of each run (docs/datasets.md). A run is a function of the
                          plan and its number alone.)")
      .def(py::init(&StudyOf), py::arg("plan"),
           R"(
           plan: the path of a TOML file, TOML, or a dict with the same keys (schema and
           name may be left out). Its setup is relative to the file, else to the current
           folder. InputError says line, key and what was expected.)")
      .def("run", &RunStudy, py::arg("folder"), py::kw_only(),
           py::arg("restart") = false, py::arg("progress") = py::none(),
           R"(
           Makes all runs, in parallel -> StudyResult.

           folder: where plan, finished runs and the data set (dataset.h5) are kept. Runs
               that are there are not made again, so that a study that was ended, by
               Ctrl-C or a kill, goes on; restart=True forgets them.
           progress: True for a bar of tqdm, or a callable of a fraction and a text.

           InputError if the folder has the runs of another plan.)")
      .def("simulate", &SimulateRun, py::arg("index"), py::kw_only(),
           py::arg("progress") = py::none(),
           R"(
           The whole record of the run of that number -> Record. NumericalError if it
           diverges.)")
      .def("describe", &DescribeRun, py::arg("index"),
           R"(
           What is planned for the run of that number -> dict with machine, split, case,
           trajectory, replication, seed, label, values (axis -> value) and numbers (of
           the machine over those of the model).)")
      .def_property_readonly(
          "runs", [](const StudyObject& study) { return study.planner->runs(); },
          "How many runs the plan asks for.")
      .def_property_readonly(
          "name", [](const StudyObject& study) { return study.loaded->plan.name; },
          "Of the plan.")
      .def_property_readonly(
          "plan", [](const StudyObject& study) { return study.loaded->plan.text; },
          "The plan in TOML.")
      .def("__repr__", [](const StudyObject& study) {
        return "<mjdiag.Study: " + study.loaded->plan.name + ", " +
               std::to_string(study.planner->runs()) + " runs>";
      });
}

void BindResult(py::module_& module) {
  py::class_<StudyResultObject>(module, "StudyResult",
                                R"(
                                What a study found. In a notebook it shows its tables.)")
      .def_property_readonly("runs", &RunColumns,
                             R"(
                             Name -> array (runs,): machine, split, case, point,
                             trajectory, replication, seed, label, a column for every
                             axis in its SI unit, diverged, and of runs that were
                             diagnosed detected, first_detection [s], disturbed and
                             misfit.)")
      .def("to_pandas", &RunFrame,
           R"(
           The columns of runs -> pandas.DataFrame, a row for every run.)")
      .def_property_readonly(
          "dataset",
          [](const StudyResultObject& result) -> py::object {
            if (!result.outcome.dataset) return py::none();
            return py::str(result.outcome.dataset->string());
          },
          "Path of the HDF5 file; None of a build without HDF5.")
      .def_property_readonly(
          "feature_names",
          [](const StudyResultObject& result) {
            return result.outcome.work->layout().features;
          },
          "Of the columns of features.")
      .def_property_readonly(
          "features",
          [](const StudyResultObject& result) {
            return Rows(result, result.outcome.work->layout().features.size(),
                        [](const RunResult& run, std::size_t i) {
                          return i < run.features.size() ? run.features[i] : kNoValue;
                        });
          },
          "Features of every run, (runs, features); NaN of one that diverged.")
      .def_property_readonly(
          "fault_names",
          [](const StudyResultObject& result) {
            return result.outcome.work->layout().faults;
          },
          "Of the columns of estimates, estimate_sd and named; empty if not kept.")
      .def_property_readonly(
          "estimates",
          [](const StudyResultObject& result) {
            return Rows(result, result.outcome.work->layout().faults.size(),
                        [](const RunResult& run, std::size_t i) {
                          return i < run.faults.size() ? run.faults[i].value : kNoValue;
                        });
          },
          "Estimated value of every fault, (runs, faults).")
      .def_property_readonly(
          "estimate_sd",
          [](const StudyResultObject& result) {
            return Rows(result, result.outcome.work->layout().faults.size(),
                        [](const RunResult& run, std::size_t i) {
                          return i < run.faults.size() ? run.faults[i].sd : kNoValue;
                        });
          },
          "Standard deviation that the diagnosis claims of it, (runs, faults).")
      .def_property_readonly(
          "named",
          [](const StudyResultObject& result) {
            return Rows(result, result.outcome.work->layout().faults.size(),
                        [](const RunResult& run, std::size_t i) {
                          return i < run.faults.size() && run.faults[i].named ? 1.0
                                                                              : 0.0;
                        })
                .attr("astype")("bool");
          },
          "Whether the diagnosis names it, (runs, faults).")
      .def_property_readonly("tables", &TablesOf,
                             R"(
                             The tables of the report: dicts with title, columns, rows and
                             notes.)")
      .def(
          "report",
          [](const StudyResultObject& result, const py::object& path) {
            WriteReportFile(PageOf(result), path);
          },
          py::arg("path"),
          R"(
          Writes one self-contained HTML page with tables and plots. InputError if that
          cannot be written.)")
      .def("_repr_html_",
           [](const StudyResultObject& result) { return NotebookHtml(PageOf(result)); })
      .def("__repr__", [](const StudyResultObject& result) {
        return "<mjdiag.StudyResult: " + result.study.loaded->plan.name + ", " +
               std::to_string(result.outcome.results.size()) + " runs>";
      });
}

}  // namespace

void BindStudy(py::module_& module) {
  BindPlan(module);
  BindResult(module);
}

}  // namespace mjdiag::python
