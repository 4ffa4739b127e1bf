// FilterDesign: residual filters, prefilters and limits of a machine.

#include "python/filter_design.h"

#include <pybind11/stl.h>

#include <optional>
#include <utility>

#include "mjdiag/report/design_json.h"
#include "mjdiag/report/design_page.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/text_file.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/record.h"

namespace mjdiag::python {

namespace py = pybind11;

FilterDesignObject DesignMachine(const MachineObject& object, const std::string& method,
                                 const DiagnoseRequest& request,
                                 const py::object& progress) {
  object.RequireQuiet("design");
  if (method != "svd" && method != "lp") {
    throw InputError("method", "'" + method + "'", "svd or lp");
  }
  FilterDesignObject made{object, nullptr, {}};
  RunLong(progress, false, [&](LongCall& call) {
    const auto motion = [&] { return DefaultMotion(object.setup()); };
    made.prepared = PreparedFor(object, request, motion, call);
    call.Tell(1.0, "parity relations");
    made.facts = FactsOf(object.machine(), method == "lp");
  });
  return made;
}

namespace {

std::string JsonOf(const FilterDesignObject& object) {
  return DesignJson(object.design(), object.facts).dump(2) + "\n";
}

std::string FilterDesignHtml(const FilterDesignObject& object) {
  Page page(object.design().setup);
  page.SetVerdict(Tone::kNeutral, DesignVerdict(object.design(), object.facts));
  if (object.design().limits.known) page.AddTable(LimitTable(object.design().limits));
  if (object.facts.linear_program) {
    page.AddParagraph(DescribeParityPrograms(*object.facts.linear_program));
  }
  return NotebookHtml(page);
}

void ReportDesign(const FilterDesignObject& object, const py::object& path) {
  DesignFacts facts = object.facts;
  facts.changed = WithoutStiffness(object.machine.machine());
  WriteReportFile(DesignPage(object.design(), facts,
                             {"machine.design()", "", {{"mjdiag", MJDIAG_VERSION}}}),
                  path);
}

py::object LinearProgramOf(const FilterDesignObject& object) {
  if (!object.facts.linear_program) return py::none();
  return ParsedJson(JsonOf(object)).attr("get")("linear_program");
}

using FilterClass = py::class_<FilterDesignObject>;

void BindFacts(FilterClass& design) {
  design
      .def_property_readonly(
          "minimal_degree",
          [](const FilterDesignObject& object) { return object.facts.minimal_degree; },
          "From which degree on the machine has parity relations.")
      .def_property_readonly(
          "observability_ranks",
          [](const FilterDesignObject& object) {
            return py::module_::import("numpy").attr("array")(
                object.facts.observability_ranks);
          },
          R"(
          Ranks of [C; C A; ...; C A^k] for k from 0 to degree, (degree + 1,), of
          integers; at most `states`.)")
      .def_property_readonly(
          "states",
          [](const FilterDesignObject& object) { return object.facts.states; },
          "Of the linear machine.")
      .def_property_readonly("linear_program", &LinearProgramOf,
                             R"(
          With method="lp" a dict: degree, norm, fault_inputs, programs, feasible and, None
          where none is feasible, objective, defect and angle [rad]; else None.)")
      .def_property_readonly(
          "degree",
          [](const FilterDesignObject& object) {
            return object.design().options.residual.degree;
          },
          "Of the relations that the residuals are made of.")
      .def_property_readonly(
          "residuals",
          [](const FilterDesignObject& object) {
            return object.design().bank.residuals;
          },
          "How many residuals there are.");
}

void BindLimits(FilterClass& design) {
  design
      .def_property_readonly(
          "limits",
          [](const FilterDesignObject& object) {
            const Interval& limits = object.design().limits.residual.limits;
            return std::pair{limits.min, limits.max};
          },
          "Limits (low, high) of the residual, in units of its own noise.")
      .def_property_readonly(
          "integral_limit",
          [](const FilterDesignObject& object) {
            return object.design().limits.integral;
          },
          "Limit of the windowed mean of |residual|.")
      .def_property_readonly(
          "peak_limit",
          [](const FilterDesignObject& object) {
            return object.design().limits.disturbance.peak;
          },
          "Limit of the density of a tone of a disturbance.")
      .def_property_readonly(
          "power_limit",
          [](const FilterDesignObject& object) {
            return object.design().limits.disturbance.total;
          },
          "Limit of the power of the disturbance residual.");
}

}  // namespace

void BindFilterDesign(py::module_& module) {
  FilterClass design(module, "FilterDesign",
                     R"(
                     The answer of Machine.design: residual filters, prefilters and the
                     limits that healthy runs keep to. In a notebook it shows its limits.)");
  BindFacts(design);
  BindLimits(design);
  design
      .def_property_readonly(
          "outputs",
          [](const FilterDesignObject& object) { return object.design().outputs; },
          "Names of the sensor channels that go in.")
      .def_property_readonly(
          "inputs",
          [](const FilterDesignObject& object) { return object.design().inputs; },
          "Names of the actuator channels that go in.")
      .def_property_readonly(
          "fault_names",
          [](const FilterDesignObject& object) { return object.design().FaultNames(); },
          "Fault parameters that are estimated, then disturbances.")
      .def_property_readonly(
          "sample_time",
          [](const FilterDesignObject& object) {
            return object.design().sample_time();
          },
          "Of the filters [s].")
      .def_property_readonly(
          "verdict",
          [](const FilterDesignObject& object) {
            return DesignVerdict(object.design(), object.facts);
          },
          "The answer in one sentence.")
      .def(
          "to_dict",
          [](const FilterDesignObject& object) { return ParsedJson(JsonOf(object)); },
          R"(
          All of it as a dict, schema "mjdiag.filters/1", coefficients of the filters
          among it.)")
      .def(
          "write",
          [](const FilterDesignObject& object, const py::object& path) {
            WriteTextFile(PathOf(path, "FilterDesign.write"), JsonOf(object));
          },
          py::arg("path"),
          R"(
          Writes the file that `filters` of diagnose and Monitor, and --filters of the
          command, take. InputError if it cannot be written.)")
      .def("report", &ReportDesign, py::arg("path"),
           "Writes one self-contained HTML page. InputError if that cannot be written.")
      .def("_repr_html_", &FilterDesignHtml)
      .def("__repr__", [](const FilterDesignObject& object) {
        return "<mjdiag.FilterDesign: " + DesignVerdict(object.design(), object.facts) +
               ">";
      });
}

}  // namespace mjdiag::python
