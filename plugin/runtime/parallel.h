#pragma once
// Independent runs side by side.

#include <functional>

namespace mjdiag {

/// task(0) .. task(count - 1), on as many threads as the machine has cores. The order
/// is not defined; results must not depend on it. The first exception is thrown again
/// here after all threads have ended. `progress`, if any, is called from this thread.
void ParallelFor(int count, const std::function<void(int)>& task,
                 const std::function<void(double fraction)>& progress = {});

}  // namespace mjdiag
