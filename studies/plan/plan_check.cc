#include "mjdiag/studies/plan/plan_check.h"

#include <algorithm>
#include <limits>
#include <set>

#include "mjdiag/signals/error.h"
#include "mjdiag/studies/plan/planned_run.h"
#include "mjdiag/studies/plan/run_machine.h"

namespace mjdiag {
namespace {

constexpr int kTicks = 4;
constexpr std::int64_t kTrials = 4;  // of every case

/// Numbers of runs of that case on the first machine: the first, the last and some
/// between.
std::set<std::int64_t> CandidateRegressors(const StudyPlan& plan, std::size_t in_case) {
  const auto of_a_point =
      static_cast<std::int64_t>(plan.motions.size()) * plan.replications;
  std::int64_t first = 0;
  for (std::size_t i = 0; i < in_case; ++i) first += plan.cases[i].points * of_a_point;
  const std::int64_t last = plan.cases[in_case].points * of_a_point - 1;
  std::set<std::int64_t> trials;
  for (std::int64_t i = 0; i < kTrials; ++i) {
    trials.insert(first + i * last / (kTrials - 1));
  }
  return trials;
}

void CheckTimes(const PlanCase& one, double shortest, const std::string& where) {
  for (const PlanAxis& axis : one.axes) {
    if (!axis.appears || axis.appears->to < shortest) continue;
    throw InputError(
        where + ": axis '" + axis.name + "'",
        "appears after the end of a run of " + std::to_string(shortest) + " s",
        "an earlier time, or longer runs");
  }
}

}  // namespace

void CheckPlan(const LoadedPlan& loaded, const std::string& where) {
  double shortest = std::numeric_limits<double>::infinity();
  const RunMaker whole(loaded);
  for (const Excitation& motion : whole.motions()) {
    shortest = std::min(shortest, static_cast<double>(motion.samples()) *
                                      loaded.machine.rates().tick());
  }
  LoadedPlan brief = loaded;
  brief.plan.duration = kTicks * loaded.machine.rates().tick();
  const RunPlanner planner(brief.plan);
  const RunMaker maker(brief);
  for (std::size_t i = 0; i < loaded.plan.cases.size(); ++i) {
    const PlanCase& one = loaded.plan.cases[i];
    const std::string place = where + ": case '" + one.name + "'";
    CheckTimes(one, shortest, place);
    if (one.points == 0) continue;  // of no disturbances, for example
    try {
      for (const std::int64_t trial : CandidateRegressors(brief.plan, i)) {
        maker.Simulate(planner.Run(trial));
      }
    } catch (const InputError& error) {
      throw InputError(place + ": " + error.what());
    }
  }
}

}  // namespace mjdiag
