#include "mjdiag/plugin/runtime/threads.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace mjdiag {

int CoresOfProcess() { return std::max(1, tbb::info::default_concurrency()); }

void OnThreads(int count, const std::function<void()>& work) {
  if (count == 0) {
    work();
    return;
  }
  // An arena alone gets no more threads than there are cores.
  const int most = std::max(count, CoresOfProcess());
  const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(most));
  tbb::task_arena(count).execute(work);
}

}  // namespace mjdiag
