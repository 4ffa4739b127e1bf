# Makes one file of several tests: cmake -P JoinTests.cmake <result> <tests...>
# All of a test lies in one unnamed namespace inside mjdiag. In that it gets a namespace of
# its own, so that names of different tests do not meet.
cmake_policy(VERSION 3.25)
set(result ${CMAKE_ARGV3})
set(joined "")
math(EXPR last "${CMAKE_ARGC} - 1")
foreach(i RANGE 4 ${last})
  set(file ${CMAKE_ARGV${i}})
  file(READ ${file} text)
  string(REPLACE "\nnamespace {\n" "\nnamespace { namespace test_${i} {\n" text "${text}")
  string(REPLACE "\n}  // namespace\n" "\n}}\n" text "${text}")
  string(APPEND joined "#line 1 \"${file}\"\n${text}")
endforeach()
file(WRITE ${result} "${joined}")
