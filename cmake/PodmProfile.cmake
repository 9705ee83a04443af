# Profile-guided optimisation of the mesher by GCC. Two build folders make it, one in the other: scripts/build_profiled.
# mesher/CMakeLists.txt includes this file; verifiers and harness are compiled as ever.
#   write  in FOLDER/training: its programs count their branches, in FOLDER/training/profile
#   use    in FOLDER: these counts decide which code is inlined, unrolled and laid out for speed
set(PODM_PROFILE "" CACHE STRING "Profile of the mesher: write, use, or none if empty (scripts/build_profiled)")
if(NOT PODM_PROFILE)
  return()
endif()
if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  message(FATAL_ERROR "PODM_PROFILE: the profile is GCC's, and the compiler is ${CMAKE_CXX_COMPILER_ID}")
endif()
# The name of a file of counts is that of its object file, without the build folder.
add_compile_options(-fprofile-prefix-path=${PROJECT_BINARY_DIR})
if(PODM_PROFILE STREQUAL "write")
  add_compile_options(-fprofile-generate -fprofile-update=prefer-atomic -fprofile-dir=${PROJECT_BINARY_DIR}/profile)
  add_link_options(-fprofile-generate)
elseif(PODM_PROFILE STREQUAL "use")
  # Code that no run reached is optimised as without a profile. The folder is relative to the build folder, in which
  # Ninja compiles: `podm --version` prints it.
  # -ftracer, which -fprofile-use implies, copies code behind a choice of two values. The choice then becomes a jump
  # that the processor predicts badly: geometry/dihedral.h.
  add_compile_options(-fprofile-use=training/profile -fprofile-partial-training -fprofile-correction -fno-tracer
                      -Wno-missing-profile)
else()
  message(FATAL_ERROR "PODM_PROFILE: write or use, not ${PODM_PROFILE}")
endif()
