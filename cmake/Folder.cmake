# What nearly every file includes, parsed once for all folders. The files still include what
# they use; MJDIAG_PRECOMPILE=OFF shows whether they do.
option(MJDIAG_PRECOMPILE "Precompile the common headers" ON)
# Several files are compiled as one, so that what they include and instantiate is
# translated once: half of the time of a build. Names in their unnamed namespaces then have
# to differ. OFF for tools that look at files one by one.
option(MJDIAG_UNITY "Compile several files as one" ON)

set(mjdiag_common_headers <Eigen/Core> <algorithm> <cmath> <filesystem> <functional> <map>
    <memory> <optional> <span> <string> <vector>)

# mjdiag_precompiled_set(<name> [LINKS <targets...>] HEADERS <headers...>) makes a set of
# precompiled headers that targets with the same options share.
function(mjdiag_precompiled_set name)
  cmake_parse_arguments(arg "" "" "LINKS;HEADERS" ${ARGN})
  if(NOT MJDIAG_PRECOMPILE)
    return()
  endif()
  file(WRITE ${PROJECT_BINARY_DIR}/${name}.cc "")
  add_library(${name} OBJECT ${PROJECT_BINARY_DIR}/${name}.cc)
  target_compile_features(${name} PUBLIC cxx_std_20)
  target_link_libraries(${name} PRIVATE ${arg_LINKS} mjdiag_warnings Eigen3::Eigen)
  target_precompile_headers(${name} PRIVATE ${arg_HEADERS})
endfunction()

# mjdiag_precompile(<target> <set>)
function(mjdiag_precompile target set)
  if(MJDIAG_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM ${set})
  endif()
endfunction()

mjdiag_precompiled_set(mjdiag_precompiled HEADERS ${mjdiag_common_headers})
if(TARGET mjdiag_precompiled)
  set_target_properties(mjdiag_precompiled PROPERTIES POSITION_INDEPENDENT_CODE ON)
endif()

# mjdiag_folder(<path> LINKS <targets...> [PRIVATE_LINKS <targets...>]
#               [HEADERS_OF <targets...>] [WITH <folders...>] [PART <part>]
#               [NOT_INSTALLED])
#
# Makes a library target from the .cc files directly in the folder <path>: for
# plugin/plant mjdiag_plugin_plant (alias mjdiag::plugin_plant). Its headers are
# reachable as "mjdiag/plugin/plant/..." only by targets that link it: each folder has
# an include root of its own that holds nothing but links to its headers. A folder that
# includes upwards in the table of the design therefore does not compile.
#
# WITH: folders inside <path> that belong to it, which may include its headers and not
# the other way round. HEADERS_OF: libraries of headers only, which a program that links
# the folder does not need. PART: of the installed package (Parts.cmake), by default the
# first folder of the path. Which headers are installed, docs/api.md says
# (InstallHeaders.cmake). NOT_INSTALLED: only the command has it.
function(mjdiag_folder path)
  cmake_parse_arguments(arg "NOT_INSTALLED" "PART" "LINKS;PRIVATE_LINKS;HEADERS_OF;WITH" ${ARGN})
  set(source ${PROJECT_SOURCE_DIR}/${path})
  set(folders ${source})
  foreach(inner IN LISTS arg_WITH)
    list(APPEND folders ${source}/${inner})
  endforeach()
  list(TRANSFORM folders APPEND /*.cc OUTPUT_VARIABLE sources)
  list(TRANSFORM folders APPEND /*.h OUTPUT_VARIABLE headers)
  file(GLOB sources CONFIGURE_DEPENDS ${sources})
  file(GLOB headers CONFIGURE_DEPENDS RELATIVE ${source} ${headers})
  string(REPLACE "/" "_" name ${path})
  set(root ${PROJECT_BINARY_DIR}/include/${name})
  # Headers that are gone must not be found any more.
  file(REMOVE_RECURSE ${root})
  foreach(inner IN LISTS arg_WITH ITEMS .)
    file(MAKE_DIRECTORY ${root}/mjdiag/${path}/${inner})
  endforeach()
  foreach(header IN LISTS headers)
    file(CREATE_LINK ${source}/${header} ${root}/mjdiag/${path}/${header} SYMBOLIC)
  endforeach()
  set(target mjdiag_${name})
  add_library(${target} STATIC ${sources})
  add_library(mjdiag::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name}
                        POSITION_INDEPENDENT_CODE ON UNITY_BUILD ${MJDIAG_UNITY}
                        UNITY_BUILD_BATCH_SIZE 0)  # all of a folder
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${root}>
                                              $<INSTALL_INTERFACE:include>)
  # What reads the headers is built as the library is.
  foreach(definition IN LISTS mjdiag_processor_definitions)
    target_compile_definitions(${target}
                               INTERFACE $<INSTALL_INTERFACE:${definition}>)
  endforeach()
  foreach(option IN LISTS mjdiag_processor_options)
    target_compile_options(${target} INTERFACE $<INSTALL_INTERFACE:${option}>)
  endforeach()
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PUBLIC ${arg_LINKS} PRIVATE ${arg_PRIVATE_LINKS})
  foreach(library IN LISTS arg_HEADERS_OF ITEMS mjdiag_warnings)
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:${library}>)
  endforeach()
  mjdiag_precompile(${target} mjdiag_precompiled)
  if(arg_NOT_INSTALLED)
    return()
  endif()
  if(NOT arg_PART)
    string(REGEX MATCH "^[^/]+" arg_PART ${path})
  endif()
  install(TARGETS ${target} EXPORT mjdiag_${arg_PART} COMPONENT libmjdiag-dev)
endfunction()
