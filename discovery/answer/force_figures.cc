#include "mjdiag/discovery/answer/force_figures.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "mjdiag/discovery/answer/missing_share.h"
#include "mjdiag/discovery/blocks/curve_block.h"
#include "mjdiag/discovery/blocks/path_motion.h"
#include "mjdiag/discovery/law.h"
#include "mjdiag/discovery/residual_dependence/motion_variables.h"
#include "mjdiag/plugin/effects/effect.h"
#include "mjdiag/plugin/effects/number_forces.h"
#include "mjdiag/plugin/plant/tangent_coordinates.h"
#include "mjdiag/plugin/runtime/parallel.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr Index kPointsOfLaw = 3000;
constexpr Index kLeastSamples = 400;  // FindResidualDependence

const DisturbanceEstimate* ForceAt(const std::vector<DisturbanceEstimate>& forces,
                                   const std::string& joint) {
  const auto found = std::ranges::find(forces, joint, &DisturbanceEstimate::joint);
  return found == forces.end() ? nullptr : &*found;
}

std::optional<LawPlot> LawPlotOf(const AnswerData& data, const UnseenJudgement& judged,
                                 const ObservedMotion& motion, std::size_t member,
                                 const Cause& cause, const Discovery& discovery) {
  const Model& model = judged.answer.fit.model;
  const Candidate& candidate = *data.blocks[model[member].block].candidate;
  const mjModel& plant = data.machine.plant();
  LawPlot plot;
  plot.cause = CandidateName(candidate);
  plot.site = CoordinateNames(plant)[static_cast<std::size_t>(candidate.joint)];
  const DisturbanceEstimate* after = ForceAt(discovery.forces_after, plot.site);
  if (after == nullptr) return std::nullopt;
  const FilterPath& path = judged.nothing.seen;
  const auto without =
      ForcesBeside(data.With(Without(model, member)), data.run.seen, path);
  const DisturbanceEstimate& force = *ForceAt(without, plot.site);
  const bool hinge = plant.jnt_type[plant.dof_jntid[candidate.joint]] == mjJNT_HINGE;
  const auto channel = static_cast<std::size_t>(
      std::clamp<Index>(candidate.channel, 0, data.run.seen.inputs.rows() - 1));
  LawAxis axis = AxisOf(cause.effect->variable(), candidate, motion, hinge,
                        data.machine.channels().actuators[channel].unit);
  if (IsCurve(candidate)) {
    const CurveCourse course = CourseOfCurve(plant, candidate, motion);
    axis = {course.x, course.name, course.unit};
  }
  DrawLaw(axis, force, force.value - after->value, cause, plot);
  return plot;
}

}  // namespace

void DrawLaw(const LawAxis& axis, const DisturbanceEstimate& force,
             const VectorXd& explained, const Cause& cause, LawPlot& plot) {
  plot.x_name = axis.name;
  plot.x_unit = axis.unit;
  plot.y_unit = force.unit;
  const Index stride = std::max<Index>(1, axis.x.size() / kPointsOfLaw);
  const auto every = Eigen::seqN(0, axis.x.size() / stride, stride);
  plot.x = axis.x(every);
  plot.y = force.value(every);
  const Eigen::MatrixX2d curve = LawCurve(cause, axis.x, explained);
  plot.law_x = curve.col(0);
  plot.law_y = curve.col(1);
}

ObservedMotion MotionOfAnswer(const AnswerData& data, const UnseenJudgement& judged) {
  return MotionAlong(data.With(judged.answer.fit.model), data.run.seen,
                     judged.answer.seen);
}

void AddForces(const AnswerData& data, const UnseenJudgement& judged,
               Discovery& discovery) {
  const FilterPath& path = judged.nothing.seen;
  discovery.forces_before = DisturbanceEstimates(data.With({}), path);
  discovery.forces_after = discovery.forces_before;
  if (judged.answer.fit.model.empty()) return;
  try {
    discovery.forces_after =
        ForcesBeside(data.With(judged.answer.fit.model), data.run.seen, path);
  } catch (const NumericalError&) {
    discovery.notes.emplace_back(
        "behind the noise of the plant as given the machine diverges with what was "
        "found: forces that are left cannot be drawn");
  }
}

bool AddLawPlots(const AnswerData& data, const UnseenJudgement& judged,
                 const ObservedMotion& motion, const std::function<bool()>& is_over,
                 Discovery& discovery) {
  const Model& model = judged.answer.fit.model;
  std::vector<std::size_t> members;  // of every cause
  for (std::size_t m = 0; m < model.size(); ++m) {
    if (data.blocks[model[m].block].candidate) members.push_back(m);
  }
  std::vector<std::optional<LawPlot>> plots(members.size());
  std::atomic<bool> are_all = true;
  ParallelFor(static_cast<int>(plots.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    // Each takes a filter of all of the run.
    if (is_over()) {
      are_all = false;
      return;
    }
    try {
      plots[i] = LawPlotOf(data, judged, motion, members[i], discovery.causes[i].cause,
                           discovery);
    } catch (const NumericalError&) {
      // The plant diverges without this cause: there is nothing to draw.
    }
  });
  for (std::optional<LawPlot>& plot : plots) {
    if (plot) discovery.laws.push_back(std::move(*plot));
  }
  return are_all;
}

void AddResidualDependence(const AnswerData& data, const UnseenJudgement& judged,
                           const ObservedMotion& motion, Discovery& discovery) {
  const std::vector<DisturbanceEstimate>& forces = discovery.forces_after;
  if (forces.empty() || forces.front().value.size() < kLeastSamples) return;
  const DisturbanceEstimate& force = *std::ranges::max_element(
      forces, std::less<>(), [](const DisturbanceEstimate& one) {
        return one.value.norm() / std::max(one.sd, 1e-300);
      });
  const std::vector<std::string>& names = data.machine.mechanics().coordinates;
  std::vector<std::string> joints;
  for (const DisturbanceEstimate& one : forces) {
    if (std::ranges::find(names, one.joint) != names.end()) joints.push_back(one.joint);
  }
  const Index joint = std::ranges::find(names, force.joint) - names.begin();
  if (joint == std::ssize(names)) return;
  const VectorXd still =
      StillSpeeds(data.machine.plant(), judged.answer.seen.noise.reading,
                  data.run.seen.sample_time);
  const auto all = MotionVariables(data.machine, motion, joints, joint, still[joint],
                                   data.run.seen.records.size());
  const std::vector<Variable> variables(all.begin(), all.end());
  discovery.unexplained = FindResidualDependence(force.joint, force.value, force.unit,
                                                 std::max(force.sd, 1e-300), variables);
  discovery.unexplained_site = discovery.unexplained->site;
}

}  // namespace mjdiag
