# Cross-builds for 64-bit ARM with Debian's g++-aarch64-linux-gnu and runs the results under qemu-user.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64;-L;/usr/aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH /usr/aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)

# xsimd is headers only and the same for every machine, but the rest of /usr/include is not.
if(EXISTS /usr/include/xsimd/xsimd.hpp)
  file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/headers)
  file(CREATE_LINK /usr/include/xsimd ${CMAKE_BINARY_DIR}/headers/xsimd SYMBOLIC)
  set(LUMBRICAL_XSIMD_INCLUDE ${CMAKE_BINARY_DIR}/headers CACHE PATH "")
endif()
