# What nearly every file includes, parsed once a target. The files still include what
# they use; MJDIAG_PRECOMPILE=OFF shows whether they do.
option(MJDIAG_PRECOMPILE "Precompile the common headers" ON)
function(mjdiag_precompile target)
  if(MJDIAG_PRECOMPILE)
    target_precompile_headers(${target} PRIVATE ${ARGN} <algorithm> <cmath> <filesystem>
                              <functional> <map> <string> <vector>)
  endif()
endfunction()

# mjdiag_folder(<name> LINKS <targets...> [PRIVATE_LINKS <targets...>])
#
# Makes the library target mjdiag_<name> (alias mjdiag::<name>) from the .cc files
# of the folder <name>. Its headers are reachable as "mjdiag/<name>/..." only by
# targets that link it: each folder has an include root of its own that holds
# nothing but a link to the folder. A folder that includes upwards in the table of
# the design therefore does not compile.
function(mjdiag_folder name)
  cmake_parse_arguments(arg "" "" "LINKS;PRIVATE_LINKS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cc)
  set(root ${PROJECT_BINARY_DIR}/include/${name})
  file(MAKE_DIRECTORY ${root}/mjdiag)
  file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${root}/mjdiag/${name} SYMBOLIC)
  set(target mjdiag_${name})
  add_library(${target} STATIC ${sources})
  add_library(mjdiag::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name}
                                             POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${root}>
                                              $<INSTALL_INTERFACE:include>)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PUBLIC ${arg_LINKS} PRIVATE ${arg_PRIVATE_LINKS}
                                         $<BUILD_INTERFACE:mjdiag_warnings>)
  mjdiag_precompile(${target} <Eigen/Core>)
  install(TARGETS ${target} EXPORT mjdiagTargets)
  install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/ DESTINATION include/mjdiag/${name}
          FILES_MATCHING PATTERN "*.h")
endfunction()
