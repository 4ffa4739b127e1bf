#include "mjdiag/plugin/replay/tangent_course.h"

#include <algorithm>
#include <cmath>

#include "mjdiag/plugin/effects/effect.h"

namespace mjdiag {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr double kStretchTime = 0.01;  // [s]
// Forces of effects change sooner: a motion of some Hz changes them by a hundredth within this.
constexpr double kStretchOfEffects = 0.001;  // [s]

template <typename Part>
bool AreClose(const Part& one, const Part& other) {
  constexpr double kAlike = 1e-3;
  return (one - other).norm() <= kAlike * one.norm();
}

/// Of two tangents, of positions and velocities each by itself, which have units of their
/// own.
bool AreAlike(const TickTangent& a, const TickTangent& b) {
  const Index nv = a.B.cols();
  const Index ns = a.A.rows();
  const Index begins[] = {0, nv, 2 * nv, ns};
  for (int i = 0; i < 3; ++i) {
    const Index rows = begins[i + 1] - begins[i];
    for (int j = 0; j < 3; ++j) {
      const Index columns = begins[j + 1] - begins[j];
      if (!AreClose(a.A.block(begins[i], begins[j], rows, columns),
                    b.A.block(begins[i], begins[j], rows, columns))) {
        return false;
      }
    }
    if (!AreClose(a.B.middleRows(begins[i], rows), b.B.middleRows(begins[i], rows))) {
      return false;
    }
  }
  for (Index i = 0; i < a.C.rows(); ++i) {
    if (!AreClose(a.C.row(i), b.C.row(i)) || !AreClose(a.D.row(i), b.D.row(i)))
      return false;
  }
  return true;
}

/// The same of the columns of some degrees of freedom, each by itself.
bool ColumnsAreAlike(const TickTangent& a, const TickTangent& b,
                     const std::vector<Index>& dofs) {
  const Index nv = a.B.cols();
  return std::ranges::all_of(dofs, [&](Index dof) {
    return AreClose(a.A.col(dof), b.A.col(dof)) &&
           AreClose(a.A.col(nv + dof), b.A.col(nv + dof)) &&
           AreClose(a.B.col(dof), b.B.col(dof));
  });
}

/// Where effects push: their forces may change within less than a stretch.
std::vector<Index> DofsWithEffects(const Machine& machine) {
  std::vector<Index> dofs;
  for (const PlacedEffect& placed : machine.effects()) {
    const bool pushes = placed.effect->element() == mjOBJ_JOINT &&
                        placed.effect->form() == Form::kNumeric;
    if (!pushes) continue;
    const int joint = FindElement(machine.plant(), mjOBJ_JOINT, placed.site);
    const Index dof = machine.plant().jnt_dofadr[joint];
    if (std::ranges::find(dofs, dof) == dofs.end()) dofs.push_back(dof);
  }
  return dofs;
}

std::vector<Index> DofsThatRub(const mjModel& model) {
  std::vector<Index> dofs;
  for (int dof = 0; dof < model.nv; ++dof) {
    if (model.dof_frictionloss[dof] > 0.0) dofs.push_back(dof);
  }
  return dofs;
}

}  // namespace

TangentCourse::TangentCourse(const Machine& machine, TickMap& map)
    : map_(map),
      // What is missing may push where nothing drives and nothing is measured, too.
      differences_(map, machine.rates().tick(), AllDofs(machine.plant())),
      with_effects_(DofsWithEffects(machine)),
      follow_their_joints_(map.EffectsFollowTheirJoints()),
      rubbing_(DofsThatRub(machine.plant())),
      shortest_(std::max<std::int64_t>(
          1, std::lround(kStretchTime * machine.rates().control))),
      of_effects_(std::max<std::int64_t>(
          1, std::lround(kStretchOfEffects * machine.rates().control))) {}

bool TangentCourse::IsBySteps() const {
  return !map_.last().is_constrained && !map_.reads_at_end();
}

TickTangent TangentCourse::OfTick(const TickTangent& part) const {
  return IsBySteps() ? Repeated(part, map_.steps()) : part;
}

TickTangent TangentCourse::PartAt(const PlantState& from, const VectorXd& forces,
                                  std::int64_t tick, TickControl& control) {
  if (!IsBySteps()) return differences_.Of(from, forces, tick, control, with_effects_);
  if (!IsByPushes()) {
    return differences_.OfFirstStep(from, forces, tick, control, with_effects_);
  }
  TickTangent part = differences_.OfFirstStep(from, forces, tick, control);
  if (!with_effects_.empty()) {
    const VectorXd known = VectorXd::Zero(map_.states());
    differences_.SlopesOf(from, tick, known).AddTo(part, -1.0);
  }
  return part;
}

