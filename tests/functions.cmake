# SPDX-License-Identifier: MIT
# Functions that register tests.
#
#   gnomon_test(name SOURCES a.cpp ... [LIBRARIES targets ...] [LABEL label] [TIMEOUT seconds])
#     A GoogleTest program `name`; each of its tests becomes a ctest test. Paths are relative to the calling
#     CMakeLists.txt.
#
#   gnomon_oclgrind_test(name COMMAND program [arguments ...] [TIMEOUT seconds])
#     Runs a program (a path or a target) under oclgrind (memory accesses, races, API calls). Fails when the program
#     fails or oclgrind reports anything at all. Label `oclgrind`. GNOMON_DEVICE is set, so a program that opened
#     another device fails instead of passing unchecked.
find_package(GTest REQUIRED)
include(GoogleTest)

# Compiled kernels of the tests stay in the build folder, so that a test run neither uses nor fills the user's cache.
set(GNOMON_TEST_CACHE_DIR "${PROJECT_BINARY_DIR}/test_kernel_cache")
set(GNOMON_TESTS_DIR "${CMAKE_CURRENT_LIST_DIR}")
# Under the sanitizers everything takes several times as long. LeakSanitizer's own tracer crashes at the end of one in
# some thousand programs (google/sanitizers issue 1353; seen here with PoCL's threads). If the test passed before the
# crash, ctest lists it as skipped, because its leaks are unknown.
set(GNOMON_TEST_TIMEOUT_S 300)
# A test program takes longer to compile than to run its own code; the oracle is a library, optimised in every build.
set(GNOMON_TEST_OPTIMISATION $<$<CONFIG:Release>:-O1>)
# The expression must not end with a bracket: gtest_discover_tests of CMake 4.4 puts it between brackets.
set(GNOMON_TEST_SKIPPED "\\[  SKIPPED \\] ")
if(GNOMON_SANITIZE)
  set(GNOMON_TEST_TIMEOUT_S 900)
  set(GNOMON_TEST_OPTIMISATION $<IF:$<BOOL:$<TARGET_PROPERTY:GNOMON_PLAIN>>,-O1,-O0>)
  string(APPEND GNOMON_TEST_SKIPPED "|PASSED  . 1 test.*LeakSanitizer has encountered a fatal error")
endif()

function(gnomon_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "TIMEOUT;LABEL" "SOURCES;LIBRARIES")
  if(NOT arg_SOURCES OR arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "gnomon_test(${name}): say SOURCES, and nothing but SOURCES, LIBRARIES, LABEL, TIMEOUT")
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT ${GNOMON_TEST_TIMEOUT_S})
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_compile_options(${name} PRIVATE ${GNOMON_TEST_OPTIMISATION})
  target_include_directories(${name} PRIVATE ${GNOMON_TESTS_DIR})
  target_link_libraries(${name} PRIVATE gnomon_build_flags ${arg_LIBRARIES} GTest::gtest_main)
  set(properties TIMEOUT ${arg_TIMEOUT} SKIP_REGULAR_EXPRESSION ${GNOMON_TEST_SKIPPED}
                 ENVIRONMENT "GNOMON_CACHE_DIR=${GNOMON_TEST_CACHE_DIR}")
  if(arg_LABEL)
    list(APPEND properties LABELS ${arg_LABEL})
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 120 PROPERTIES ${properties})
endfunction()

find_program(GNOMON_OCLGRIND oclgrind)
if(NOT GNOMON_OCLGRIND)
  message(STATUS "oclgrind not found: its tests are left out (Debian package oclgrind)")
endif()

function(gnomon_oclgrind_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "TIMEOUT" "COMMAND")
  if(NOT arg_COMMAND OR arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "gnomon_oclgrind_test(${name}): say COMMAND, and nothing but COMMAND and TIMEOUT")
  endif()
  # oclgrind is preloaded, and AddressSanitizer insists on being the first library loaded.
  if(NOT GNOMON_OCLGRIND OR GNOMON_SANITIZE)
    return()
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 600)
  endif()
  list(POP_FRONT arg_COMMAND program)
  if(TARGET ${program})
    set(program "$<TARGET_FILE:${program}>")
  endif()
  add_test(NAME ${name} COMMAND "${GNOMON_TESTS_DIR}/build/under_oclgrind.sh" "${GNOMON_OCLGRIND}" "${program}"
                                ${arg_COMMAND})
  set_tests_properties(${name} PROPERTIES LABELS oclgrind TIMEOUT ${arg_TIMEOUT})
endfunction()
