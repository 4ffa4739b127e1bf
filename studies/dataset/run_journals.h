#pragma once
// All journals of a study in its folder: runs.journal, and runs.<k>.journal of every rank
// k > 0 that made runs of it, in this job or one before. Each is written by one process,
// and only rank 0 reads all. Once the data set is there, all is in runs.journal.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "mjdiag/studies/dataset/run_journal.h"

namespace mjdiag {

class RunJournals {
 public:
  /// Opens runs.journal to write, all others to read. InputError as RunJournal.
  RunJournals(std::filesystem::path folder, std::string identity, std::int64_t runs);

  /// Removes all of them. InputError if a process is at work in one.
  static void Remove(const std::filesystem::path& folder);
  /// The file of a rank.
  static std::filesystem::path FileOf(const std::filesystem::path& folder, int rank);

  /// Reads again what other processes write.
  void ReadOthers();

  bool Has(std::int64_t index, bool with_series) const;
  void Add(std::int64_t index, const RunResult& result) { own_.Add(index, result); }
  const RunResult& Result(std::int64_t index) const;
  std::vector<std::string> ReadSeries(std::int64_t index) const;

  /// All results in runs.journal, without series, which are elsewhere now; no others.
  void Settle();

 private:
  const RunJournal* Find(std::int64_t index, bool with_series) const;

  std::filesystem::path folder_;
  std::string identity_;
  std::int64_t runs_;
  RunJournal own_;
  std::vector<std::unique_ptr<RunJournal>> others_;
  std::vector<const RunJournal*> where_;  // by number of the run, of the others
};

}  // namespace mjdiag
