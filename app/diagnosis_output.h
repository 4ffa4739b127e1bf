#pragma once
// What `diagnose` and `simulate --diagnose` have in common: where the diagnosis comes
// from and how its answer is shown.

#include <CLI/CLI.hpp>
#include <string>

#include "app/output.h"
#include "app/subject.h"
#include "mjdiag/plugin/design/diagnosis.h"

namespace mjdiag::app {

void AddDiagnosisOptions(CLI::App& command, DiagnosisSource& source);

/// PrepareDiagnosis with a progress bar for the healthy runs.
PreparedDiagnosis Prepare(const Machine& machine, DiagnosisSource source,
                          const Excitation& motion);

/// The page of a diagnosis.
NamedPage PageOf(const DiagnosisDesign& design, const Diagnosis& diagnosis,
                 const std::string& record);

/// The table for people.
std::string DiagnosisText(const DiagnosisResult& result);

}  // namespace mjdiag::app
