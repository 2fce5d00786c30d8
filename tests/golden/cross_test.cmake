# Cross-builds the golden hashes' check in FOLDER by engine/cmake/TOOLCHAIN.cmake and with FLAGS, and runs it as that file
# says. Says "skipped: " and why where one of the PROGRAMS this takes is missing.
foreach(program IN LISTS PROGRAMS)
  unset(found CACHE)
  find_program(found ${program})
  if(NOT found)
    # execute_process, since message() does not write to standard output.
    execute_process(COMMAND ${CMAKE_COMMAND} -E echo "skipped: ${program} is missing; tools/setup installs it")
    return()
  endif()
endforeach()

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "failed: ${ARGN}")
  endif()
endfunction()

run(${CMAKE_COMMAND} -S ${SOURCE} -B ${FOLDER} -G Ninja -DCMAKE_TOOLCHAIN_FILE=${SOURCE}/engine/cmake/${TOOLCHAIN}.cmake
    -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS_RELEASE=${FLAGS}" -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DLUMBRICAL_KERNEL_LEVEL=-O2 -DLUMBRICAL_WERROR=ON -DLUMBRICAL_GOLDEN=ON
    -DLUMBRICAL_TBB=OFF -DLUMBRICAL_OPENVDB=OFF -DLUMBRICAL_SESSION=OFF -DLUMBRICAL_PROGRAM=OFF -DLUMBRICAL_TESTS=OFF -DLUMBRICAL_BENCH=OFF)
run(${CMAKE_COMMAND} --build ${FOLDER} --target golden_hashes --parallel 2)
run(ctest --test-dir ${FOLDER} --output-on-failure)
