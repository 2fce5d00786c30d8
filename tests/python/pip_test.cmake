# pip installs the source tree, with a build that is there already, and another process uses it.
#   cmake -DPYTHON=<python3> -DSOURCE=<source tree> -DBUILD=<build folder> -DFOLDER=<to install into> -P pip_test.cmake
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
set(ENV{LUMBRICAL_BUILD} ${BUILD})
# From a copy of what pip needs: it leaves folders of its own in the tree.
file(COPY ${SOURCE}/setup.py ${SOURCE}/pyproject.toml ${SOURCE}/README.md DESTINATION ${FOLDER}/tree)
execute_process(COMMAND ${PYTHON} -m pip install --no-build-isolation --no-deps --no-index --disable-pip-version-check
                        --target ${FOLDER}/site ${FOLDER}/tree COMMAND_ERROR_IS_FATAL ANY)
# Editable, its Python would be found and its C++ not: refused, with the reason.
execute_process(COMMAND ${PYTHON} -m pip install --no-build-isolation --no-deps --no-index --disable-pip-version-check
                        --prefix ${FOLDER}/editable -e ${FOLDER}/tree
                RESULT_VARIABLE editable OUTPUT_VARIABLE said ERROR_VARIABLE said)
if(editable EQUAL 0 OR NOT said MATCHES "use pip install [.]")
  message(FATAL_ERROR "pip install -e should be refused with a reason: ${said}")
endif()
set(ENV{PYTHONPATH} ${FOLDER}/site)
execute_process(COMMAND ${PYTHON} -c "import lumbrical, sys; print(lumbrical.__file__, lumbrical.make_mug()[0].shape); sys.exit(not lumbrical.__file__.startswith('${FOLDER}/site'))"
                WORKING_DIRECTORY ${FOLDER} COMMAND_ERROR_IS_FATAL ANY)
file(GLOB_RECURSE stubs ${FOLDER}/site/lumbrical/py.typed ${FOLDER}/site/lumbrical/__init__.pyi)
file(GLOB strangers RELATIVE ${FOLDER}/site ${FOLDER}/site/*)
list(FILTER strangers EXCLUDE REGEX "^lumbrical")
if(strangers)
  message(FATAL_ERROR "this was installed as well: ${strangers}")
endif()
list(LENGTH stubs count)
if(NOT count EQUAL 2)
  message(FATAL_ERROR "the type stubs are not installed: ${stubs}")
endif()
