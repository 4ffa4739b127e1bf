#pragma once
// The controller of one axis, called once a control tick from the control callback.

#include <memory>
#include <vector>

#include "mjdiag/controllers/reference.h"

namespace mjdiag {

/// Which part of a feedforward and feedback controller acts ([AB383], chapter 5.3).
enum class ControlMode { kBoth, kFeedback, kFeedforward };

/// One controller interface for every axis. Nothing in Update allocates, locks or
/// throws.
class AxisController {
 public:
  virtual ~AxisController() = default;
  /// Back to the state before the first tick: at rest at `position` without error.
  virtual void Reset(double position) noexcept = 0;
  /// One tick. @param reference    of this tick
  ///           @param measured     sensor reading of this tick [m or rad]
  ///           @param disturbance  known addition to the command before any saturation
  /// @return the command to the drive (for example A or V)
  virtual double Update(const ReferenceSample& reference, double measured,
                        double disturbance) noexcept = 0;
  /// From the next tick on for a drive with 1/gain of its force: feedforward and errors
  /// are multiplied by it, before whatever the feedback remembers. An integrator holds
  /// its load through a change of the gain, and the command does not jump; with a gain
  /// that stays it is the same controller as one whose command is multiplied.
  virtual void SetGain(double gain) noexcept = 0;
};

/// u = k_s snap + k_a acceleration + k_v velocity, [AB383], Eq. 35.
struct FeedforwardGains {
  double snap = 0.0;
  double acceleration = 0.0;
  double velocity = 0.0;
};

/// C(z) = (b0 z^m + b1 z^(m-1) + ... + bm) / (a0 z^n + ... + an) acting on reference -
/// measured, [AB383], Eq. 36. Coefficients in descending powers of z, m <= n, a0 !=
/// 0.
struct DiscreteCompensator {
  std::vector<double> numerator;
  std::vector<double> denominator;
};

/// Feedforward plus feedback, or one of them alone. InputError on an empty or improper
/// compensator.
std::unique_ptr<AxisController> MakeFeedforwardFeedback(
    const FeedforwardGains& feedforward, const DiscreteCompensator& feedback,
    ControlMode mode);

/// Two nested loops, as the EMPS stage has them: with qf(k) = (q(k) + q(k-1)) / 2 and
/// dq(k) = (qf(k) - qf(k-1)) / T,
///   u(k) = clamp(kp kv (q_ref(k) - q(k)) - kv dq(k) + disturbance(k), +-saturation)
struct NestedLoops {
  double position_gain = 0.0;  ///< kp [1/s]
  double velocity_gain = 0.0;  ///< kv [V s/m]; u may be in another unit than V
  double saturation = 0.0;     ///< [V]; 0: none
};

/// InputError on a gain that is not finite, a negative saturation or sample time.
std::unique_ptr<AxisController> MakeNestedLoops(const NestedLoops& gains,
                                                double sample_time);

}  // namespace mjdiag
