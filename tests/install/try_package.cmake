# Installs the build into an empty prefix, and builds and runs what others make of it.
#   cmake -DBUILD=<build> -DSOURCE=<this folder> [-DPYTHON=<interpreter>
#         -DPYTHON_FOLDER=<of packages, below the prefix>] -P try_package.cmake
set(work ${BUILD}/try_package)
set(prefix ${work}/prefix)
file(REMOVE_RECURSE ${work})
file(MAKE_DIRECTORY ${work})
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE text
                  ERROR_VARIABLE text WORKING_DIRECTORY ${work})
  if(status)
    message(FATAL_ERROR "${ARGN}\n${text}")
  endif()
  set(text "${text}" PARENT_SCOPE)
endfunction()
function(build source folder)
  run(${CMAKE_COMMAND} -G Ninja -S ${source} -B ${work}/${folder}
      -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_BUILD_TYPE=None
      "-DCMAKE_CXX_FLAGS=${FLAGS}")
  run(${CMAKE_COMMAND} --build ${work}/${folder})
endfunction()
function(expect words)
  if(NOT text MATCHES "${words}")
    message(FATAL_ERROR "'${words}' is not in: ${text}")
  endif()
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
file(CREATE_LINK ${prefix}/share/mjdiag/mjcf ${work}/mjcf SYMBOLIC)

build(${SOURCE} programs)
run(${work}/programs/newcomer ${prefix}/share/mjdiag/mjcf/ab383)
expect("zeta_x")
run(${work}/programs/example_signals)
expect("100 samples in m")
run(${work}/programs/example_c)
expect("^Detected: zeta_x = 1.2.\n$")

build(${SOURCE}/diagnosis_only diagnosis_only)
run(${prefix}/bin/mjdiag design --setup mjcf/ab383 --linear --out .)
run(${work}/diagnosis_only/example_diagnosis)
expect("no alarm")

if(PYTHON)
  run(${CMAKE_COMMAND} -E env PYTHONPATH=${prefix}/${PYTHON_FOLDER}
      ${PYTHON} -c "from mjdiag import *\nprint(Machine('mjcf/ab383'), Machine)")
  expect("AB383 wire bonder.*mjdiag.Machine")
endif()
