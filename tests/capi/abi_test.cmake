# The binary interface of lumbrical.h (names, types, offsets) against the listing tests/capi/lumbrical.abi, with Debian's
# abigail-tools. It is that of a library whose functions do nothing: what stands behind the real one's has thousands of types
# that are no one's business, and another test holds its names against the header.
#   cmake -DCOMPILER=cc -DHEADER=engine/include/lumbrical.h -DLISTING=tests/capi/lumbrical.abi -DFOLDER=... [-DWRITE=ON] -P abi_test.cmake
# WRITE writes the listing anew, after a change that was meant: CHANGELOG.md says which number of the version it moves.
find_program(ABIDW abidw)
find_program(ABIDIFF abidiff)
if(NOT ABIDW OR NOT ABIDIFF)
  message("skipped: abidw or abidiff is missing; install abigail-tools")
  return()
endif()
function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${FOLDER} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(result)
    message(FATAL_ERROR "${ARGN}\n${output}\nIf a change of the interface is meant, write the listing anew (see this "
                        "script) and say it in CHANGELOG.md.")
  endif()
endfunction()
file(READ ${HEADER} text)
string(REGEX REPLACE "(LUMBRICAL_API void [^;]*);" "\\1 {}" text "${text}")
string(REGEX REPLACE "(LUMBRICAL_API [^;{]*\\));" "\\1 { return 0; }" text "${text}")
file(WRITE ${FOLDER}/lumbrical_interface.c "${text}")
run(${COMPILER} -std=c99 -g -w -shared -fPIC -fvisibility=hidden lumbrical_interface.c -o lumbrical_interface.so)
set(new ${FOLDER}/lumbrical.abi)
if(WRITE)
  set(new ${LISTING})
endif()
run(${ABIDW} --no-show-locs --no-corpus-path --no-comp-dir-path --no-elf-needed --type-id-style hash --out-file ${new}
    lumbrical_interface.so)
run(${ABIDIFF} --no-show-locs --harmless ${LISTING} ${new})
