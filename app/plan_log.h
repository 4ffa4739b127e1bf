#pragma once
// How far a study is, for whoever waits for it: a bar on a terminal, else a line on stderr
// every few seconds, and the same lines in study.log of its folder.

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include "app/progress.h"
#include "mjdiag/studies/dataset/plan_run.h"

namespace mjdiag::app {

class PlanLog {
 public:
  /// @param folder  may not be there yet
  explicit PlanLog(const std::filesystem::path& folder);

  /// From any thread, one at a time.
  void Show(const PlanProgress& progress);
  /// A line of its own, on stderr, too.
  void Note(const std::string& line);
  /// The last line.
  void End(const PlanProgress& progress);

 private:
  void Write(const PlanProgress& progress);
  void Append(const std::string& line);

  std::filesystem::path file_;
  ProgressBar bar_;
  std::ofstream log_;
  std::string doing_;
  std::chrono::steady_clock::time_point last_;
};

/// "734 of 2000 runs, 61 a second, 21 s to go".
std::string ProgressText(const PlanProgress& progress);

}  // namespace mjdiag::app
