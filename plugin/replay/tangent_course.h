#pragma once
// The tangents of a run's ticks, taken where they change (force_filter.h). One that differs
// from the one before it by less than a thousandth, which is a thousandth of what an estimate
// is off by, is the same; where it stays the same it is asked for more seldom.

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "mjdiag/plugin/machine/machine.h"
#include "mjdiag/plugin/machine/tick_differences.h"

namespace mjdiag {

class TangentCourse {
 public:
  /// @param map  has to outlive it
  TangentCourse(const Machine& machine, TickMap& map);

  /// Place in `tangents` of the tangent of the map's last Run.
  /// @param sd        of the state there, ns
  /// @param force_sd  of the forces, nv
  std::size_t Next(const PlantState& from, const Eigen::VectorXd& forces,
                   std::int64_t tick, TickControl& control, const Eigen::VectorXd& sd,
                   const Eigen::VectorXd& force_sd);
  std::vector<TickTangent> tangents;

 private:
  /// Where no constraint acts, and nothing is read at its end, a tick is its first physics
  /// step as often as there are some.
  bool IsBySteps() const;
  TickTangent OfTick(const TickTangent& part) const;
  /// Whether what effects do to it is known by what they push with.
  bool IsByPushes() const { return follow_their_joints_ && IsBySteps(); }
  TickTangent PartAt(const PlantState& from, const Eigen::VectorXd& forces,
                     std::int64_t tick, TickControl& control);
  /// Degrees of freedom that may stand, whose columns hold for this tick only.
  std::vector<Eigen::Index> RestlessAt(const PlantState& from,
                                       const Eigen::VectorXd& sd,
                                       const Eigen::VectorXd& force_sd) const;

  TickMap& map_;
  TickDifferences differences_;
  std::vector<Eigen::Index> with_effects_;
  bool follow_their_joints_;
  std::vector<Eigen::Index> rubbing_;  // with dry friction
  std::int64_t shortest_;              // stretch, in ticks
  std::int64_t of_effects_;            // the same
  std::int64_t last_ = 0;              // tick
  /// A tangent without what effects push with, or without columns q and v of where they push,
  /// from when on it is taken to hold, and for how long.
  struct Known {
    TickTangent of_part = {};  // of the tick, or of its first physics step
    TickTangent of_tick = {};
    std::int64_t number = 0;           // another one each time that it changes
    std::optional<std::size_t> place;  // in `tangents`, if it is used as it is
    std::int64_t since = 0;
    std::int64_t stretch = 0;
  };
  std::int64_t numbers_ = 0;
  std::map<std::uint64_t, Known> known_;  // by pattern
  /// A joint that may stand: its velocity, that after the tick, its latent force and how far
  /// its velocity may be off.
  struct Standing {
    Eigen::Index dof = 0;
    double velocity = 0.0;
    double next = 0.0;
    double force = 0.0;
    double spread = 0.0;
  };
  /// A tangent with columns of effects and of joints that may stand, from which one it was
  /// made and when.
  struct Refreshed {
    std::int64_t of = 0;  // number of that
    std::size_t place = 0;
    std::int64_t since = 0;
    std::int64_t stretch = 0;
    std::vector<Standing> standing;
  };
  /// Whether the one is as good as the other would be.
  bool HoldsFor(const Refreshed& before, const Refreshed& now,
                const Eigen::VectorXd& force_sd) const;
  std::optional<Refreshed> refreshed_;
};

}  // namespace mjdiag
