# Runs viewer_test.mjs. Says "skipped: " and why where the page has not been built or there is no browser.
find_program(CHROMIUM NAMES chromium chromium-browser google-chrome)
find_program(NODE node)
if(NOT EXISTS ${VIEWER}/viewer.html)
  set(missing "the viewer's page is not built; build the target viewer, which needs emscripten, node and npm")
elseif(NOT CHROMIUM)
  set(missing "chromium is missing; tools/setup installs it")
endif()
if(missing)
  # execute_process, since message() does not write to standard output.
  execute_process(COMMAND ${CMAKE_COMMAND} -E echo "skipped: ${missing}")
  return()
endif()
execute_process(COMMAND ${NODE} ${SOURCE}/tests/viewer/viewer_test.mjs ${PROGRAM} ${VIEWER} ${CHROMIUM} ${SOURCE}/examples/demo.json
                ${VIEWER}/screenshots RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "the viewer failed in the browser; its screenshots: ${VIEWER}/screenshots")
endif()
