#pragma once
// Independent runs side by side (oneTBB).

#include <functional>

namespace mjdiag {

/// task(0) .. task(count - 1), on as many threads as there are cores for this process.
/// The order is not defined; results must not depend on it. The first exception is
/// thrown again here after all tasks that had begun have ended; others do not begin.
/// `progress`, if any, is called from this thread with the share that is done.
///
/// A task may call this itself: all loops share one set of threads. While a loop waits
/// for its last tasks its thread takes up none of another loop.
void ParallelFor(int count, const std::function<void(int)>& task,
                 const std::function<void(double fraction)>& progress = {});

/// The same, but every task is begun, even if one throws: how much work they do does
/// not depend on the number of threads. Throws what the first of them by number did.
void ParallelForAll(int count, const std::function<void(int)>& task);

}  // namespace mjdiag
