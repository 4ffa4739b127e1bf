// Discovery: what a model lacks, and the model with it.

#include "python/discovery.h"

#include "mjdiag/report/cause_text.h"
#include "mjdiag/report/discovery_fields.h"
#include "mjdiag/report/discovery_json.h"
#include "mjdiag/report/discovery_page.h"
#include "mjdiag/report/discovery_text.h"
#include "mjdiag/report/kinds_text.h"
#include "python/bindings.h"
#include "python/diagnosis.h"
#include "python/fields.h"
#include "python/record.h"

namespace mjdiag::python {

namespace py = pybind11;

namespace {

py::dict UncertainParameters(const Discovery& discovery) {
  const py::object make = py::module_::import("mjdiag").attr("ModelParameter");
  py::dict numbers;
  for (const CalibratedNumber& number : discovery.calibration) {
    numbers[number.name.c_str()] =
        make(number.factor, py::make_tuple(number.low, number.high), IsOff(number));
  }
  return numbers;
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

void BindParts(py::module_& module) {
  py::class_<CauseParameter> parameter(module, "Parameter", "A parameter of a cause.");
  BindFields<CauseParameter>(parameter).def("__repr__", [](const CauseParameter& one) {
    return "<mjdiag.Parameter: " + one.name + " = " + ValueText(one) + ">";
  });
  py::class_<FoundCause> cause(
      module, "Cause",
      "An effect that the plant lacks, or a fault parameter off its healthy value.");
  BindFields<FoundCause>(cause).def("__repr__", [](const FoundCause& found) {
    return "<mjdiag.Cause: " + CauseWithValues(found.cause) + ">";
  });
  py::class_<FoundKind> kind(module, "Kind",
                             "A kind of physics at a place, whichever law it follows.");
  BindFields<FoundKind>(kind).def("__repr__", [](const FoundKind& found) {
    return "<mjdiag.Kind: " + KindAt(found) + ">";
  });
}

}  // namespace

void BindDiscovery(py::module_& module) {
  BindParts(module);
  py::class_<DiscoveryObject> discovery(module, "Discovery",
                                        R"(
      The answer of Machine.discover: what the model gets wrong, why, and the model with
      that in it. In a notebook it shows its answer, the kinds of physics and the causes.)");
  BindFields<Discovery>(discovery, &DiscoveryObject::discovery)
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
