#include "mjdiag/signals/freed_memory.h"

#include <cstdlib>  // says whether this is glibc

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace mjdiag {

void KeepFreedMemory() noexcept {
#ifdef __GLIBC__
  // Pieces of less come from what is kept; glibc takes no more than 32 MiB.
  constexpr int kPiece = 32 << 20;
  // Of each pool of memory; what is free beyond that goes back.
  constexpr int kKept = 64 << 20;
  mallopt(M_MMAP_THRESHOLD, kPiece);
  mallopt(M_TRIM_THRESHOLD, kKept);
#endif
}

}  // namespace mjdiag
