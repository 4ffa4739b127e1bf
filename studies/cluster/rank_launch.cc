#include "mjdiag/studies/cluster/rank_launch.h"

#include <dlfcn.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

namespace fs = std::filesystem;

constexpr const char* kModule = "libmjdiag-mpi.so";

std::optional<int> Number(const char* name) {
  const char* text = std::getenv(name);
  if (text == nullptr || *text == '\0') return std::nullopt;
  char* end = nullptr;
  const long number = std::strtol(text, &end, 10);
  if (*end != '\0' || number < 0) return std::nullopt;
  return static_cast<int>(number);
}

std::vector<fs::path> Places() {
  if (const char* named = std::getenv("MJDIAG_MPI_MODULE")) return {named};
  std::error_code ignored;
  const fs::path folder = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  return {folder / kModule, folder / MJDIAG_LIBRARIES / "mjdiag" / kModule};
}

std::string LastError() {
  const char* error = dlerror();
  return error == nullptr ? "cannot be loaded" : error;
}

using MakeLink = RankLink*();

MakeLink* LoadModule() {
  for (const fs::path& file : Places()) {
    if (!fs::exists(file)) continue;
    // MPI libraries load parts of themselves, which look for names of the whole.
    void* module = dlopen(file.c_str(), RTLD_NOW | RTLD_GLOBAL);
    void* make = module == nullptr ? nullptr : dlsym(module, kRankLinkFunction);
    if (make == nullptr) {
      throw InputError(file.string(), LastError(),
                       "a module of this version, and the MPI that it was built for");
    }
    return reinterpret_cast<MakeLink*>(make);
  }
  throw InputError(
      Places().front().string(), "is not there, and this process is one of several",
      "the module of MPI (package mjdiag-mpi, or a build with libopenmpi-dev), or one "
      "process without mpirun");
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
  std::unique_ptr<RankLink> link(LoadModule()());
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
