# find_package(mjdiag [COMPONENTS signals diagnosis plugin discovery studies render
# report c]): targets mjdiag::<component>. Asks for the libraries of what is named, and
# of what that builds on, only; without COMPONENTS for all.
cmake_policy(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/Parts.cmake)

set(mjdiag_wanted ${mjdiag_FIND_COMPONENTS})
if(NOT mjdiag_wanted)
  set(mjdiag_wanted ${mjdiag_all_parts})
endif()
foreach(mjdiag_part IN LISTS mjdiag_wanted)
  if(NOT mjdiag_part IN_LIST mjdiag_all_parts)
    set(mjdiag_FOUND FALSE)
    list(JOIN mjdiag_all_parts ", " mjdiag_NOT_FOUND_MESSAGE)
    string(PREPEND mjdiag_NOT_FOUND_MESSAGE "no component '${mjdiag_part}', but: ")
    return()
  endif()
endforeach()
# From the top down, so that what a part needs is looked at after the part itself.
set(mjdiag_parts)
set(mjdiag_downwards ${mjdiag_all_parts})
list(REVERSE mjdiag_downwards)
foreach(mjdiag_part IN LISTS mjdiag_downwards)
  if(mjdiag_part IN_LIST mjdiag_wanted)
    list(PREPEND mjdiag_parts ${mjdiag_part})
    list(APPEND mjdiag_wanted ${mjdiag_${mjdiag_part}_needs})
  endif()
endforeach()

include(${CMAKE_CURRENT_LIST_DIR}/Dependencies.cmake)
foreach(mjdiag_part IN LISTS mjdiag_parts)
  include(${CMAKE_CURRENT_LIST_DIR}/${mjdiag_part}Targets.cmake)
  set(mjdiag_${mjdiag_part}_FOUND TRUE)
endforeach()
