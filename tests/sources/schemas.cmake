# Every schema is a later form of each released one: fields were added at the ends of tables and nothing else happened,
# so what was written then is read now. A schema that breaks this is told, which a third test makes sure of.
find_program(FLATC flatc REQUIRED)
file(GLOB releases CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/schemas/released/*)
foreach(release IN LISTS releases)
  get_filename_component(version ${release} NAME)
  foreach(name recording scene)
    add_test(NAME schemas.conform.${version}.${name}
      COMMAND ${FLATC} --conform ${release}/${name}.fbs ${PROJECT_SOURCE_DIR}/schemas/${name}.fbs)
    lumbrical_label(fast schemas.conform.${version}.${name})
  endforeach()
endforeach()
file(READ ${PROJECT_SOURCE_DIR}/schemas/recording.fbs text)
string(REPLACE "duration_ns:uint;" "" broken "${text}")
if(broken STREQUAL text)
  message(FATAL_ERROR "schemas/recording.fbs has no duration_ns any more; adapt this test")
endif()
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/broken_recording.fbs "${broken}")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/schemas/recording.fbs)
add_test(NAME schemas.conform.tells
  COMMAND ${FLATC} --conform ${PROJECT_SOURCE_DIR}/schemas/recording.fbs
          ${CMAKE_CURRENT_BINARY_DIR}/broken_recording.fbs)
set_tests_properties(schemas.conform.tells PROPERTIES WILL_FAIL TRUE LABELS fast)
