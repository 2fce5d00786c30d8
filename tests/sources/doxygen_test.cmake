# The reference of the public headers can be made, without a warning.
#   cmake -DSOURCE=<root> -DFOLDER=<for the pages> -P doxygen_test.cmake
find_program(DOXYGEN doxygen)
if(NOT DOXYGEN)
  message("skipped: doxygen is missing; install it")
  return()
endif()
file(READ ${SOURCE}/docs/Doxyfile settings)
file(WRITE ${FOLDER}/Doxyfile "${settings}\nOUTPUT_DIRECTORY = ${FOLDER}\n")
execute_process(COMMAND ${DOXYGEN} ${FOLDER}/Doxyfile WORKING_DIRECTORY ${SOURCE}
  RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(result)
  message(FATAL_ERROR "${output}")
endif()
if(NOT EXISTS ${FOLDER}/html/structlumbrical_1_1Settings.html)
  message(FATAL_ERROR "no page about Settings in ${FOLDER}/html")
endif()
