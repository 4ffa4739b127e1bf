#include "mjdiag/watch/stream/tick.h"

#include <chrono>

namespace mjdiag {

double WallClock() {
  return std::chrono::duration<double>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace mjdiag
