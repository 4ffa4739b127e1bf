// Diagnosis: what has worn, and how sure that is.

#include "python/diagnosis.h"

#include <pybind11/stl.h>

#include <utility>

#include "mjdiag/diagnosis/diagnosis_json.h"
#include "mjdiag/diagnosis/diagnosis_verdict.h"
#include "mjdiag/report/diagnosis_page.h"
#include "mjdiag/report/page/html.h"
#include "mjdiag/report/page/page_document.h"
#include "mjdiag/report/report.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/quantity.h"
#include "mjdiag/signals/text_file.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/record.h"

namespace mjdiag::python {

namespace py = pybind11;

bool DiagnoseRequest::IsUsual() const {
  return filters.empty() && !baseline && robust.empty() &&
         nominal_runs == NominalRuns{}.runs;
}

DiagnoseRequest RequestOf(bool linear, const py::object& filters, bool baseline,
                          const std::string& robust, int nominal_runs) {
  if (nominal_runs < 2) {
    throw InputError("nominal_runs", std::to_string(nominal_runs), "2 or more");
  }
  return {linear, filters.is_none() ? "" : PathOf(filters, "filters").string(),
          baseline, robust, nominal_runs};
}

std::shared_ptr<const PreparedDiagnosis> PreparedFor(
    const MachineObject& object, const DiagnoseRequest& request,
    const std::function<Excitation()>& motion, LongCall& call) {
  const Machine& machine = object.machine();
  if (request.IsUsual()) return object.prepared().For(machine, request.linear, call);
  DiagnosisSource source{request.filters, request.robust, request.baseline, {}};
  source.nominal.linear = request.linear;
  source.nominal.runs = request.nominal_runs;
  source.nominal.progress = call.Teller("healthy runs");
  return std::make_shared<PreparedDiagnosis>(
      PrepareDiagnosis(machine, source, NeedsMotion(source) ? motion() : Excitation{}));
}

DiagnosisObject DiagnoseRecord(const MachineObject& object, MeasuredFile measured,
                               const DiagnoseRequest& request, LongCall& call) {
  const Machine& machine = object.machine();
  DiagnosisObject made;
  made.notes = std::move(measured.notes);
  const auto motion = [&] { return Replay(machine.setup(), measured.record); };
  made.prepared = PreparedFor(object, request, motion, call);
  call.Tell(1.0, "diagnosing");
  made.diagnosis = Diagnose(machine, *made.prepared, measured.record);
  return made;
}

std::string NotebookHtml(const Page& page) {
  const nlohmann::json& document = page.document().json;
  std::string html = VerdictHtml(document.at("verdict"), "");
  for (const nlohmann::json& block : document.at("blocks")) {
    html += BlockHtml(block, "h4");
  }
  return html;
}

void WriteReportFile(const Page& page, const py::object& path) {
  WriteTextFile(PathOf(path, "report"), ReportHtml(page));
}

py::object ParsedJson(const std::string& text) {
  return py::module_::import("json").attr("loads")(text);
}

namespace {

py::dict FaultsOf(const DiagnosisObject& object) {
  py::dict faults;
  for (const FaultVerdict& fault : object.diagnosis.result.faults) {
    faults[fault.name.c_str()] = fault;
  }
  return faults;
}

std::string DiagnosisHtml(const DiagnosisObject& object) {
  const DiagnosisResult& result = object.diagnosis.result;
  Page page(result.setup);
  page.SetVerdict(result.detected ? Tone::kBad : Tone::kGood, DiagnosisVerdict(result));
  Table table;
  table.columns = {{"Fault"},
                   {"Value", true},
                   {"From healthy", true},
                   {"Standard deviation", true},
                   {"Detected"}};
  for (const FaultVerdict& fault : RankedFaults(result)) {
    table.rows.push_back({fault.name, Digits(fault.value),
                          FormatNumber(fault.deviation), FormatNumber(fault.sd),
                          DetectionText(fault)});
  }
  page.AddTable(table);
  for (const std::string& note : object.notes) page.AddParagraph(note);
  return NotebookHtml(page);
}

void ReportDiagnosis(const DiagnosisObject& object, const py::object& path) {
  const Diagnosis& diagnosis = object.diagnosis;
  WriteReportFile(
      DiagnosisPage(object.prepared->design, diagnosis.result, diagnosis.log,
                    {"machine.diagnose(record)",
                     "an mjdiag.Record",
                     {{"mjdiag", MJDIAG_VERSION}}}),
      path);
}

py::tuple PairOf(const Interval& interval) {
  return py::make_tuple(interval.min, interval.max);
}

void BindFault(py::module_& module) {
  py::class_<FaultVerdict>(module, "Fault",
                           R"(
                           A fault parameter as a diagnosis found it: 1 is healthy; of a
                           disturbance it is the magnitude, and 0 is healthy.)")
      .def_readonly("name", &FaultVerdict::name, "Of the fault parameter.")
      .def_readonly("value", &FaultVerdict::value, "The fault parameter.")
      .def_readonly("deviation", &FaultVerdict::deviation, "value less healthy.")
      .def_readonly("sd", &FaultVerdict::sd, "Standard deviation of value.")
      .def_property_readonly(
          "ci95", [](const FaultVerdict& fault) { return PairOf(fault.ci95); },
          "Interval (low, high) that holds the true value in 95 of 100 records.")
      .def_readonly("detected", &FaultVerdict::detected,
                    "Whether it is named as a fault.")
      .def("__repr__", [](const FaultVerdict& fault) {
        return "<mjdiag.Fault: " + fault.name + " = " + Digits(fault.value) + ", sd " +
               FormatNumber(fault.sd) + (fault.detected ? ", detected>" : ">");
      });
}

}  // namespace

void BindDiagnosis(py::module_& module) {
  BindFault(module);
  py::class_<DiagnosisObject>(module, "Diagnosis",
                              R"(
                              The answer of Machine.diagnose: is something wrong, since
                              when, which fault and how large. In a notebook it shows
                              its verdict and table.)")
      .def_property_readonly(
          "detected",
          [](const DiagnosisObject& object) {
            return object.diagnosis.result.detected;
          },
          "Whether anything is wrong.")
      .def_property_readonly("faults", &FaultsOf,
                             R"(
                             Name -> Fault of every fault parameter of the plant and
                             every disturbance of the setup.)")
      .def_property_readonly(
          "first_detection",
          [](const DiagnosisObject& object) {
            return object.diagnosis.result.first_detection;
          },
          "When the residual first left its limits, since the first sample [s]; None.")
      .def_property_readonly(
          "lasting",
          [](const DiagnosisObject& object) { return object.diagnosis.result.lasting; },
          "When its mean magnitude did, which no passing disturbance does [s]; None.")
      .def_property_readonly(
          "misfit",
          [](const DiagnosisObject& object) { return object.diagnosis.result.nis; },
          R"(
          Squared innovations of the twin over what is expected: 1 where it explains all
          that it sees.)")
      .def_property_readonly(
          "residual",
          [](const py::object& self) {
            const auto& object = py::cast<const DiagnosisObject&>(self);
            return View(object.diagnosis.log.residual, self);
          },
          "The residual of every sample, (samples,), in units of its own noise.")
      .def_property_readonly(
          "limits",
          [](const DiagnosisObject& object) {
            return PairOf(object.diagnosis.result.limits);
          },
          "Limits (low, high) of the residual.")
      .def_property_readonly(
          "verdict",
          [](const DiagnosisObject& object) {
            return DiagnosisVerdict(object.diagnosis.result);
          },
          "The answer in one sentence.")
      .def_readonly("notes", &DiagnosisObject::notes,
                    "What one should know of how a file became the record.")
      .def(
          "to_dict",
          [](const DiagnosisObject& object) {
            return ParsedJson(DiagnosisJson(object.diagnosis.result));
          },
          "All of it as a dict, schema \"mjdiag.diagnosis/1\".")
      .def("report", &ReportDiagnosis, py::arg("path"),
           "Writes one self-contained HTML page. InputError if that cannot be written.")
      .def("_repr_html_", &DiagnosisHtml)
      .def("__repr__", [](const DiagnosisObject& object) {
        return "<mjdiag.Diagnosis: " + DiagnosisVerdict(object.diagnosis.result) + ">";
      });
}

}  // namespace mjdiag::python
