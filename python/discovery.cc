// Discovery: what a model lacks, and the model with it.

#include "python/discovery.h"

#include <pybind11/stl.h>

#include <utility>

#include "mjdiag/report/cause_text.h"
#include "mjdiag/report/discovery_json.h"
#include "mjdiag/report/discovery_page.h"
#include "mjdiag/report/discovery_text.h"
#include "mjdiag/report/kinds_text.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/diagnosis.h"
#include "python/record.h"

namespace mjdiag::python {

namespace py = pybind11;

namespace {

py::dict ParametersOf(const FoundCause& found) {
  py::dict parameters;
  for (const CauseParameter& parameter : found.parameters) {
    parameters[parameter.name.c_str()] = parameter;
  }
  return parameters;
}

py::list AlternativesOf(const FoundCause& found) {
  py::list alternatives;
  for (const Alternative& other : found.alternatives) {
    alternatives.append(py::make_tuple(CauseName(other.cause), other.probability));
  }
  return alternatives;
}

py::dict UncertainParameters(const Discovery& discovery) {
  const py::object make = py::module_::import("mjdiag").attr("ModelParameter");
  py::dict numbers;
  for (const CalibratedNumber& number : discovery.calibration) {
    numbers[number.name.c_str()] =
        make(number.factor, py::make_tuple(number.low, number.high), IsOff(number));
  }
  return numbers;
}

py::tuple FiguresOf(const Discovery::Figures& figures) {
  return py::make_tuple(figures.train, figures.validation);
}

std::string DiscoveryHtml(const DiscoveryObject& object) {
  const Discovery& discovery = object.discovery;
  const bool found = discovery.verdict != DiscoveryVerdict::kNoDiscrepancy;
  Page page(discovery.setup);
  page.SetVerdict(found ? Tone::kNeutral : Tone::kGood, DiscoveryAnswer(discovery));
  if (!discovery.kinds.empty()) page.AddTable(KindTable(discovery));
  if (!discovery.causes.empty()) page.AddTable(CauseTable(discovery));
  return NotebookHtml(page);
}

void ReportDiscovery(const DiscoveryObject& object, const py::object& path) {
  const DiscoveryRun run{
      {"machine.discover(records)", "mjdiag.Record", {{"mjdiag", MJDIAG_VERSION}}},
      "",
      ""};
  WriteReportFile(DiscoveryPage(object.discovery, run), path);
}

void BindCause(py::module_& module) {
  py::class_<CauseParameter>(module, "Parameter", "A parameter of a cause.")
      .def_readonly("name", &CauseParameter::name, "Of the parameter.")
      .def_readonly("value", &CauseParameter::value, "In `unit`.")
      .def_readonly("unit", &CauseParameter::unit, "SI.")
      .def_readonly("sd", &CauseParameter::sd, "Standard deviation of value.")
      .def_property_readonly(
          "ci95",
          [](const CauseParameter& parameter) {
            return py::make_tuple(parameter.low, parameter.high);
          },
          "Interval (low, high) that holds the true value in 95 of 100 records.")
      .def("__repr__", [](const CauseParameter& parameter) {
        return "<mjdiag.Parameter: " + parameter.name + " = " + ValueText(parameter) +
               ">";
      });
  py::class_<FoundCause>(
      module, "Cause",
      "An effect that the plant lacks, or a fault parameter off its healthy value.")
      .def_property_readonly(
          "effect", [](const FoundCause& found) { return found.cause.name(); },
          "Name of the effect (docs/effects.md) or of the fault parameter.")
      .def_property_readonly(
          "site", [](const FoundCause& found) { return found.cause.site; },
          "The joint, actuator or sensor at which it acts.")
      .def_property_readonly("parameters", &ParametersOf, "Name -> Parameter.")
      .def_readonly("probability", &FoundCause::probability,
                    "Among all that could be in its place.")
      .def_property_readonly("alternatives", &AlternativesOf,
                             R"(
                             Pairs (name, probability) of what else could be, 1 % or
                             more, likeliest first.)")
      .def_readonly(
          "words", &FoundCause::unnamed,
          "Of a force that was learned and has no name, what it is; else \"\".")
      .def("__repr__", [](const FoundCause& found) {
        return "<mjdiag.Cause: " + CauseWithValues(found.cause) + ">";
      });
}

void BindKind(py::module_& module) {
  py::class_<FoundKind>(module, "Kind",
                        "A kind of physics at a place, whichever law it follows.")
      .def_property_readonly(
          "name", [](const FoundKind& found) { return KindName(found.kind); },
          R"("dry friction", "compliance", "drive gain", ...)")
      .def_readonly("site", &FoundKind::site,
                    "The joint, actuator or sensor at which it acts.")
      .def_readonly("probability", &FoundKind::probability,
                    "By what data that no fit saw lose without it.")
      .def_readonly("share", &FoundKind::share,
                    "Of the unseen mismatch that the answer takes away, what is back "
                    "without it; 0 of a number of the plant.")
      .def("__repr__", [](const FoundKind& found) {
        return "<mjdiag.Kind: " + KindAt(found) + ">";
      });
}

}  // namespace

void BindDiscovery(py::module_& module) {
  BindCause(module);
  BindKind(module);
  py::class_<DiscoveryObject>(module, "Discovery",
                              R"(
      The answer of Machine.discover: what the model gets wrong, why, and the model with
      that in it. In a notebook it shows its answer, the kinds of physics and the causes.)")
      .def_property_readonly(
          "verdict",
          [](const DiscoveryObject& object) {
            return VerdictName(object.discovery.verdict);
          },
          R"("no_discrepancy", "explained", "partly_explained" or "unexplained".)")
      .def_property_readonly(
          "answer",
          [](const DiscoveryObject& object) {
            return DiscoveryAnswer(object.discovery);
          },
          "The answer in a sentence or two.")
      .def_property_readonly(
          "causes",
          [](const DiscoveryObject& object) { return object.discovery.causes; },
          "List of Cause.")
      .def_property_readonly(
          "kinds", [](const DiscoveryObject& object) { return object.discovery.kinds; },
          "List of Kind, the most probable first.")
      .def_property_readonly(
          "machine",
          [](const DiscoveryObject& object) {
            return object.machine.Extended(ChangesOfAnswer(object.discovery),
                                           object.discovery.substeps);
          },
          "The Machine with all causes in it, ready to simulate.")
      .def_property_readonly(
          "numbers",
          [](const DiscoveryObject& object) {
            return UncertainParameters(object.discovery);
          },
          R"(
          Name -> (factor, ci95, is_off) of the numbers of the plant that were in doubt,
          as times what the model says.)")
      .def_property_readonly(
          "mismatch_before",
          [](const DiscoveryObject& object) {
            return FiguresOf(object.discovery.mismatch_before);
          },
          R"(
          Two dicts, channel -> rms of measured less simulated in its unit: on what fits
          saw, and on what they did not see.)")
      .def_property_readonly(
          "mismatch_after",
          [](const DiscoveryObject& object) {
            return FiguresOf(object.discovery.mismatch_after);
          },
          "The same with the causes in the model.")
      .def_property_readonly(
          "gain",
          [](const DiscoveryObject& object) {
            return py::make_tuple(object.discovery.gain_train,
                                  object.discovery.gain_validation);
          },
          "1 - after / before, on what fits saw and on what they did not see.")
      .def_property_readonly(
          "stopped",
          [](const DiscoveryObject& object) { return object.discovery.budget.stopped; },
          "Whether Ctrl-C ended it; the answer is the best that it had.")
      .def_property_readonly(
          "notes", [](const DiscoveryObject& object) { return object.discovery.notes; },
          "What cannot be judged or told apart, and what looks odd in the records.")
      .def(
          "to_dict",
          [](const DiscoveryObject& object) {
            return ParsedJson(
                ToJson(object.discovery, "")
                    .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
          },
          "All of it as a dict, schema \"mjdiag.discovery/1\".")
      .def("report", &ReportDiscovery, py::arg("path"),
           "Writes one self-contained HTML page. InputError if that cannot be written.")
      .def(
          "write",
          [](const DiscoveryObject& object, const py::object& folder) {
            return object.machine
                .Extended(ChangesOfAnswer(object.discovery), object.discovery.substeps)
                .Write(PathOf(folder, "Discovery.write"))
                .string();
          },
          py::arg("folder"),
          R"(
          The same as machine.write: a folder with the extended plant and its setup.
          Returns the path of the MJCF.)")
      .def("_repr_html_", &DiscoveryHtml)
      .def("__repr__", [](const DiscoveryObject& object) {
        return "<mjdiag.Discovery: " + DiscoveryAnswer(object.discovery) + ">";
      });
}

}  // namespace mjdiag::python
