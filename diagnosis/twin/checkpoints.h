#pragma once
// States that a twin has had of late, to start it again from; memory is constant.

#include <Eigen/Core>
#include <array>

#include "mjdiag/diagnosis/twin/twin.h"

namespace mjdiag {

struct Checkpoint {
  Eigen::Index tick = -1;
  TwinState state;
};

class Checkpoints {
 public:
  explicit Checkpoints(const Twin& twin) { kept_.fill({-1, twin.MakeState()}); }

  // Nothing below allocates, locks or throws.

  /// Where the state after that tick belongs, if it is one to keep; else null.
  Checkpoint* At(Eigen::Index tick) noexcept {
    if (tick % kEvery != 0) return nullptr;
    Checkpoint& at = kept_[static_cast<std::size_t>(tick / kEvery) % kept_.size()];
    at.tick = tick;
    return &at;
  }
  /// The last one of those ticks, both included; null if there is none.
  const Checkpoint* Last(Eigen::Index from, Eigen::Index until) const noexcept {
    const Checkpoint* last = nullptr;
    for (const Checkpoint& kept : kept_) {
      if (kept.tick < from || kept.tick > until) continue;
      if (last == nullptr || kept.tick > last->tick) last = &kept;
    }
    return last;
  }
  void Clear() noexcept {
    for (Checkpoint& kept : kept_) kept.tick = -1;
  }

 private:
  static constexpr Eigen::Index kEvery = 128;  // ticks
  std::array<Checkpoint, 16> kept_;
};

}  // namespace mjdiag
