#pragma once
// A diagnosis as Python has it: its answer, and what a page of it shows.

#include <pybind11/pybind11.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "mjdiag/plugin/design/diagnosis.h"
#include "mjdiag/report/page/page.h"
#include "python/machine.h"

namespace mjdiag::python {

struct DiagnosisObject {
  std::shared_ptr<const PreparedDiagnosis> prepared;
  Diagnosis diagnosis;
  std::vector<std::string> notes;  ///< on how a file became the record
};

/// What `Machine.diagnose` is asked for, and whatever else makes filters.
struct DiagnoseRequest {
  bool linear = false;
  std::string filters;  ///< path, or empty
  bool baseline = false;
  std::string robust;  ///< fault, or empty
  int nominal_runs = NominalRuns{}.runs;

  bool IsUsual() const;
};

/// Of keyword arguments. InputError.
/// @param filters  path or None
DiagnoseRequest RequestOf(bool linear, const pybind11::object& filters, bool baseline,
                          const std::string& robust, int nominal_runs);

/// Filters and limits as that asks for them, kept for the next call if it is usual.
/// @param motion  gives what is going to be diagnosed, where that matters
std::shared_ptr<const PreparedDiagnosis> PreparedFor(
    const MachineObject& machine, const DiagnoseRequest& request,
    const std::function<Excitation()>& motion, LongCall& call);

DiagnosisObject DiagnoseRecord(const MachineObject& machine, MeasuredFile measured,
                               const DiagnoseRequest& request, LongCall& call);

/// Verdict and tables of a page, for a notebook.
std::string NotebookHtml(const Page& page);
/// The report of a page, into a file. InputError if it cannot be written.
void WriteReportFile(const Page& page, const pybind11::object& path);
/// A JSON document as Python has it.
pybind11::object ParsedJson(const std::string& text);

}  // namespace mjdiag::python
