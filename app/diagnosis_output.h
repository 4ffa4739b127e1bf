#pragma once
// What `diagnose` and `simulate --diagnose` have in common: where the diagnosis comes
// from and how its answer is shown.

#include <CLI/CLI.hpp>
#include <string>

#include "app/subject.h"
#include "app/output.h"
#include "mjdiag/diagnosis/diagnosis_result.h"
#include "mjdiag/plugin/design/filter_design.h"

namespace mjdiag::app {

struct DiagnosisSource {
  std::string filters;    ///< filters.json; empty: designed on the spot
  bool baseline = false;  ///< subtract what the healthy plant leaves on this motion
  std::string robust;     ///< fault for which the row is made robust; empty: none
  int runs = 5;           ///< nominal runs a limit comes from
};

void AddDiagnosisOptions(CLI::App& command, DiagnosisSource& source);

/// A diagnosis and what to subtract from its residuals.
struct ReadyDiagnosis {
  DiagnosisDesign design;
  Eigen::MatrixXd baseline;
  NominalRuns runs;  ///< what healthy runs of this motion are made with
};

/// From the file or designed, with limits; for this motion if a baseline is wanted.
/// InputError if the file belongs to other channels or another rate than the setup.
ReadyDiagnosis PrepareDiagnosis(const DiagnosisSource& source, const Machine& machine,
                                const Excitation& excitation, bool linear);

/// What the monitor says at the end of its run; against a baseline, without the cross
/// terms of large faults.
DiagnosisResult Conclude(const ReadyDiagnosis& ready, const Machine& machine,
                         const Excitation& excitation, const DiagnosisMonitor& monitor);

/// The page of a diagnosis.
NamedPage PageOf(const DiagnosisDesign& design, const DiagnosisMonitor& monitor,
                 const DiagnosisResult& result, const std::string& record);

/// The table for people.
std::string Describe(const DiagnosisResult& result);

}  // namespace mjdiag::app
