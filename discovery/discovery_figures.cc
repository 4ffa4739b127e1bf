#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "mjdiag/comparison/missing_force.h"
#include "mjdiag/discovery/answer/force_figures.h"
#include "mjdiag/discovery/discoverer.h"
#include "mjdiag/discovery/fault_limits.h"
#include "mjdiag/discovery/law.h"
#include "mjdiag/discovery/mismatch_figures.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/plant/mujoco_model.h"
#include "mjdiag/plugin/replay/noise_fit.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::vector<std::string> DrivenNames(const MechanicalModel& model) {
  std::vector<std::string> names;
  std::set<Index> seen;
  for (const Index joint : DrivenJoints(model)) {
    if (!seen.insert(joint).second) continue;
    names.push_back(model.coordinates[static_cast<std::size_t>(joint)]);
  }
  return names;
}

}  // namespace

std::vector<UnknownSignal> Discoverer::UnexplainedIn(const Track& track,
                                                     const Changes& changes) const {
  std::vector<std::string> joints = DrivenNames(problem_.machine().linear());
  joints.resize(std::min<std::size_t>(
      joints.size(), static_cast<std::size_t>(problem_.run().outputs.rows())));
  std::vector<std::string> units;
  for (const std::string& joint : joints) {
    const int id = FindElement(machine_.plant(), mjOBJ_JOINT, joint);
    units.emplace_back(machine_.plant().jnt_type[id] == mjJNT_HINGE ? "N m" : "N");
  }
  if (problem_.observer().following) {
    const MeasuredRun& run = problem_.run();
    if (!filter_) {
      filter_ = FilterLikeliest(problem_.machine(), run, problem_.observer().noise_sd);
    }
    const Machine machine = problem_.machine().With(changes);
    return SignalsOf(
        MissingForces(machine, RunForceFilter(machine, run, filter_->dofs,
                                              filter_->starts, filter_->noise)),
        run.sample_time);
  }
  return UnexplainedForces(problem_.machine().linear(), problem_.observer(),
                           problem_.step(), machine_.rates().substeps,
                           track.innovations, joints, units);
}

void Discoverer::FindWhere(const Track& nominal, const Track& final) {
  discovery_.forces_before = UnexplainedIn(nominal, {});
  discovery_.forces_after = discovery_.causes.empty() ? discovery_.forces_before
                                                      : UnexplainedIn(final, changes_);
}

void Discoverer::SignRest(const ObservedMotion& motion) {
  if (discovery_.verdict != DiscoveryVerdict::kUnexplained &&
      discovery_.verdict != DiscoveryVerdict::kPartlyExplained) {
    return;
  }
  // Beside a curve noise may be all that is left.
  if (!IsMoreLeft(search_)) return;
  const Rest rest = SignatureOf(motion, discovery_.forces_after, false);
  discovery_.unexplained = rest.signature;
  discovery_.unexplained_site = rest.signature.site;
}

/// Partial residuals: with several causes at a joint, the force that all of them
/// explain lies on the law of none.
LawPlot Discoverer::PlotLaw(const ObservedMotion& motion, std::size_t cause) const {
  const Candidate& candidate = candidates_[search_.fit().causes[cause].candidate];
  LawPlot plot;
  plot.cause = Describe(candidate);
  plot.site = problem_.machine()
                  .linear()
                  .coordinates[static_cast<std::size_t>(candidate.joint)];
  const auto at = [&](const std::vector<UnknownSignal>& forces) {
    return std::ranges::find(forces, plot.site, &UnknownSignal::site);
  };
  if (at(discovery_.forces_before) == discovery_.forces_before.end()) return plot;
  const std::vector<FittedCause> others = Without(search_.fit().causes, {cause});
  const Changes rest =
      ChangesOf(problem_, candidates_, {others, search_.fit().numbers});
  const auto forces = others.empty() ? discovery_.forces_before
                                     : UnexplainedIn(problem_.Follow(rest), rest);
  const UnknownSignal& without = *at(forces);
  const VectorXd explained = without.value - at(discovery_.forces_after)->value;

  const bool hinge =
      machine_.plant().jnt_type[machine_.plant().dof_jntid[candidate.joint]] ==
      mjJNT_HINGE;
  const auto channel = static_cast<std::size_t>(
      std::clamp<Index>(candidate.channel, 0, problem_.run().inputs.rows() - 1));
  const Cause& named = discovery_.causes[cause].cause;
  const auto learned = curves_.find(search_.fit().causes[cause].candidate);
  const LawAxis axis = learned != curves_.end()
                           ? learned->second.axis
                           : AxisOf(named.effect->variable(), candidate, motion, hinge,
                                    machine_.channels().actuators[channel].unit);
  DrawLaw(axis, without, explained, named, plot);
  return plot;
}

