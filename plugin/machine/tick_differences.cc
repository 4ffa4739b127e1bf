#include "mjdiag/plugin/machine/tick_differences.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "mjdiag/plugin/plant/plant_forces.h"
#include "mjdiag/plugin/plant/tangent_coordinates.h"
#include "mjdiag/signals/error.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kStep = 1e-6;

VectorXd StateSteps(const TickMap& map) {
  const mjModel& model = map.model();
  VectorXd steps = VectorXd::Constant(map.states(), kStep);
  const double extent = std::clamp(model.stat.extent, 1e-3, 1e3);
  for (int dof = 0; dof < model.nv; ++dof) {
    if (!IsLength(model, dof)) continue;
    steps[dof] *= extent;
    steps[model.nv + dof] *= extent;
  }
  Index place = TangentSize(model);
  for (const ActiveEffects::BodyOf& body : map.bodies()) {
    steps[place++] = steps[body.dof];
    steps[place++] = steps[model.nv + body.dof];
  }
  return steps;
}

/// Forces that make the steps of the velocities in a tick, where the model is drawn.
VectorXd ForceSteps(const mjModel& model, const VectorXd& steps, double tick) {
  const VectorXd drawn = VectorXd::Map(model.qpos0, model.nq);
  const VectorXd inertia = PlantForces(model, drawn).Mass().diagonal();
  return inertia.cwiseProduct(steps.segment(model.nv, model.nv)) / tick;
}

struct Outcome {
  PlantState state;
  VectorXd reading;
};

Outcome Checked(const TickMap::Result& result) {
  if (result.diverged) {
    throw NumericalError("replay: a tick beside the measured motion diverges");
  }
  return {result.state, result.reading};
}

}  // namespace

TickTangent Repeated(const TickTangent& step, int steps) {
  TickTangent tick = step;
  for (int i = 1; i < steps; ++i) {
    tick.A = step.A * tick.A;
    tick.B = step.A * tick.B + step.B;
  }
  return tick;
}

std::vector<Index> AllDofs(const mjModel& model) {
  std::vector<Index> dofs(static_cast<std::size_t>(model.nv));
  std::iota(dofs.begin(), dofs.end(), Index{0});
  return dofs;
}

TickDifferences::TickDifferences(TickMap& map, double tick, std::vector<Index> dofs)
    : map_(map),
      dofs_(std::move(dofs)),
      steps_(StateSteps(map)),
      force_steps_(ForceSteps(map.model(), steps_, tick)) {}

TickTangent TickDifferences::Of(const PlantState& from, const VectorXd& forces,
                                std::int64_t tick, TickControl& control,
                                std::span<const Index> without) {
  return By(&TickMap::Probe, from, forces, tick, control, without);
}

TickTangent TickDifferences::OfFirstStep(const PlantState& from, const VectorXd& forces,
                                         std::int64_t tick, TickControl& control,
                                         std::span<const Index> without) {
  return By(&TickMap::ProbeStep, from, forces, tick, control, without);
}

TickTangent TickDifferences::By(Probe probe, const PlantState& from,
                                const VectorXd& forces, std::int64_t tick,
                                TickControl& control, std::span<const Index> without) {
  const Index ns = steps_.size();
  const Index nv = force_steps_.size();
  TickTangent tangent{MatrixXd::Zero(ns, ns), MatrixXd::Zero(ns, nv),
                      MatrixXd::Zero(map_.sensors(), ns),
                      MatrixXd::Zero(map_.sensors(), nv)};
  // Forces first, then velocities: ticks from the same positions follow each other.
  for (const Index dof : dofs_) {
    ForceColumn(probe, from, forces, tick, control, dof, force_steps_[dof], tangent);
  }
  const auto is_without = [&](Index state) {
    return state < 2 * nv && std::ranges::find(without, state % nv) != without.end();
  };
  for (Index i = ns - 1; i >= 0; --i) {
    if (is_without(i)) continue;
    Column(probe, from, forces, tick, control, i, steps_[i], tangent);
  }
  return tangent;
}

void TickDifferences::Refresh(const PlantState& from, const VectorXd& forces,
                              std::int64_t tick, TickControl& control,
                              std::span<const Index> dofs, bool of_step, bool positions,
                              const VectorXd& sd, const VectorXd& force_sd,
                              TickTangent& tangent) {
  const Probe probe = of_step ? &TickMap::ProbeStep : &TickMap::Probe;
  const auto column = [&](Index state) {
    Column(probe, from, forces, tick, control, state,
           std::max(steps_[state], sd[state]), tangent);
  };
  for (const Index dof : dofs) {
    if (of_step || std::ranges::find(dofs_, dof) == dofs_.end()) continue;
    ForceColumn(probe, from, forces, tick, control, dof,
                std::max(force_steps_[dof], force_sd[dof]), tangent);
  }
  for (const Index dof : dofs) column(force_steps_.size() + dof);
  for (const Index dof : dofs) {
    if (positions) column(dof);
  }
}

void TickDifferences::PushSlopes::AddTo(TickTangent& step, double sign) const {
  const Index nv = position.size();
  for (Index dof = 0; dof < nv; ++dof) {
    step.A.col(dof) += sign * position[dof] * step.B.col(dof);
    step.A.col(nv + dof) += sign * velocity[dof] * step.B.col(dof);
  }
}

TickDifferences::PushSlopes TickDifferences::SlopesOf(const PlantState& from,
                                                      std::int64_t tick,
                                                      const VectorXd& sd) {
  const Index nv = force_steps_.size();
  const mjModel& model = map_.model();
  // Each pushes on its own joint alone: all are moved at once.
  const VectorXd h = steps_.head(2 * nv).cwiseMax(sd.head(2 * nv));
  const auto slopes = [&](Index first) {
    VectorXd dx = VectorXd::Zero(steps_.size());
    dx.segment(first, nv) = h.segment(first, nv);
    const PlantState above = Moved(model, from, dx);
    const PlantState below = Moved(model, from, -dx);
    return VectorXd((map_.PushesAt(above.position, above.velocity, tick) -
                     map_.PushesAt(below.position, below.velocity, tick))
                        .cwiseQuotient(2.0 * h.segment(first, nv)));
  };
  return {slopes(0), slopes(nv)};
}

void TickDifferences::Column(Probe probe, const PlantState& from,
                             const VectorXd& forces, std::int64_t tick,
                             TickControl& control, Index state, double h,
                             TickTangent& tangent) {
  VectorXd dx = VectorXd::Zero(steps_.size());
  dx[state] = h;
  const mjModel& model = map_.model();
  const Outcome above =
      Checked((map_.*probe)(Moved(model, from, dx), forces, tick, control));
  const Outcome below =
      Checked((map_.*probe)(Moved(model, from, -dx), forces, tick, control));
  tangent.A.col(state) = Deviation(model, below.state, above.state) / (2.0 * h);
  tangent.C.col(state) = (above.reading - below.reading) / (2.0 * h);
}

void TickDifferences::ForceColumn(Probe probe, const PlantState& from,
                                  const VectorXd& forces, std::int64_t tick,
                                  TickControl& control, Index dof, double h,
                                  TickTangent& tangent) {
  VectorXd moved = forces;
  moved[dof] += h;
  const Outcome above = Checked((map_.*probe)(from, moved, tick, control));
  moved[dof] -= 2.0 * h;
  const Outcome below = Checked((map_.*probe)(from, moved, tick, control));
  tangent.B.col(dof) = Deviation(map_.model(), below.state, above.state) / (2.0 * h);
  tangent.D.col(dof) = (above.reading - below.reading) / (2.0 * h);
}

}  // namespace mjdiag
