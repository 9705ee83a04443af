# Compile options of all targets, and functions that declare a test and a fuzz target.

find_package(Threads REQUIRED)

# A launcher of the command line or the environment has precedence, also an empty one.
find_program(PODM_CCACHE_PROGRAM ccache)
mark_as_advanced(PODM_CCACHE_PROGRAM)
foreach(language C CXX)
  if(PODM_CCACHE AND PODM_CCACHE_PROGRAM AND NOT DEFINED CMAKE_${language}_COMPILER_LAUNCHER)
    set(CMAKE_${language}_COMPILER_LAUNCHER ${PODM_CCACHE_PROGRAM})
  endif()
endforeach()

set(podm_march "")
if(PODM_MARCH)
  set(podm_march -march=${PODM_MARCH})
endif()
add_library(podm_flags INTERFACE)
target_compile_options(podm_flags INTERFACE ${podm_march} -ffp-contract=off -fno-math-errno -Wall -Wextra
                                            -Wshadow -Werror
                                            -Wno-psabi)  # vectors are passed only within a file
target_compile_definitions(podm_flags INTERFACE CGAL_LICENSE_ERROR=1)  # keeps the GPL parts of CGAL out
# The check that a program makes before it uses an instruction of x86-64-v3. A program links it, no library does.
if(PODM_MARCH STREQUAL "x86-64-v3" AND NOT PODM_SANITIZE)  # sanitizers have to be set up first
  add_library(podm_required_processor OBJECT cmake/required_processor.cpp)
  set(PODM_REQUIRED_PROCESSOR $<TARGET_OBJECTS:podm_required_processor>)
endif()

if(PODM_INTERLEAVING)
  add_compile_definitions(PODM_INTERLEAVING)
endif()
if(PODM_CHECK_LOCKS)
  add_compile_definitions(PODM_CHECK_LOCKS)
endif()
if(PODM_SANITIZE)
  add_compile_options(-fsanitize=${PODM_SANITIZE} -fno-omit-frame-pointer -g)
  add_link_options(-fsanitize=${PODM_SANITIZE})
endif()

# podm_sources(TARGET sources... [UNITED sources...]...): adds sources to a target. The sources after each UNITED may be
# compiled as one: none uses a private name of another, and none needs a speed that the other code could change. The
# templates that they share are then compiled once.
function(podm_sources target)
  set(group 0)
  foreach(source ${ARGN})
    if(source STREQUAL UNITED)
      math(EXPR group "${group} + 1")
      set_target_properties(${target} PROPERTIES UNITY_BUILD ${PODM_UNITE} UNITY_BUILD_MODE GROUP)
    else()
      target_sources(${target} PRIVATE ${source})
      if(group)
        set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
      endif()
    endif()
  endforeach()
endfunction()

# A Python test that cannot run here prints `skipped: why` and runs nothing. ctest lists it as skipped, not as passed or
# failed. A GoogleTest program passes; `make test` lists the reasons of its skipped tests.
set(PODM_SKIPPED "Ran 0 tests in [^\n]*\n\n(OK|NO TESTS RAN) \\(skipped=")

# podm_add_test(NAME SOURCES... LIBS targets...): a GoogleTest program, built by `tests`, and a ctest case of that name.
# One case per TEST would take three more minutes for all: most tests are shorter than the start of their program.
function(podm_add_test name)
  if(NOT PODM_BUILD_TESTS)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBS" ${ARGN})
  add_executable(${name} EXCLUDE_FROM_ALL ${ARG_SOURCES})
  add_dependencies(tests ${name})
  target_link_libraries(${name} PRIVATE ${ARG_LIBS} podm_flags GTest::gtest_main)
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)  # tests are compiled more often than run
  # Most of the time to compile a test goes to headers that the other tests also include.
  set_target_properties(${name} PROPERTIES UNITY_BUILD ${PODM_UNITE} UNITY_BUILD_BATCH_SIZE 8)
  add_test(NAME ${name} COMMAND ${name} --gtest_brief=1)
  set_tests_properties(${name} PROPERTIES TIMEOUT 1800 COST 50 ENVIRONMENT PODM_BENCH_UNTIMED=1)
endfunction()

# podm_add_python_test(NAME COMMAND Python's arguments... [TIMEOUT seconds] [ENVIRONMENT NAME=value...]): runs Python in
# this folder as a ctest case. Debian's modules belong to the system's Python, which need not be first on the path.
function(podm_add_python_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "COMMAND;ENVIRONMENT" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  find_program(PODM_SYSTEM_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH REQUIRED)
  add_test(NAME ${name} COMMAND ${PODM_SYSTEM_PYTHON} -B ${ARG_COMMAND}
           WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
  set(shared_modules PYTHONPATH=path_list_append:${PROJECT_SOURCE_DIR}/scripts/tests)
  # Long tests start first, so that none runs alone at the end.
  set_tests_properties(${name} PROPERTIES TIMEOUT ${ARG_TIMEOUT} COST 100
                                          ENVIRONMENT "PODM_BENCH_UNTIMED=1;${ARG_ENVIRONMENT}"
                                          ENVIRONMENT_MODIFICATION "${shared_modules}"
                                          SKIP_REGULAR_EXPRESSION "${PODM_SKIPPED}")
endfunction()

# The main program of a fuzz target that is not linked with libFuzzer.
add_library(podm_replay OBJECT EXCLUDE_FROM_ALL ci/replay_corpus.cpp)
target_link_libraries(podm_replay PRIVATE podm_flags)

# podm_add_fuzzer(NAME [SOURCES...] LIBS targets... [LEARN targets...]): the fuzz target of fuzz/NAME.cpp and SOURCES.
# With PODM_BUILD_FUZZERS it is a libFuzzer program, guided by the branches taken in its own sources and in the
# libraries LEARN. In any other build the ctest case fuzz.NAME runs the target on each file of fuzz/corpus/NAME.
function(podm_add_fuzzer name)
  if(NOT PODM_BUILD_FUZZERS AND NOT PODM_BUILD_TESTS)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBS;LEARN" ${ARGN})
  add_executable(${name} EXCLUDE_FROM_ALL fuzz/${name}.cpp ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/ci)
  target_link_libraries(${name} PRIVATE ${ARG_LIBS} podm_flags)
  if(NOT PODM_BUILD_FUZZERS)
    target_link_libraries(${name} PRIVATE podm_replay)
    add_dependencies(tests ${name})
    add_test(NAME fuzz.${name} COMMAND ${name} ${CMAKE_CURRENT_SOURCE_DIR}/fuzz/corpus/${name})
    set_tests_properties(fuzz.${name} PROPERTIES TIMEOUT 300)
    return()
  endif()
  target_link_options(${name} PRIVATE -fsanitize=fuzzer)
  foreach(target ${name} ${ARG_LEARN})
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  endforeach()
endfunction()
