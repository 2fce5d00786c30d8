# Installs the build into a fresh folder and lets another project find, link and run it, as an embedder would.
#   cmake -DBUILD=<build folder> -DSOURCE=<examples folder> -DCOMPILER=<C++ compiler> -DFLAGS=<its flags>
#         -P consumer_test.cmake
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\n${output}")
  endif()
endfunction()

set(folder ${BUILD}/consumer_test)
file(REMOVE_RECURSE ${folder})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${folder}/prefix)
run(${CMAKE_COMMAND} -G Ninja -S ${SOURCE} -B ${folder}/build -DCMAKE_PREFIX_PATH=${folder}/prefix
    -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_FLAGS=${FLAGS})
run(${CMAKE_COMMAND} --build ${folder}/build)
run(${folder}/build/embed)
set(INCLUDE ${folder}/prefix/include)
set(FOLDER ${folder})
include(${CMAKE_CURRENT_LIST_DIR}/headers_test.cmake)
run(${folder}/build/embedders)
run(${folder}/build/embed_c ${SOURCE}/cup.json)
# The example of a loop, and its device in another process, at shared memory that no other build uses. The loop begins when
# the device has written there what it is known by; the device would also end by itself.
string(RANDOM LENGTH 12 unique)
set(region lumbrical_device_${unique})
file(READ ${SOURCE}/devices/shared_memory.json profile)
string(REPLACE "\"/lumbrical_device\"" "\"/${region}\"" own_profile "${profile}")
if(own_profile STREQUAL profile)
  message(FATAL_ERROR "devices/shared_memory.json does not name /lumbrical_device any more; adapt this test")
endif()
file(WRITE ${folder}/shared_memory.json "${own_profile}")
file(WRITE ${folder}/loop.sh "
${folder}/build/shared_device /${region} 120 &
trap 'kill $! 2>/dev/null; wait; rm -f /dev/shm/${region}' EXIT
for i in $(seq 600); do grep -q LUMDEV01 /dev/shm/${region} 2>/dev/null && break; sleep 0.05; done
${folder}/build/loop ${SOURCE}/demo.json ${folder}/shared_memory.json 6
")
run(sh ${folder}/loop.sh)
# Without CMake: what pkg-config says, from a place that the installation was moved to.
file(RENAME ${folder}/prefix ${folder}/moved)
file(GLOB_RECURSE description ${folder}/moved/lumbrical.pc)
cmake_path(GET description PARENT_PATH description_folder)
cmake_path(GET description_folder PARENT_PATH libraries)
set(ENV{PKG_CONFIG_PATH} ${description_folder})
set(ENV{LD_LIBRARY_PATH} ${libraries})
find_program(PKG_CONFIG pkg-config)
if(PKG_CONFIG)
  run(sh -c "cc -std=c99 -pedantic ${SOURCE}/embed.c $(${PKG_CONFIG} --cflags --libs lumbrical) -lm -o ${folder}/by_pkg_config")
  run(${folder}/by_pkg_config ${SOURCE}/cup.json)
endif()
run(${folder}/moved/bin/lumbrical --version)
