#pragma once
// Whether a launcher (mpirun, mpiexec, srun) started this process as one of several, and
// the link to the others.

#include <memory>

#include "mjdiag/studies/cluster/rank_link.h"

namespace mjdiag {

struct RankLaunch {
  int rank = 0;
  int ranks = 1;
};

/// By what launchers leave in the environment, without MPI.
RankLaunch FindLaunch();

/// Loads the module of MPI and joins the job; none for a process that is alone. The module
/// is the file that MJDIAG_MPI_MODULE names, else libmjdiag-mpi.so beside the program or in
/// its library folder. InputError if there is none, or if its MPI is not the launcher's.
std::unique_ptr<RankLink> JoinLaunch();

}  // namespace mjdiag
