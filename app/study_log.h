#pragma once
// The tables of a study while it runs: their rows on stdout as they are finished, and in
// study.json of its folder, where they stay if it is stopped.

#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/output.h"
#include "app/progress.h"
#include "mjdiag/studies/study_table.h"

namespace mjdiag::app {

class StudyLog {
 public:
  /// @param document  study.json without its tables
  StudyLog(const OutputOptions& output, nlohmann::json document,
           const std::string& label);

  // From any thread.

  void Progress(double fraction);
  /// A table that has got a row more.
  void Show(const StudyTable& table);

  /// study.json with all tables.
  nlohmann::json Document(const std::vector<StudyTable>& tables, bool finished) const;
  /// Those tables that have not been shown. Ends the progress bar.
  std::string RestOf(const std::vector<StudyTable>& tables);

 private:
  void Print(const StudyTable& table);

  const OutputOptions& output_;
  nlohmann::json document_;
  std::mutex mutex_;
  ProgressBar bar_;
  std::vector<StudyTable> shown_;
  std::vector<std::size_t> widths_;  // of the last of them
};

}  // namespace mjdiag::app
