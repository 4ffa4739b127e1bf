# Instructions that the build may use. Filters are products of small dense matrices, which
# registers of four numbers (AVX2, FMA) make in half the time; sums of what is not allocated at
# 32 bytes depend on where it lies then, in their last bits, from one run to the next.
set(MJDIAG_PROCESSOR ANY CACHE STRING
    "Processors that the build is for: ANY, with the same bits on every run, or NATIVE, those like this one")
set_property(CACHE MJDIAG_PROCESSOR PROPERTY STRINGS ANY NATIVE)

# Arrays of Eigen pass between the library and programs that use it: both have to agree on
# their alignment, whatever instructions each is built with.
set(mjdiag_processor_definitions EIGEN_MAX_ALIGN_BYTES=16)
set(mjdiag_processor_options)
if(MJDIAG_PROCESSOR STREQUAL "NATIVE" AND NOT CMAKE_CROSSCOMPILING)
  include(CheckCXXSourceRuns)
  check_cxx_source_runs("
    int main() {
      return __builtin_cpu_supports(\"avx2\") && __builtin_cpu_supports(\"fma\") ? 0 : 1;
    }" MJDIAG_HAS_AVX2)
  if(MJDIAG_HAS_AVX2)
    set(mjdiag_processor_options -mavx2 -mfma)
  endif()
elseif(NOT MJDIAG_PROCESSOR STREQUAL "ANY" AND NOT MJDIAG_PROCESSOR STREQUAL "NATIVE")
  message(FATAL_ERROR "MJDIAG_PROCESSOR=${MJDIAG_PROCESSOR}: expected NATIVE or ANY")
endif()
add_compile_definitions(${mjdiag_processor_definitions})
add_compile_options(${mjdiag_processor_options})
