# Compiles the C# example with the declarations for C# and runs it.
#   cmake -DMCS=<compiler> -DMONO=<runtime> -DSOURCE=<source tree> -DFOLDER=<for the program> -DLIBRARY=<liblumbrical.so>
#         -P csharp_test.cmake
set(program ${FOLDER}/embed_csharp.exe)
execute_process(COMMAND ${MCS} -unsafe -warnaserror -out:${program} ${SOURCE}/examples/csharp/Embed.cs
                        ${SOURCE}/bindings/csharp/Lumbrical.cs COMMAND_ERROR_IS_FATAL ANY)
cmake_path(GET LIBRARY PARENT_PATH folder)
set(ENV{LD_LIBRARY_PATH} ${folder})
execute_process(COMMAND ${MONO} ${program} ${SOURCE}/examples/cup.json COMMAND_ERROR_IS_FATAL ANY)
