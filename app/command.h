#pragma once
// The subcommands of `mjdiag`: one file each, added to the parser by one function each.

#include <CLI/CLI.hpp>

namespace mjdiag::app {

void AddInit(CLI::App& app);
void AddSimulate(CLI::App& app);
void AddLinearize(CLI::App& app);
void AddDesign(CLI::App& app);
void AddDiagnose(CLI::App& app);
void AddCalibrate(CLI::App& app);
void AddCompare(CLI::App& app);
void AddDiscover(CLI::App& app);
void AddRender(CLI::App& app);
void AddStudy(CLI::App& app);
void AddExcite(CLI::App& app);
void AddReport(CLI::App& app);
#ifdef MJDIAG_HAS_WATCH
void AddWatch(CLI::App& app);
#endif

/// The command line as it was typed, for files that say how they were made.
const std::string& CommandLine();

}  // namespace mjdiag::app
