// A program of libFuzzer for the target MJDIAG_FUZZ_TARGET.

#include <cstddef>
#include <cstdint>

#include "fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mjdiag::fuzz::MJDIAG_FUZZ_TARGET({data, size});
  return 0;
}
