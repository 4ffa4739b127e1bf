// Diagnosis: what has worn, and how sure that is.

#include "python/diagnosis.h"

#include <utility>

#include "mjdiag/diagnosis/diagnosis_fields.h"
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
#include "python/fields.h"
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

std::string DiagnosisHtml(const DiagnosisObject& object) {
  const DiagnosisResult& result = object.diagnosis.result;
  Page page(result.setup);
  page.SetVerdict(result.detected ? Tone::kBad : Tone::kGood, DiagnosisVerdict(result));
  page.AddTable(FaultTable(result));
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

}  // namespace

void BindDiagnosis(py::module_& module) {
  py::class_<FaultVerdict> fault(module, "Fault",
                                 R"(
                           A fault parameter as a diagnosis found it: 1 is healthy; of a
                           disturbance it is the magnitude, and 0 is healthy.)");
  BindFields<FaultVerdict>(fault).def("__repr__", [](const FaultVerdict& one) {
    return "<mjdiag.Fault: " + one.name + " = " + Digits(one.value) + ", sd " +
           FormatNumber(one.sd) + (one.detected ? ", detected>" : ">");
  });
  py::class_<DiagnosisObject> diagnosis(module, "Diagnosis",
                                        R"(
                              The answer of Machine.diagnose: is something wrong, since
                              when, which fault and how large. In a notebook it shows
                              its verdict and table.)");
  BindFields<DiagnosisResult>(
      diagnosis,
      [](const DiagnosisObject& object) -> const DiagnosisResult& {
        return object.diagnosis.result;
      })
      .def_property_readonly(
          "residual",
          [](const py::object& self) {
            const auto& object = py::cast<const DiagnosisObject&>(self);
            return View(object.diagnosis.log.residual, self);
          },
          "The residual of every sample, (samples,), in units of its own noise.")
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
