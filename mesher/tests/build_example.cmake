# Installs BUILD below SCRATCH, then configures, builds and runs EXAMPLE against the installation.
file(REMOVE_RECURSE ${SCRATCH})

function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()

if(SANITIZE)  # a program that links sanitized libraries must be sanitized, too
  set(flags -D CMAKE_CXX_FLAGS=-fsanitize=${SANITIZE})
endif()
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${SCRATCH}/prefix)
run(${CMAKE_COMMAND} -E env DESTDIR=${SCRATCH}/staged ${CMAKE_COMMAND} --install ${BUILD} --prefix /usr)
run(${CMAKE_COMMAND} -S ${EXAMPLE} -B ${SCRATCH}/build -D CMAKE_PREFIX_PATH=${SCRATCH}/prefix
    -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_BUILD_TYPE=Release ${flags})
run(${CMAKE_COMMAND} --build ${SCRATCH}/build)
run(${SCRATCH}/build/mesh_image phantom:spheres@24 5 ${SCRATCH}/example.vtu)
run(${SCRATCH}/prefix/bin/podm mesh phantom:spheres@24 --radius 5 -o ${SCRATCH}/installed.vtu)
if(EXISTS /usr/bin/Xvfb)  # tests that a moved installation runs without the sources
  foreach(root ${SCRATCH}/prefix ${SCRATCH}/staged/usr)
    run(${root}/bin/podm view ${SCRATCH}/installed.vtu -o ${SCRATCH}/installed.png --size 64x48)
    run(${root}/bin/podm mesh phantom:spheres@24 --radius 5 --verify -o ${SCRATCH}/staged.vtu
        --report ${SCRATCH}/staged.html)
  endforeach()
endif()

# The example needs only the public headers, so no other headers are installed.
file(GLOB_RECURSE headers RELATIVE ${SCRATCH}/prefix/include ${SCRATCH}/prefix/include/*)
foreach(header ${headers})
  if(NOT header MATCHES "^podm/[a-z_]+\\.h$")
    message(FATAL_ERROR "${header} is installed")
  endif()
endforeach()

file(SHA256 ${SCRATCH}/example.vtu by_example)
file(SHA256 ${SCRATCH}/installed.vtu by_program)
if(NOT by_example STREQUAL by_program)
  message(FATAL_ERROR "the library and the program differ")
endif()
