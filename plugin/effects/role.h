#pragma once
// What a parameter of an effect means, whatever it is called: how a fit steps it, what
// a record can say of it, and whether it shapes a law or only sizes it, follow from
// its role.

namespace mjdiag {

enum class Role {
  kAmplitude,  ///< size of a force or an error, which is proportional to it; 0: nothing
  kFactor,     ///< multiplies what is there; 1: nothing
  kTime,       ///< a delay or a time constant, nearly proportional; 0: nothing
  kPeriod,     ///< of a wave over a position
  kFrequency,  ///< of a wave over time, or of a resonance
  kPhase,      ///< of a wave, the same again after a turn [rad]
  kLength,     ///< over which a law of the motion changes
  kVelocity,   ///< at which a law of the velocity changes
  kPosition,   ///< at which something begins
  kLimit,      ///< of a command
  kGap,        ///< width within which something does not act
  kSteepness,  ///< with which a law begins
  kRatio,      ///< of one part of a law to another
  kDuration,   ///< over which something changes with time [s]
  kChoice      ///< which law it is: no question of a fit
};

/// Whether it says where or how a law bends, and not only how large its parts are:
/// those enter the motion nearly linearly.
constexpr bool IsShape(Role role) {
  return role != Role::kAmplitude && role != Role::kFactor && role != Role::kTime;
}

/// Whether waves and resonances repeat with it.
constexpr bool IsPeriod(Role role) {
  return role == Role::kPeriod || role == Role::kFrequency;
}

}  // namespace mjdiag
