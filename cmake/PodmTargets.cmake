# How every target of this project is compiled, and the one way to declare a test.

find_package(Threads REQUIRED)

add_library(podm_flags INTERFACE)
target_compile_options(podm_flags INTERFACE -march=${PODM_MARCH} -ffp-contract=off -fno-math-errno -Wall -Wextra
                                            -Wshadow -Werror)
target_compile_definitions(podm_flags INTERFACE CGAL_LICENSE_ERROR=1)  # no GPL part of CGAL slips in
if(PODM_SANITIZE)
  add_compile_options(-fsanitize=${PODM_SANITIZE} -fno-omit-frame-pointer -g)
  add_link_options(-fsanitize=${PODM_SANITIZE})
endif()

# podm_add_test(NAME SOURCES... LIBS targets...): a GoogleTest program; each TEST is a ctest case.
function(podm_add_test name)
  if(NOT PODM_BUILD_TESTS)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LIBS} podm_flags GTest::gtest_main)
  include(GoogleTest)
  gtest_discover_tests(${name} PROPERTIES TIMEOUT 300 DISCOVERY_TIMEOUT 60)
endfunction()
