// The module that binds ranks by MPI: the only file that includes it.

#include <mpi.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <list>

#include "mjdiag/studies/cluster/rank_link.h"

namespace mjdiag {
namespace {

constexpr int kTag = 383;
constexpr int kLostJob = 3;           // exit status of a job without rank 0
constexpr unsigned kAbortWait = 600;  // s

/// Ends a job with a rank that answers no more, for which MPI_Finalize would wait.
void EndJob(int status, void* rank) {
  std::fflush(nullptr);
  if (rank == nullptr) {
    MPI_Abort(MPI_COMM_WORLD, status);
  } else {
    sleep(kAbortWait);
  }
  _exit(status);
}

class MpiLink : public RankLink {
 public:
  MpiLink() {
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks_);
    // Where the launcher keeps a job whose rank died, the others go on.
    MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
  }

  int rank() const override { return rank_; }
  int ranks() const override { return ranks_; }

  void Send(int to, const std::string& bytes) override {
    CollectSent();
    Sent& sent = sent_.emplace_back();
    sent.bytes = bytes;
    const int status = MPI_Isend(sent.bytes.data(), static_cast<int>(sent.bytes.size()),
                                 MPI_BYTE, to, kTag, MPI_COMM_WORLD, &sent.request);
    if (status != MPI_SUCCESS) sent_.pop_back();
  }

  std::optional<RankMessage> Receive() override {
    int is_there = 0;
    MPI_Message message = MPI_MESSAGE_NULL;
    MPI_Status status;
    if (MPI_Improbe(MPI_ANY_SOURCE, kTag, MPI_COMM_WORLD, &is_there, &message,
                    &status) != MPI_SUCCESS ||
        is_there == 0) {
      return std::nullopt;
    }
    int size = 0;
    MPI_Get_count(&status, MPI_BYTE, &size);
    RankMessage received{status.MPI_SOURCE,
                         std::string(static_cast<std::size_t>(size), '\0')};
    if (MPI_Mrecv(received.bytes.data(), size, MPI_BYTE, &message, &status) !=
        MPI_SUCCESS) {
      return std::nullopt;
    }
    return received;
  }

  void Leave(bool together) override {
    if (!together) {
      on_exit(EndJob, rank_ == 0 ? nullptr : this);
      return;
    }
    for (Sent& sent : sent_) MPI_Wait(&sent.request, MPI_STATUS_IGNORE);
    sent_.clear();
    MPI_Finalize();
  }

  void Abort() override { MPI_Abort(MPI_COMM_WORLD, kLostJob); }

 private:
  struct Sent {
    std::string bytes;
    MPI_Request request = MPI_REQUEST_NULL;
  };

  void CollectSent() {
    for (auto sent = sent_.begin(); sent != sent_.end();) {
      int is_done = 0;
      MPI_Test(&sent->request, &is_done, MPI_STATUS_IGNORE);
      sent = is_done != 0 ? sent_.erase(sent) : std::next(sent);
    }
  }

  int rank_ = 0;
  int ranks_ = 1;
  std::list<Sent> sent_;
};

}  // namespace
}  // namespace mjdiag

extern "C" __attribute__((visibility("default"))) mjdiag::RankLink* mjdiag_rank_link();

mjdiag::RankLink* mjdiag_rank_link() {
  int provided = 0;
  if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided) !=
      MPI_SUCCESS) {
    return nullptr;
  }
  return new mjdiag::MpiLink;
}
