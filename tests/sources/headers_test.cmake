# What others warn of and we don't ask for ourselves: no public header is to be blamed by a parent's flags.
#   cmake -DINCLUDE=<folder with lumbrical.h> -DCOMPILER=<C++ compiler> -DFOLDER=<to write in> -P headers_test.cmake
file(GLOB headers RELATIVE ${INCLUDE} ${INCLUDE}/lumbrical.h ${INCLUDE}/lumbrical/*.h)
list(TRANSFORM headers REPLACE "(.+)" "#include \"\\1\"")
list(JOIN headers "\n" text)
file(WRITE ${FOLDER}/headers.cpp "${text}\n")
execute_process(
  COMMAND ${COMPILER} -std=c++20 -fsyntax-only -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion
          -Wcast-align -Wnon-virtual-dtor -Woverloaded-virtual -Wdouble-promotion -Wundef -Werror -I${INCLUDE} ${FOLDER}/headers.cpp
  RESULT_VARIABLE result ERROR_VARIABLE output)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "${output}")
endif()
