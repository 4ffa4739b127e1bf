// Plans of studies of the machine of stage/.

#include "fuzz/target.h"
#include "mjdiag/studies/plan/planned_run.h"

namespace mjdiag::fuzz {

void FuzzPlan(Input input) {
  Done([&] {
    const LoadedPlan loaded = ParsePlan(std::string(TextOf(input)), Folder());
    const RunPlanner planner(loaded.plan);
    for (const std::int64_t run : {std::int64_t{0}, planner.runs() - 1}) {
      const PlannedRun planned = planner.Run(run);
      Require(planner.ValuesOf(planned).size() == planner.columns().size() &&
                  planner.TimesOf(planned).size() == planner.columns().size(),
              "a run without a value for every axis");
    }
  });
}

}  // namespace mjdiag::fuzz