void Discoverer::AddLaws(const ObservedMotion& motion) {
  discovery_.laws.resize(
      std::min(search_.fit().causes.size(), discovery_.causes.size()));
  ParallelFor(static_cast<int>(discovery_.laws.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    try {
      discovery_.laws[i] = PlotLaw(motion, i);
    } catch (const NumericalError&) {
      // The plant diverges without this cause: there is nothing to draw.
    }
  });
  std::erase_if(discovery_.laws, [](const LawPlot& law) { return law.x.size() == 0; });
}

/// Every step behind the same observer, or they would not compare.
void Discoverer::AddLadder() {
  std::vector<std::pair<std::string, Changes>> steps = {{"nothing", {}}};
  if (search_.numbers_alone.size() > 0) {
    steps.emplace_back("numbers of the plant",
                       problem_.WithNumbers({}, search_.numbers_alone));
  }
  for (const FittedModel& step : search_.ladder) {
    steps.emplace_back(Describe(candidates_[step.causes.back().candidate]),
                       ChangesOf(problem_, candidates_, step));
  }
  if (!discovery_.causes.empty()) steps.emplace_back("all, fitted together", changes_);
  discovery_.ladder.resize(steps.size());
  for (std::size_t i = 0; i < steps.size(); ++i) {
    discovery_.ladder[i].added = steps[i].first;
  }
  // What no fit saw is the end of one record, or records of their own.
  const Index samples = problem_.run().samples();
  std::optional<DiscoveryProblem> unseen;
  if (problem_.train() == samples && !measurements_.unseen.empty()) {
    unseen = problem_.WithRun(RunOf(measurements_.unseen));
  }
  // One replay each: the cores come to their end together.
  const int replays = measurements_.unseen.empty() ? 2 : 3;
  work_->Add((replays - 1) * static_cast<double>(steps.size()) * problem_.RunWork());
  ParallelFor(replays * static_cast<int>(steps.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number / replays);
    const Changes& changes = steps[i].second;
    LadderStep& entry = discovery_.ladder[i];
    if (number % replays == 0) {
      const VectorXd rest = problem_.Residual(changes);
      entry.train =
          std::sqrt(MeanSquare(problem_, rest, problem_.skip(), problem_.train()));
      entry.held_out =
          std::sqrt(unseen ? MeanSquare(*unseen, unseen->Residual(changes),
                                        unseen->skip(), unseen->run().samples())
                           : MeanSquare(problem_, rest, problem_.train(), samples));
    } else if (falls_) {
      // No free simulation of it says anything.
    } else if (number % replays == 1) {
      entry.error_percent = MeanReplayErrors(measurements_.fit, changes);
    } else {
      entry.validation_percent = MeanReplayErrors(measurements_.unseen, changes);
    }
  });
}

void Discoverer::AddComparisons() {
  work_->Add(2.0 * problem_.RunWork());
  discovery_.records = ReplayAll(measurements_, changes_, options_.seed, falls_);
  const Index skip = problem_.skip();
  AddMismatchFigures(skip, discovery_);
}

void Discoverer::AddLimits() {
  // Of all faults, whatever causes were looked for.
  const std::vector<Candidate> candidates = ListCandidates(machine_);
  const auto before = FaultLimits(problem_, candidates, {});
  const auto after = FaultLimits(problem_, candidates, changes_);
  for (const auto& [fault, limit] : before) {
    const auto now = after.find(fault);
    if (now == after.end()) continue;
    discovery_.fault_limits.push_back({fault, limit, now->second});
  }
}

}  // namespace mjdiag
