# The program where the module of the voxel index is neither beside it nor anywhere else, and where it is.
file(REMOVE_RECURSE ${FOLDER})
file(COPY ${PROGRAM} DESTINATION ${FOLDER})
cmake_path(GET PROGRAM FILENAME name)
file(RPATH_REMOVE FILE ${FOLDER}/${name})  # as an installation does

function(inspect expected text)
  execute_process(COMMAND ${FOLDER}/${name} inspect ${MESH} --unit cm ${ARGN}
    RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL expected OR NOT output MATCHES "${text}")
    message(FATAL_ERROR "ended with ${result}, not ${expected}, and without \"${text}\":\n${output}")
  endif()
endfunction()

inspect(0 "watertight +yes")
inspect(2 "voxel needs OpenVDB" --broadphase voxel)
file(COPY ${MODULE} DESTINATION ${FOLDER})
inspect(0 "voxel index +[0-9]" --broadphase voxel)
file(REMOVE_RECURSE ${FOLDER})
