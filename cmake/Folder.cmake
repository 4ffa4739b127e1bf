# What nearly every file includes, parsed once for all folders. The files still include what
# they use; MJDIAG_PRECOMPILE=OFF shows whether they do.
option(MJDIAG_PRECOMPILE "Precompile the common headers" ON)
function(mjdiag_precompile target)
  if(NOT MJDIAG_PRECOMPILE)
    return()
  endif()
  if(ARGN OR NOT TARGET mjdiag_precompiled)
    target_precompile_headers(${target} PRIVATE ${ARGN} <Eigen/Core> <algorithm> <cmath>
                              <filesystem> <functional> <map> <string> <vector>)
  else()
    target_precompile_headers(${target} REUSE_FROM mjdiag_precompiled)
  endif()
endfunction()

if(MJDIAG_PRECOMPILE)
  file(WRITE ${PROJECT_BINARY_DIR}/precompiled.cc "")
  add_library(mjdiag_precompiled OBJECT ${PROJECT_BINARY_DIR}/precompiled.cc)
  set_target_properties(mjdiag_precompiled PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_compile_features(mjdiag_precompiled PUBLIC cxx_std_20)
  target_link_libraries(mjdiag_precompiled PRIVATE mjdiag_warnings Eigen3::Eigen)
  target_precompile_headers(mjdiag_precompiled PRIVATE <Eigen/Core> <algorithm> <cmath>
                            <filesystem> <functional> <map> <string> <vector>)
endif()

# mjdiag_folder(<path> LINKS <targets...> [PRIVATE_LINKS <targets...>]
#               [HEADERS_OF <targets...>] [PART <part>] [PRECOMPILE <headers...>])
#
# Makes a library target from the .cc files directly in the folder <path>: for
# plugin/plant mjdiag_plugin_plant (alias mjdiag::plugin_plant). Its headers are
# reachable as "mjdiag/plugin/plant/..." only by targets that link it: each folder has
# an include root of its own that holds nothing but links to its headers. A folder that
# includes upwards in the table of the design therefore does not compile.
#
# HEADERS_OF: libraries of headers only, which a program that links the folder does not
# need. PART: of the installed package (Parts.cmake), by default the first folder of the
# path. Which headers are installed, docs/api.md says (InstallHeaders.cmake).
function(mjdiag_folder path)
  cmake_parse_arguments(arg "" "PART" "LINKS;PRIVATE_LINKS;HEADERS_OF;PRECOMPILE" ${ARGN})
  set(source ${PROJECT_SOURCE_DIR}/${path})
  file(GLOB sources CONFIGURE_DEPENDS ${source}/*.cc)
  file(GLOB headers CONFIGURE_DEPENDS RELATIVE ${source} ${source}/*.h)
  string(REPLACE "/" "_" name ${path})
  set(root ${PROJECT_BINARY_DIR}/include/${name})
  # Headers that are gone must not be found any more.
  file(REMOVE_RECURSE ${root})
  file(MAKE_DIRECTORY ${root}/mjdiag/${path})
  foreach(header IN LISTS headers)
    file(CREATE_LINK ${source}/${header} ${root}/mjdiag/${path}/${header} SYMBOLIC)
  endforeach()
  set(target mjdiag_${name})
  add_library(${target} STATIC ${sources})
  add_library(mjdiag::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name}
                                             POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${root}>
                                              $<INSTALL_INTERFACE:include>)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PUBLIC ${arg_LINKS} PRIVATE ${arg_PRIVATE_LINKS})
  foreach(library IN LISTS arg_HEADERS_OF ITEMS mjdiag_warnings)
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:${library}>)
  endforeach()
  mjdiag_precompile(${target} ${arg_PRECOMPILE})
  if(NOT arg_PART)
    string(REGEX MATCH "^[^/]+" arg_PART ${path})
  endif()
  install(TARGETS ${target} EXPORT mjdiag_${arg_PART})
endfunction()