// A joint that may stick for all that is known of its velocity and of what pushes it moves
// by neither of the two tangents, for only by what is between them does a filter that holds
// it learn that it should not.
std::vector<Index> TangentCourse::RestlessAt(const PlantState& from, const VectorXd& sd,
                                             const VectorXd& force_sd) const {
  constexpr double kMay = 3.0;  // standard deviations
  std::vector<Index> dofs;
  for (const std::vector<Index>* some : {&rubbing_, &with_effects_}) {
    for (const Index dof : *some) {
      const double spread =
          sd[from.velocity.size() + dof] + force_sd[dof] * differences_.VelocityOf(dof);
      if (std::abs(from.velocity[dof]) > kMay * spread) continue;
      if (std::ranges::find(dofs, dof) == dofs.end()) dofs.push_back(dof);
    }
  }
  return dofs;
}

bool TangentCourse::HoldsFor(const Refreshed& before, const Refreshed& now,
                             const VectorXd& force_sd) const {
  if (before.of != now.of || now.since < before.since ||
      now.since - before.since >= before.stretch ||
      before.standing.size() != now.standing.size()) {
    return false;
  }
  constexpr double kNear = 0.3;  // of what is not known
  for (std::size_t i = 0; i < now.standing.size(); ++i) {
    const Standing& was = before.standing[i];
    const Standing& is = now.standing[i];
    if (was.dof != is.dof || std::abs(is.spread - was.spread) > kNear * was.spread ||
        std::abs(is.velocity - was.velocity) > kNear * was.spread ||
        std::abs(is.next - was.next) > kNear * was.spread ||
        std::abs(is.force - was.force) > kNear * force_sd[is.dof]) {
      return false;
    }
  }
  return true;
}

std::size_t TangentCourse::Next(const PlantState& from, const VectorXd& forces,
                                std::int64_t tick, TickControl& control,
                                const VectorXd& sd, const VectorXd& force_sd) {
  constexpr std::int64_t kLongest = 16;  // stretches
  if (tick < last_) known_.clear();
  last_ = tick;
  const bool is_step = IsBySteps();
  const auto [entry, is_new] = known_.try_emplace(map_.last().pattern);
  Known& known = entry->second;
  if (is_new || tick - known.since >= known.stretch) {
    known.of_part = PartAt(from, forces, tick, control);
    TickTangent here = OfTick(known.of_part);
    known.since = tick;
    if (!is_new && AreAlike(here, known.of_tick)) {
      known.stretch = std::min(2 * known.stretch, kLongest * shortest_);
    } else {
      known.stretch = shortest_;
      known.of_tick = std::move(here);
      known.number = ++numbers_;
      known.place.reset();
    }
  }
  std::vector<Index> dofs = RestlessAt(from, sd, force_sd);
  if (with_effects_.empty() && dofs.empty()) {
    if (!known.place) {
      known.place = tangents.size();
      tangents.push_back(known.of_tick);
    }
    return *known.place;
  }
  Refreshed now{known.number, tangents.size(), tick, of_effects_, {}};
  for (const Index dof : dofs) {
    const double spread =
        sd[from.velocity.size() + dof] + force_sd[dof] * differences_.VelocityOf(dof);
    now.standing.push_back({dof, from.velocity[dof], map_.last().state.velocity[dof],
                            forces[dof], spread});
  }
  if (refreshed_ && HoldsFor(*refreshed_, now, force_sd)) return refreshed_->place;
  TickTangent part = known.of_part;
  if (IsByPushes()) {
    differences_.SlopesOf(from, tick, sd).AddTo(part, 1.0);
  } else {
    differences_.Refresh(from, forces, tick, control, with_effects_, is_step, true, sd,
                         force_sd, part);
  }
  const bool may_stand = !dofs.empty();
  // Dry friction does not ask where a joint is.
  std::erase_if(dofs, [&](Index dof) {
    return std::ranges::find(with_effects_, dof) != with_effects_.end();
  });
  TickTangent here = OfTick(part);
  differences_.Refresh(from, forces, tick, control, dofs, false, false, sd, force_sd,
                       here);
  // What stands may begin to move at any time.
  if (!may_stand && refreshed_ && refreshed_->of == now.of &&
      ColumnsAreAlike(tangents[refreshed_->place], here, with_effects_)) {
    now.place = refreshed_->place;
    now.stretch = std::min(2 * refreshed_->stretch, shortest_);
  } else {
    tangents.push_back(std::move(here));
  }
  refreshed_ = std::move(now);
  return refreshed_->place;
}

}  // namespace mjdiag
