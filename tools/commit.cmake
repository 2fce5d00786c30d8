# Writes commit_generated.h into OUTPUT, if it would change: cmake -DSOURCE=... -DOUTPUT=... -P commit.cmake
execute_process(COMMAND git describe --always --exclude=* --abbrev=8 --dirty=+ WORKING_DIRECTORY ${SOURCE}
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit unknown)
endif()
file(CONFIGURE OUTPUT ${OUTPUT}/commit_generated.h CONTENT "#define LUMBRICAL_COMMIT \"${commit}\"\n")
