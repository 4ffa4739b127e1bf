#pragma once
// Effects that are an error of what a sensor reads, in all channels that read it.

#include <cstddef>
#include <vector>

#include "mjdiag/plugin/effects/effect.h"

namespace mjdiag {

/// Places of the channels that read a sensor.
std::vector<std::size_t> ChannelsOf(const mjModel& model, const Channels& channels,
                                    int element);

class ReadingErrorEffect : public Effect {
 public:
  using Effect::Effect;
  std::unique_ptr<ActiveEffect> Activate(const mjModel& model, const Channels& channels,
                                         int element,
                                         const EffectValues& values) const final;
  /// What is read instead of y. Neither allocates nor throws.
  virtual double Read(double y, double time,
                      const EffectValues& values) const noexcept = 0;
};

}  // namespace mjdiag
