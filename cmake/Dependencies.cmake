# Every library mjdiag builds on, as imported targets. Included by the build and by
# the installed package alike, so both see the same targets.
include(CMakeFindDependencyMacro)
find_dependency(Threads)
find_dependency(Eigen3 3.4)
find_dependency(Ceres)
find_dependency(TBB)

# mjdiag_library(<target> HEADER <header> [SUFFIXES <s...>] LIBRARIES <names...>)
# defines an imported target for a library that ships no usable CMake config.
function(mjdiag_library target)
  cmake_parse_arguments(arg "" "HEADER" "SUFFIXES;LIBRARIES" ${ARGN})
  if(TARGET ${target})
    return()
  endif()
  string(MAKE_C_IDENTIFIER "${target}" id)
  find_path(mjdiag_${id}_INCLUDE ${arg_HEADER} PATH_SUFFIXES ${arg_SUFFIXES} REQUIRED)
  add_library(${target} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${target} SYSTEM INTERFACE ${mjdiag_${id}_INCLUDE})
  foreach(name IN LISTS arg_LIBRARIES)
    find_library(mjdiag_${name}_LIBRARY ${name} REQUIRED)
    target_link_libraries(${target} INTERFACE ${mjdiag_${name}_LIBRARY})
  endforeach()
endfunction()

# Debian's MuJoCo config names an include folder that does not exist, and its
# libopencv-*-dev packages carry no config unless the whole of OpenCV is installed.
mjdiag_library(mjdiag::mujoco_library HEADER mujoco/mujoco.h LIBRARIES mujoco)
# Loaded when a picture is asked for, not linked.
mjdiag_library(mjdiag::osmesa_headers HEADER GL/osmesa.h LIBRARIES)
mjdiag_library(mjdiag::opencv_library HEADER opencv2/core.hpp SUFFIXES opencv4
               LIBRARIES opencv_core opencv_imgproc opencv_imgcodecs opencv_videoio)
mjdiag_library(mjdiag::opencv_ml_library HEADER opencv2/ml.hpp SUFFIXES opencv4
               LIBRARIES opencv_ml opencv_core)
mjdiag_library(mjdiag::matio_library HEADER matio.h LIBRARIES matio)
mjdiag_library(mjdiag::clp_library HEADER ClpSimplex.hpp SUFFIXES coin
               LIBRARIES Clp CoinUtils)
mjdiag_library(mjdiag::boost_library HEADER boost/math/distributions.hpp LIBRARIES)
mjdiag_library(mjdiag::toml_library HEADER toml++/toml.h LIBRARIES)
mjdiag_library(mjdiag::json_library HEADER nlohmann/json.hpp LIBRARIES)
mjdiag_library(mjdiag::cli_library HEADER CLI/CLI.hpp LIBRARIES)
