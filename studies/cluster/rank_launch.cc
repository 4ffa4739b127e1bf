#include "mjdiag/studies/cluster/rank_launch.h"

#include <array>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>

#include "mjdiag/signals/error.h"
#include "mjdiag/signals/loaded_module.h"

namespace mjdiag {
namespace {

std::optional<int> Number(const char* name) {
  const char* text = std::getenv(name);
  if (text == nullptr || *text == '\0') return std::nullopt;
  char* end = nullptr;
  const long number = std::strtol(text, &end, 10);
  if (*end != '\0' || number < 0) return std::nullopt;
  return static_cast<int>(number);
}

}  // namespace

RankLaunch FindLaunch() {
  constexpr std::array<std::pair<const char*, const char*>, 3> kNames = {
      {{"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"},  // Open MPI
       {"PMI_RANK", "PMI_SIZE"},                          // MPICH and its relatives
       {"PMIX_RANK", "SLURM_STEP_NUM_TASKS"}}};           // srun --mpi=pmix
  for (const auto& [rank, ranks] : kNames) {
    const auto number = Number(rank);
    const auto count = Number(ranks);
    if (number && count && *number < *count) return {*number, *count};
  }
  return {};
}

std::unique_ptr<RankLink> JoinLaunch() {
  const RankLaunch launch = FindLaunch();
  if (launch.ranks == 1) return nullptr;
  const auto make = reinterpret_cast<RankLink* (*)()>(FunctionOf(
      {"libmjdiag-mpi.so", "MJDIAG_MPI_MODULE", kRankLinkFunction, true},
      "as this process is one of several, the module of MPI (package mjdiag-mpi, or a "
      "build with libopenmpi-dev) of this version and the MPI that it was built for, "
      "or "
      "one process without mpirun"));
  std::unique_ptr<RankLink> link(make());
  if (!link || link->ranks() != launch.ranks || link->rank() != launch.rank) {
    throw InputError("MPI",
                     "the launcher started " + std::to_string(launch.ranks) +
                         " ranks, the module " + "of mjdiag finds " +
                         std::to_string(link ? link->ranks() : 0),
                     "the launcher of the MPI that the module was built for");
  }
  return link;
}

}  // namespace mjdiag
