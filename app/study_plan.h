#pragma once
// `mjdiag study --plan`: a study of one's own.

#include <string>

#include "app/output.h"

namespace mjdiag::app {

struct PlanCommand {
  std::string file;      ///< the plan
  bool resume = false;   ///< go on with the runs that are there, as without
  bool restart = false;  ///< forget them
};

/// Goes on with the runs of the folder, if there are some; Ctrl-C ends it with those.
void RunPlanFile(const PlanCommand& command, const OutputOptions& output);

}  // namespace mjdiag::app
