#pragma once
// The memory of hysteresis.

#include <cmath>

namespace mjdiag {

/// Follows a motion with a memory of `length` (Dahl): over a step with velocity v
///   z <- s L + (z - s L) exp(-|v| h / L),  s = sign(v)
/// which solves dz/dt = v - |v| z / L exactly.
class Follower {
 public:
  explicit Follower(double length) : length_(length) {}
  double Step(double v, double h) noexcept {
    const double end = std::copysign(length_, v);
    z_ = end + (z_ - end) * std::exp(-std::abs(v) * h / length_);
    return z_;
  }

 private:
  double length_;
  double z_ = 0.0;
};

}  // namespace mjdiag
