# Compiles for WebAssembly with Debian's emscripten: programs without JavaScript of their own, which node runs through WASI
# (wasm_run.mjs) and a page through the few functions it needs. Kernels in lanes are those of 128 bits (SIMD128).
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR wasm32)
set(EMSCRIPTEN ON)
set(CMAKE_CXX_COMPILER em++)
set(CMAKE_AR emar)
set(CMAKE_RANLIB emranlib)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_EXECUTABLE_SUFFIX_CXX .wasm)
# On one thread: node 20 dies at its end while another one still compiles.
set(CMAKE_CROSSCOMPILING_EMULATOR node;--no-warnings;--single-threaded;${CMAKE_CURRENT_LIST_DIR}/wasm_run.mjs)
# xsimd has no lanes of WebAssembly; those of SSE2 are translated one to one by emscripten's headers. Clang 14 must not put
# plain numbers into lanes of its own: it gets a sum of three vectors wrong by centimetres (fist_frame of
# tests/support/fists.h). By -mllvm, since -fno-slp-vectorize is undone by an -O2 that comes later.
set(CMAKE_CXX_FLAGS_INIT "-msimd128 -msse2 -mllvm -vectorize-slp=false -include ${CMAKE_CURRENT_LIST_DIR}/wasm_standard_library.h")
# Beyond -O1 em++ optimises the JavaScript that nobody asks for, with a package that Debian's emscripten does not bring.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-O1 -sSTANDALONE_WASM -sALLOW_MEMORY_GROWTH -sTOTAL_STACK=4MB")

# Headers only and the same for every machine, but the rest of /usr/include is not.
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/headers)
foreach(library xsimd flatbuffers nlohmann)
  if(EXISTS /usr/include/${library})
    file(CREATE_LINK /usr/include/${library} ${CMAKE_BINARY_DIR}/headers/${library} SYMBOLIC)
  endif()
endforeach()
if(EXISTS /usr/include/xsimd/xsimd.hpp)
  set(LUMBRICAL_XSIMD_INCLUDE ${CMAKE_BINARY_DIR}/headers CACHE PATH "")
endif()
