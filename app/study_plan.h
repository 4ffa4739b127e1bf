#pragma once
// `mjdiag study --plan`: a study of one's own, by one process or by the ranks of a job.

#include <string>

#include "app/output.h"
#include "mjdiag/studies/cluster/shared_runs.h"

namespace mjdiag::app {

struct PlanCommand {
  std::string file;                 ///< the plan
  bool resume = false;              ///< go on with the runs that are there, as without
  bool restart = false;             ///< forget them
  int threads = 0;                  ///< 0: as many as there are cores for this process
  double patience = kRankPatience;  ///< with a rank that does not answer [s]
};

/// Whether this process is a rank other than the first of such a study, which leaves all
/// words and the exit status to the first.
bool IsSilentRank(int argc, char** argv);

/// Goes on with the runs of the folder, if there are some; Ctrl-C ends it with those.
void RunPlanFile(const PlanCommand& command, const OutputOptions& output);

}  // namespace mjdiag::app
