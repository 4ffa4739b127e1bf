#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>
#include <string>

#include "app/command.h"
#include "app/exit_status.h"
#include "app/output.h"
#include "app/study_plan.h"
#include "mjdiag/signals/error.h"
#include "mjdiag/signals/freed_memory.h"

namespace mjdiag::app {
namespace {

std::string command_line;

// The first rank has failed as this one, and says so.
bool is_silent = false;

/// A word as a POSIX shell takes it back.
std::string Quoted(const std::string& word) {
  const std::string plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=,:@+%";
  if (!word.empty() && word.find_first_not_of(plain) == word.npos) return word;
  std::string quoted = "'";
  for (const char c : word) {
    quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return quoted + "'";
}

void RememberCommandLine(int argc, char** argv) {
  for (int i = 0; i < argc; ++i) {
    command_line += (i == 0 ? "" : " ") + Quoted(argv[i]);
  }
}

/// CLI11 only says that a command is required when it does not know the one given.
void RequireKnownCommand(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return;
  std::string known;
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    if (command->get_name() == argv[1]) return;
    known += (known.empty() ? "" : ", ") + command->get_name();
  }
  if (std::string(argv[1]) == "watch") {
    throw InputError("command line", "this mjdiag was built without 'watch'",
                     "one that was built where libcpp-httplib-dev is installed");
  }
  throw InputError("command line", std::string("no command '") + argv[1] + "'",
                   "one of " + known);
}

int Fail(ExitStatus status, const std::string& message) {
  if (is_silent) return static_cast<int>(ExitStatus::kDone);
  DiscardOutput();
  std::string line = message;
  std::replace(line.begin(), line.end(), '\n', ' ');
  std::fprintf(stderr, "mjdiag: %s\n", line.c_str());
  return static_cast<int>(status);
}

int Main(int argc, char** argv) {
  KeepFreedMemory();
  RememberCommandLine(argc, argv);
  is_silent = IsSilentRank(argc, argv);
  CLI::App app{"Fault diagnosis and model discovery for machines that move"};
  app.set_version_flag("--version", "mjdiag " MJDIAG_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit status: 0 done, 1 done and the answer is negative, 2 bad input or usage, "
      "3 numerical failure, 130 or 143 ended by SIGINT or SIGTERM with the answer so "
      "far.");
  AddInit(app);
  AddSimulate(app);
  AddLinearize(app);
  AddDesign(app);
  AddDiagnose(app);
  AddCalibrate(app);
  AddCompare(app);
  AddDiscover(app);
  AddRender(app);
  AddStudy(app);
  AddExcite(app);
  AddReport(app);
#ifdef MJDIAG_HAS_WATCH
  AddWatch(app);
#endif
  try {
    RequireKnownCommand(app, argc, argv);
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    return Fail(ExitStatus::kBadInput, std::string(error.what()) + "; see --help");
  } catch (const NegativeAnswer&) {
    return static_cast<int>(ExitStatus::kNegative);
  } catch (const Interrupted& interrupted) {
    return interrupted.Status();
  } catch (const InputError& error) {
    return Fail(ExitStatus::kBadInput, error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    return Fail(ExitStatus::kBadInput, error.what());
  } catch (const std::bad_alloc&) {
    return Fail(ExitStatus::kNumericalFailure, "out of memory; expected more of it");
  } catch (const std::exception& error) {
    return Fail(ExitStatus::kNumericalFailure, error.what());
  }
  return static_cast<int>(ExitStatus::kDone);
}

}  // namespace

const std::string& CommandLine() { return command_line; }

}  // namespace mjdiag::app

// Nothing thrown outside its try is for a user: it ends the process.
// NOLINTNEXTLINE(bugprone-exception-escape)
int main(int argc, char** argv) { return mjdiag::app::Main(argc, argv); }
