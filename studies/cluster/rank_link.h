#pragma once
// What processes of one job, on one computer or on many, need of each other: a number
// each, and short messages. MPI is behind it in a module of its own (mpi/mpi_link.cc),
// which is loaded where a launcher started the process (rank_launch.h); tests put threads
// in its place. All calls come from one thread.

#include <optional>
#include <string>

namespace mjdiag {

struct RankMessage {
  int from = 0;
  std::string bytes;
};

class RankLink {
 public:
  virtual ~RankLink() = default;

  /// Of this process, from 0; 0 leads.
  virtual int rank() const = 0;
  virtual int ranks() const = 0;

  /// Does not wait for whoever is to get it, who may be dead: then it is lost.
  virtual void Send(int to, const std::string& bytes) = 0;
  /// A message that is there, if one is. Those of one sender come in their order.
  virtual std::optional<RankMessage> Receive() = 0;

  /// The last call. `together`: all other ranks make it, too, and wait for each other.
  /// Else somebody is lost: when this process exits, rank 0 ends the whole job with its
  /// own exit status, and others wait for that.
  virtual void Leave(bool together) = 0;
  /// Ends the job at once, for a rank that has lost rank 0.
  virtual void Abort() = 0;
};

/// What a module has under this name: RankLink* mjdiag_rank_link(void), to be deleted by
/// the caller; null if it finds no job.
inline constexpr const char* kRankLinkFunction = "mjdiag_rank_link";

}  // namespace mjdiag
