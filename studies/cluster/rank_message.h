#pragma once
// What rank 0, which hands out the runs of a study, and the others say to each other.

#include <cstdint>
#include <string>
#include <vector>

namespace mjdiag {

/// Runs from `begin` to before `end`.
struct RunRange {
  std::int64_t begin = 0;
  std::int64_t end = 0;
  std::int64_t size() const { return end - begin; }
};

/// To rank 0, which answers every one with an order: so both know that the other lives.
struct RankReport {
  enum class Kind : std::uint32_t {
    kWork,    ///< as below
    kFailed,  ///< a run, or the rank's beginning, threw: it makes no more
    kLeaves,  ///< asked to end: it makes no more
    kClosed   ///< its journal is complete and closed
  };
  Kind kind = Kind::kWork;
  std::uint32_t threads = 0;       ///< that make runs; 0: not yet
  std::uint64_t study = 0;         ///< of the identity of the study, to compare
  std::vector<std::int64_t> done;  ///< since the last report
  std::int64_t run = -1;           ///< that failed; -1: the beginning
  bool bad_input = false;          ///< how it failed: InputError
  std::string text{};              ///< what it said
};

struct RankOrder {
  enum class Kind : std::uint32_t {
    kBegin,   ///< the folder is ready
    kWork,    ///< these runs, or none for now
    kClose,   ///< end what was begun, forget the rest, close the journal
    kEnd,     ///< leave
    kEndLost  ///< leave a job that has lost a rank
  };
  Kind kind = Kind::kWork;
  std::vector<RunRange> runs{};
};

std::string Packed(const RankReport& report);
std::string Packed(const RankOrder& order);
/// InputError on bytes that are none.
RankReport UnpackedReport(const std::string& bytes);
RankOrder UnpackedOrder(const std::string& bytes);

}  // namespace mjdiag
