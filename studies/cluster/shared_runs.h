#pragma once
// The runs of a study, made by all ranks of a job. Rank 0 hands out their numbers
// (run_schedule.h) and makes runs itself; results are no messages, each rank keeps its own.
//
// A rank whose run throws makes no more runs, and another one repeats that run; the study
// ends with what was thrown when a run failed on two ranks, or no rank is left. A rank that
// is silent for too long is lost, its runs are repeated. If it comes back, it is given runs
// again.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "mjdiag/studies/cluster/rank_team.h"
#include "mjdiag/studies/cluster/run_pool.h"

namespace mjdiag {

inline constexpr double kRankPatience = 30.0;  // s

struct LeadOptions {
  std::vector<std::int64_t> open;  ///< runs to make, increasing
  std::int64_t runs = 0;           ///< of the study
  std::uint64_t study = 0;         ///< of its identity, which the others' must be
  double patience = kRankPatience;
  /// Now and then, from the caller's thread: runs made so far. What it throws ends the
  /// making of runs on all ranks.
  std::function<void(std::int64_t made, bool prepared)> tell;
  /// What became of a rank, in a line.
  std::function<void(const std::string& line)> note;
};

/// On rank 0. When it returns or throws, no rank makes runs any more, and all that answer
/// have closed what they keep results in.
void LeadRuns(RankTeam& team, RunPool& pool, const LeadOptions& options);

/// On another rank: makes runs until rank 0 says that it is enough, and stops the pool.
/// @param wish  whether this process was asked to end: then it makes no more
/// @return the runs that rank 0 was not told of, for ReportClosed
std::vector<std::int64_t> MakeRuns(RankTeam& team, RunPool& pool, std::uint64_t study,
                                   double patience, const std::function<bool()>& wish);
/// On another rank, when its results are on disk.
void ReportClosed(RankTeam& team, const std::vector<std::int64_t>& done);
/// On another rank that cannot take part: says why, and waits till the others are done.
void ReportFailedBeginning(RankTeam& team, std::exception_ptr failure, double patience);

}  // namespace mjdiag
