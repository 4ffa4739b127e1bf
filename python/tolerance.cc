// TolerantRun: a run whose controllers a diagnosis corrects.

#include "python/tolerance.h"

#include <pybind11/stl.h>

#include "mjdiag/diagnosis/diagnosis_verdict.h"
#include "mjdiag/signals/quantity.h"
#include "python/arrays.h"
#include "python/bindings.h"

namespace mjdiag::python {

namespace py = pybind11;

namespace {

py::dict FaultsOf(const TolerantRunObject& object) {
  const py::object make = py::module_::import("mjdiag").attr("Correction");
  py::dict faults;
  for (const Tolerated& fault : object.run.faults) {
    const py::object until =
        fault.acting ? py::object(py::none()) : py::object(py::float_(fault.until));
    faults[fault.fault.c_str()] =
        make(fault.action, fault.value, fault.since, fault.acting, until);
  }
  return faults;
}

py::dict GainsOf(const TolerantRunObject& object) {
  const py::object make = py::module_::import("mjdiag").attr("LoopGain");
  py::dict gains;
  for (std::size_t i = 0; i < object.axes.size(); ++i) {
    const RemediedAxis& axis = object.plan.axes[i];
    gains[object.axes[i].c_str()] =
        make(object.run.gains[i], axis.least_gain, axis.most_gain);
  }
  return gains;
}

std::string Words(const TolerantRunObject& object) {
  std::string text;
  for (const Tolerated& fault : object.run.faults) {
    text += (text.empty() ? "" : ", ") + fault.fault + " = " + Digits(fault.value) +
            " by " + fault.action;
  }
  return text.empty() ? "nothing to correct" : "corrected " + text;
}

std::string TolerantRunHtml(const TolerantRunObject& object) {
  const DiagnosisResult& result = object.run.diagnosis.result;
  Page page(result.setup);
  page.SetVerdict(result.detected ? Tone::kBad : Tone::kGood, DiagnosisVerdict(result));
  Table table;
  table.columns = {{"Corrected"},
                   {"By"},
                   {"Value acted on", true},
                   {"Since", true},
                   {"Until", true}};
  for (const Tolerated& fault : object.run.faults) {
    table.rows.push_back({fault.fault, fault.action, Digits(fault.value),
                          FormatQuantity(fault.since, "s"),
                          fault.acting ? "" : FormatQuantity(fault.until, "s")});
  }
  if (table.rows.empty()) {
    page.AddParagraph("Nothing to correct.");
  } else {
    page.AddTable(table);
  }
  return NotebookHtml(page);
}

}  // namespace

void BindTolerance(py::module_& module) {
  py::class_<TolerantRunObject>(module, "TolerantRun",
                                R"(
                                The answer of Machine.tolerate: a run, what the diagnosis
                                in it found, and what was done about it. In a notebook it
                                shows its verdict and corrections.)")
      .def_property_readonly(
          "record", [](const TolerantRunObject& object) { return object.run.record; },
          "The run, a Record as of Machine.simulate.")
      .def_property_readonly(
          "diagnosis",
          [](const TolerantRunObject& object) {
            return DiagnosisObject{object.prepared, object.run.diagnosis, {}};
          },
          "What was found while the machine ran, a Diagnosis.")
      .def_property_readonly("faults", &FaultsOf,
                             R"(
          Name -> Correction of every fault that was acted on: action ("drive gain of x",
          "feedforward", ...), value that is acted on at the end, since and until [s],
          until None where it is acting still.)")
      .def_property_readonly("gains", &GainsOf,
                             R"(
          Axis -> LoopGain: gain of its loop at the end, 1 where nothing is corrected, and
          least and most between which the loop is known to be stable.)")
      .def_property_readonly(
          "time_constant",
          [](const TolerantRunObject& object) {
            return object.plan.options.time_constant;
          },
          "With which corrections follow what is known [s].")
      .def_property_readonly(
          "sigmas",
          [](const TolerantRunObject& object) { return object.plan.options.sigmas; },
          "Standard deviations from healthy at which a fault is acted on.")
      .def_property_readonly(
          "loop_radius",
          [](const TolerantRunObject& object) {
            return object.plan.margins.healthy_radius;
          },
          "Largest modulus of an eigenvalue of the healthy loop; stable below 1.")
      .def_property_readonly(
          "largest_loop_radius",
          [](const TolerantRunObject& object) {
            return object.plan.margins.largest_radius;
          },
          "The same over all faults and gains that are allowed.")
      .def(
          "to_dict",
          [](const TolerantRunObject& object) { return ParsedJson(object.json); },
          R"(
          What was done as a dict: time_constant, sigmas, loop_radius,
          largest_loop_radius, axes and faults.)")
      .def("_repr_html_", &TolerantRunHtml)
      .def("__repr__", [](const TolerantRunObject& object) {
        return "<mjdiag.TolerantRun: " + Words(object) + ">";
      });
}

}  // namespace mjdiag::python
