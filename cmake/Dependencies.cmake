# The libraries that mjdiag builds on, as imported targets, part by part. Included by the
# build, for all parts, and by the installed package for those that are asked for
# (mjdiag_parts): a part asks for what it links, and never for a header that none of its
# own headers shows.
include(CMakeFindDependencyMacro)

# mjdiag_library(<target> [HEADER <header>] [BUILD_HEADER <header>] [SUFFIXES <s...>]
#                [LIBRARIES <names...>])
# defines an imported target for a library that ships no usable CMake config.
# BUILD_HEADER: one that only the files of mjdiag include.
function(mjdiag_library target)
  cmake_parse_arguments(arg "" "HEADER;BUILD_HEADER" "SUFFIXES;LIBRARIES" ${ARGN})
  if(TARGET ${target})
    return()
  endif()
  add_library(${target} INTERFACE IMPORTED GLOBAL)
  set(header ${arg_HEADER})
  if(mjdiag_building)
    set(header ${arg_HEADER} ${arg_BUILD_HEADER})
  endif()
  if(header)
    string(MAKE_C_IDENTIFIER "${target}" id)
    find_path(mjdiag_${id}_INCLUDE ${header} PATH_SUFFIXES ${arg_SUFFIXES} REQUIRED)
    target_include_directories(${target} SYSTEM INTERFACE ${mjdiag_${id}_INCLUDE})
  endif()
  foreach(name IN LISTS arg_LIBRARIES)
    find_library(mjdiag_${name}_LIBRARY ${name} REQUIRED)
    target_link_libraries(${target} INTERFACE ${mjdiag_${name}_LIBRARY})
  endforeach()
endfunction()

if("signals" IN_LIST mjdiag_parts)
  find_dependency(Eigen3 3.4)
  mjdiag_library(mjdiag::matio_library BUILD_HEADER matio.h LIBRARIES matio)
endif()
if("diagnosis" IN_LIST mjdiag_parts)
  mjdiag_library(mjdiag::clp_library BUILD_HEADER ClpSimplex.hpp SUFFIXES coin
                 LIBRARIES Clp CoinUtils)
endif()
if("plugin" IN_LIST mjdiag_parts OR "c" IN_LIST mjdiag_parts)
  # Debian's MuJoCo config names an include folder that does not exist.
  mjdiag_library(mjdiag::mujoco_library HEADER mujoco/mujoco.h LIBRARIES mujoco)
endif()
if("plugin" IN_LIST mjdiag_parts)
  find_dependency(Threads)
  find_dependency(TBB)
endif()
# libopencv-*-dev carry no config unless the whole of OpenCV is installed.
if("studies" IN_LIST mjdiag_parts)
  mjdiag_library(mjdiag::opencv_ml_library BUILD_HEADER opencv2/ml.hpp SUFFIXES opencv4
                 LIBRARIES opencv_ml opencv_core)
endif()
# HDF5 reads logs and writes data sets, where it is: mjdiag_has_hdf5 says so. A package that
# was built with it asks for its libraries.
if("signals" IN_LIST mjdiag_parts)
  set(required)
  if(mjdiag_building AND DEFINED MJDIAG_HDF5 AND NOT MJDIAG_HDF5 STREQUAL "AUTO")
    set(required REQUIRED)
  endif()
  set(mjdiag_has_hdf5 FALSE)
  if(NOT (mjdiag_building AND DEFINED MJDIAG_HDF5 AND NOT MJDIAG_HDF5))
    if(mjdiag_building)
      find_path(mjdiag_hdf5_INCLUDE hdf5.h PATH_SUFFIXES hdf5/serial ${required})
      find_path(mjdiag_zlib_INCLUDE zlib.h ${required})
    endif()
    find_library(mjdiag_hdf5_LIBRARY NAMES hdf5_serial hdf5 ${required})
    find_library(mjdiag_zlib_LIBRARY z ${required})
    if(mjdiag_hdf5_LIBRARY AND mjdiag_zlib_LIBRARY AND
       (NOT mjdiag_building OR (mjdiag_hdf5_INCLUDE AND mjdiag_zlib_INCLUDE)))
      set(mjdiag_has_hdf5 TRUE)
      if(NOT TARGET mjdiag::hdf5_library)
        add_library(mjdiag::hdf5_library INTERFACE IMPORTED GLOBAL)
        if(mjdiag_building)
          target_include_directories(mjdiag::hdf5_library SYSTEM INTERFACE
                                     ${mjdiag_hdf5_INCLUDE} ${mjdiag_zlib_INCLUDE})
        endif()
        target_link_libraries(mjdiag::hdf5_library
                              INTERFACE ${mjdiag_hdf5_LIBRARY} ${mjdiag_zlib_LIBRARY})
      endif()
    endif()
  endif()
endif()
if("render" IN_LIST mjdiag_parts)
  mjdiag_library(mjdiag::opencv_library BUILD_HEADER opencv2/core.hpp SUFFIXES opencv4
                 LIBRARIES opencv_core opencv_imgproc)
  mjdiag_library(mjdiag::png_library BUILD_HEADER png.h LIBRARIES png)
endif()

# Of these nothing but headers is needed, and only to build mjdiag. OSMesa is loaded when
# a picture is asked for.
if(mjdiag_building)
  mjdiag_library(mjdiag::opencv_files_library HEADER opencv2/videoio.hpp SUFFIXES opencv4
                 LIBRARIES opencv_core opencv_imgproc opencv_imgcodecs opencv_videoio)
  mjdiag_library(mjdiag::osmesa_headers HEADER GL/osmesa.h)
  mjdiag_library(mjdiag::boost_library HEADER boost/math/distributions.hpp)
  mjdiag_library(mjdiag::toml_library HEADER toml++/toml.h)
  mjdiag_library(mjdiag::json_library HEADER nlohmann/json.hpp)
  mjdiag_library(mjdiag::cli_library HEADER CLI/CLI.hpp)
endif()
