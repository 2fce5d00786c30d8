# LZ4 and Zstandard as imported targets: not every distribution's packages bring a CMake config.
foreach(library lz4 zstd)
  if(NOT TARGET lumbrical_${library})
    set(header_lz4 lz4frame.h)
    set(header_zstd zstd.h)
    find_library(LUMBRICAL_${library}_LIBRARY ${library} REQUIRED)
    find_path(LUMBRICAL_${library}_INCLUDE ${header_${library}} REQUIRED)
    mark_as_advanced(LUMBRICAL_${library}_LIBRARY LUMBRICAL_${library}_INCLUDE)
    add_library(lumbrical_${library} INTERFACE IMPORTED GLOBAL)
    set_target_properties(lumbrical_${library} PROPERTIES
      INTERFACE_LINK_LIBRARIES ${LUMBRICAL_${library}_LIBRARY}
      INTERFACE_INCLUDE_DIRECTORIES ${LUMBRICAL_${library}_INCLUDE})
  endif()
endforeach()
