# Debian packages, by `cpack -G DEB` in a build folder (tools/package):
#   liblumbrical0.1    the shared library for C
#   liblumbrical-dev   headers, static libraries, find_package, pkg-config
#   lumbrical          the program and its viewer
#   python3-lumbrical  the module
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME lumbrical)
set(CPACK_PACKAGE_VENDOR Lumbrical)
set(CPACK_PACKAGE_CONTACT "Lumbrical <lumbrical@example.org>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
# Files have the time of the commit, not that of the build.
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/same_times.cmake)
set(CPACK_COMPONENTS_ALL runtime dev tools)
if(TARGET lumbrical_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)

# lumbrical_package(COMPONENT NAME SECTION DEPENDS TEXT): DEPENDS besides the shared libraries that are found out
function(lumbrical_package component name section depends text)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${depends}" PARENT_SCOPE)
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "Haptic rendering of the whole human hand: ${text}" PARENT_SCOPE)
  install(FILES ${PROJECT_SOURCE_DIR}/engine/cmake/copyright DESTINATION share/doc/${name} COMPONENT ${component})
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz DESTINATION share/doc/${name} COMPONENT ${component})
endfunction()
set(soname_package liblumbrical${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(same "${soname_package} (= ${PROJECT_VERSION})")
set(static_needs "libtbb-dev, libflatbuffers-dev, liblz4-dev, libzstd-dev, zlib1g-dev, libmodbus-dev, libbullet-dev")
lumbrical_package(runtime ${soname_package} libs "" "shared library")
lumbrical_package(dev liblumbrical-dev libdevel "${same}, ${static_needs}" "for developers")
lumbrical_package(tools lumbrical science "" "program")
lumbrical_package(python python3-lumbrical python "python3, python3-numpy" "Python module")
# Who links with the library depends on what has its SONAME; the linker's cache is brought up to date.
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/shlibs
  "liblumbrical ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} ${soname_package} (>= ${PROJECT_VERSION})\n")
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_BINARY_DIR}/shlibs ${CMAKE_CURRENT_BINARY_DIR}/triggers)

# Debian's form of what there is to tell, of the last commit's date.
execute_process(COMMAND git log -1 --format=%cD WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
  OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT date)
  set(date "Thu, 01 Jan 1970 00:00:00 +0000")
endif()
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/changelog
  "lumbrical (${PROJECT_VERSION}) unstable; urgency=medium\n\n  * First packages.\n\n -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
execute_process(COMMAND gzip -9nkf ${CMAKE_CURRENT_BINARY_DIR}/changelog)
include(CPack)
