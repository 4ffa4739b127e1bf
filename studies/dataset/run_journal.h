#pragma once
// The results of a study while it runs, in one file that is only ever appended to: when
// the process is killed, at any moment, all runs that had been finished are in it, but
// for one that was being written, which is cut off when the file is opened again.
//
//   "mjdiag.journal/1\n"
//   identity  uint64 size, bytes: what was asked for, to the last digit
//   entries   uint32 mark, uint32 checksum (CRC-32) of all that follows, int64 number of
//             the run, uint64 size of its result, uint64 size of its series, result,
//             and of every series uint64 size and bytes
//
// in the byte order of the machine. Entries are in the order in which runs were finished.

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "mjdiag/studies/dataset/run_result.h"

namespace mjdiag {

class RunJournal {
 public:
  enum class Access {
    kWrite,  ///< opens the file, or makes it; InputError if a process is at work in it
    kRead    ///< of a file that is there, as far as it is written, be it by a process
  };

  /// InputError if the file is of another study or cannot be opened that way.
  RunJournal(std::filesystem::path file, const std::string& identity, std::int64_t runs,
             Access access = Access::kWrite);
  ~RunJournal();
  RunJournal(const RunJournal&) = delete;
  RunJournal& operator=(const RunJournal&) = delete;

  /// Removes the file, if there is one. InputError if a process is at work in it.
  static void Remove(const std::filesystem::path& file);

  /// Whether that run is in it; `with_series`: with its series.
  bool Has(std::int64_t index, bool with_series) const;
  /// Appends the result, from any thread. InputError if the disk is full.
  void Add(std::int64_t index, const RunResult& result);
  /// All runs that it has, in their order.
  std::vector<std::int64_t> Runs() const;
  /// The result of a run that it has, without series; with them.
  const RunResult& Result(std::int64_t index) const;
  std::vector<std::string> ReadSeries(std::int64_t index) const;

  /// Whether there is a series in it.
  bool HoldsSeries() const;
  /// Leaves the series out, which are elsewhere now, and takes in what `others` have: a
  /// new file in its place.
  void Settle(const std::vector<const RunJournal*>& others = {});

 private:
  struct Place {
    std::uint64_t offset = 0;  // of the series in the file
    std::uint64_t size = 0;
    RunResult result;
  };

  void Open();
  void ReadEntries(std::uint64_t from, std::uint64_t size);
  void Append(std::int64_t index, const RunResult& result, const std::string& series);
  [[noreturn]] void Fail(const std::string& what, const std::string& expected) const;

  std::filesystem::path file_;
  std::string identity_;
  std::int64_t runs_;
  Access access_;
  int descriptor_ = -1;
  std::uint64_t end_ = 0;
  std::map<std::int64_t, Place> places_;
  std::mutex mutex_;
};

}  // namespace mjdiag
