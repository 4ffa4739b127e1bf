#pragma once
// One rest-to-rest move with bounded velocity, acceleration, jerk and snap: the
// fourth-order setpoint of Lambrechts, "Trajectory planning and feedforward design for
// electromechanical motion systems", TU Eindhoven, 2003.
//
// The snap is +-s or 0 over 15 phases. With the durations t_s (constant snap), t_j
// (constant jerk), t_a (constant acceleration) and t_v (constant velocity) the move
// reaches
//   jerk          j = s t_s
//   acceleration  a = j (t_s + t_j)
//   velocity      v = a (2 t_s + t_j + t_a)
//   distance      d = v (4 t_s + 2 t_j + t_a + t_v)
// Each duration in turn is the shortest one that the bounds and the distance allow,
// rounded up to whole control ticks; s then follows from d and is never above its
// bound.

#include <array>

namespace mjdiag {

/// Bounds of a move, all > 0. SI units of the axis (m or rad).
struct MoveLimits {
  double velocity = 0.0;      ///< [m/s]
  double acceleration = 0.0;  ///< [m/s^2]
  double jerk = 0.0;          ///< [m/s^3]
  double snap = 0.0;          ///< [m/s^4]
};

/// Durations of the phases of a fourth-order move, in control ticks.
struct PhaseTicks {
  long snap = 0;          ///< t_s, 8 phases
  long jerk = 0;          ///< t_j, 4 phases
  long acceleration = 0;  ///< t_a, 2 phases
  long velocity = 0;      ///< t_v, 1 phase

  long Total() const { return 8 * snap + 4 * jerk + 2 * acceleration + velocity; }
};

/// Position and its derivatives (SI units of the axis).
struct Motion {
  double position = 0.0;
  double velocity = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;
  double snap = 0.0;
};

/// A planned move from position 0 to `distance`, starting at time 0.
class Setpoint {
 public:
  /// @param distance     of either sign; 0: a move of no duration [m or rad]
  /// @param sample_time  control tick [s]
  /// InputError if a limit or the sample time is not positive, or the distance not
  /// finite.
  Setpoint(double distance, const MoveLimits& limits, double sample_time);

  double distance() const { return distance_; }
  const PhaseTicks& phases() const { return phases_; }
  /// Control ticks from start to rest.
  long ticks() const { return phases_.Total(); }
  /// Exact motion `ticks` after the start (any real number); at a change of snap the
  /// value that begins there. At rest before the start and after the end.
  Motion At(double ticks) const;

 private:
  struct Phase {
    double start = 0.0;  ///< [ticks]
    Motion motion;       ///< at the start
  };

  double distance_ = 0.0;
  double sample_time_ = 0.0;
  PhaseTicks phases_;
  std::array<Phase, 15> profile_;
};

}  // namespace mjdiag
