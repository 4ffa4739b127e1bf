#pragma once
// Counts calls of malloc: what runs inside a control callback may not allocate. Puts
// its own malloc in front of glibc's, weak, so that any number of source files of a
// test program may include it.

#include <atomic>
#include <cstdlib>

#include "support/sanitizers.h"

namespace mjdiag::test {
inline std::atomic<long> allocations{0};
}

#if !MJDIAG_SANITIZED
// Eigen and operator new both end here.
// NOLINTBEGIN(bugprone-reserved-identifier,misc-definitions-in-headers)
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* __libc_memalign(std::size_t alignment, std::size_t size);
extern "C" [[gnu::weak]] void* malloc(std::size_t size) {
  ++mjdiag::test::allocations;
  return __libc_malloc(size);
}
extern "C" [[gnu::weak]] void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++mjdiag::test::allocations;
  return __libc_memalign(alignment, size);
}
// NOLINTEND(bugprone-reserved-identifier,misc-definitions-in-headers)
#endif

namespace mjdiag::test {

/// False under a sanitizer, to which malloc belongs.
inline constexpr bool kCountsAllocations = !kSanitized;

template <typename Function>
long CountAllocations(const Function& function) {
  const long before = allocations;
  function();
  return allocations - before;
}

}  // namespace mjdiag::test
