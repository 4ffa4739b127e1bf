#include "host_callback.h"

#include <mujoco/mujoco.h>

#include <mutex>

#include "guard.h"

namespace mjdiag {
namespace {

mjfGeneric host_callback = nullptr;

void PassToHost(const mjModel* model, mjData* data) {
  if (!Inside::now()) host_callback(model, data);
}

}  // namespace

void KeepHostCallbackOut() {
  static std::once_flag once;
  std::call_once(once, [] {
    if (mjcb_control == nullptr) return;
    host_callback = mjcb_control;
    mjcb_control = PassToHost;
  });
}

}  // namespace mjdiag
