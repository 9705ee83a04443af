# The build information of `PROGRAM --version`: compiler, flags, commit of its sources, versions of its libraries.

# podm_note_library(PROGRAM NAME [VERSION]): a library that PROGRAM links. Without VERSION, pkg-config is asked.
function(podm_note_library program name)
  set(version "${ARGN}")
  if(NOT version)
    find_package(PkgConfig QUIET)
    pkg_check_modules(podm_${name} QUIET ${name})
    set(version "${podm_${name}_VERSION}")
  endif()
  if(NOT version)
    set(version "of unknown version")
  endif()
  set_property(GLOBAL APPEND PROPERTY podm_libraries_of_${program} "${name} ${version}")
endfunction()

# Returns all compile flags of this folder, those of podm_flags included, without warnings and names of build folders,
# which change no program.
function(_podm_flags result)
  string(TOUPPER "${CMAKE_BUILD_TYPE}" type)
  get_target_property(options podm_flags INTERFACE_COMPILE_OPTIONS)
  get_directory_property(options_of_folder COMPILE_OPTIONS)
  list(APPEND options ${options_of_folder})
  list(FILTER options EXCLUDE REGEX "^-W|^-fprofile-(prefix-path|dir)")
  string(JOIN " " flags ${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${type}} ${options})
  set(${result} "${flags}" PARENT_SCOPE)
endfunction()

# podm_build_info(TARGET PROGRAM NAMESPACE FOLDER): TARGET defines NAMESPACE::build_info(), as declared in its
# build_info.h. Call it after all podm_note_library(PROGRAM ...). FOLDER holds the sources of PROGRAM only. The commit
# is the last one that changed FOLDER; a program therefore changes with its sources and not with every commit.
function(podm_build_info target program namespace folder)
  get_property(libraries GLOBAL PROPERTY podm_libraries_of_${program})
  list(REMOVE_DUPLICATES libraries)
  list(SORT libraries CASE INSENSITIVE)
  string(JOIN ", " libraries ${libraries})
  _podm_flags(flags)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/build_info.cpp)
  # Runs at every build, but writes the file only if it changes.
  add_custom_target(${target}_build_info BYPRODUCTS ${source} VERBATIM COMMENT "Commit of ${program}" COMMAND ${CMAKE_COMMAND}
    "-DOUTPUT=${source}" "-DNAMESPACE=${namespace}" "-DROOT=${PROJECT_SOURCE_DIR}"
    "-DPATHS=${folder} cmake CMakeLists.txt" "-DCOMPILER=${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}"
    "-DFLAGS=${flags}" "-DLIBRARIES=${libraries}" -P ${PROJECT_SOURCE_DIR}/cmake/WriteBuildInfo.cmake)
  add_dependencies(${target} ${target}_build_info)
  target_sources(${target} PRIVATE ${source})
  if(PODM_PROFILE)  # a profile is of sources with the same path, and this source is in the build folder
    set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS -Wno-coverage-mismatch)
  endif()
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
endfunction()
