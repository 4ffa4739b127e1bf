# add_example(<component>) makes the program example_<component> from the code that
# docs/api.md shows under that heading.
set(API ${CMAKE_CURRENT_LIST_DIR}/../../docs/api.md)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${API})

# What stands in `text` behind `from` and before `to`.
function(text_between text from to result)
  string(FIND "${text}" "${from}" begin)
  if(begin EQUAL -1)
    message(FATAL_ERROR "docs/api.md: no '${from}'")
  endif()
  string(LENGTH "${from}" length)
  math(EXPR begin "${begin} + ${length}")
  string(SUBSTRING "${text}" ${begin} -1 text)
  string(FIND "${text}" "${to}" end)
  string(SUBSTRING "${text}" 0 ${end} text)
  set(${result} "${text}" PARENT_SCOPE)
endfunction()

function(add_example component)
  file(READ ${API} text)
  text_between("${text}" "\n## ${component}\n" "\n## " text)
  text_between("${text}" "```cpp\n" "```" code)
  string(REGEX MATCHALL "#include [^\n]+" includes "${code}")
  list(JOIN includes "\n" includes)
  string(REGEX REPLACE "#include [^\n]+\n" "" code "${code}")
  set(source ${CMAKE_CURRENT_BINARY_DIR}/example_${component}.cc)
  file(CONFIGURE OUTPUT ${source} @ONLY
       CONTENT "@includes@\n\nint main() {\n@code@}\n")
  add_executable(example_${component} ${source})
  target_link_libraries(example_${component} PRIVATE mjdiag::${component})
endfunction()
