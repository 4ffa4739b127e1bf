#pragma once
// Room in mjData.userdata for the mark of a running instance (plugin/runtime/instance.h)
// behind whatever else is kept there.

#include <mujoco/mujoco.h>

namespace mjdiag {

/// A constant that no other user of userdata will hold, and a pointer.
inline constexpr int kInstanceSlots = 2;

/// Call before mj_makeData, once a model.
inline void ReserveInstanceSlot(mjModel& model) { model.nuserdata += kInstanceSlots; }

}  // namespace mjdiag
