# Installs the build into an empty prefix and builds and runs a consumer of it.
#   cmake -DBUILD=<build> -DSOURCE=<this folder> -P try_package.cmake
set(work ${BUILD}/try_package)
set(prefix ${work}/prefix)
file(REMOVE_RECURSE ${work})
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE text
                  ERROR_VARIABLE text)
  if(status)
    message(FATAL_ERROR "${ARGN}\n${text}")
  endif()
endfunction()
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
run(${CMAKE_COMMAND} -G Ninja -S ${SOURCE} -B ${work}/consumer
    -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS=${FLAGS}")
run(${CMAKE_COMMAND} --build ${work}/consumer)
run(${work}/consumer/consumer ${prefix}/share/mjdiag/mjcf/ab383)
run(${prefix}/bin/mjdiag linearize --setup ${prefix}/share/mjdiag/mjcf/emps)
