# SPDX-License-Identifier: MIT
# Functions that register tests.
#
#   gnomon_test(name SOURCES a.cpp ... [LIBRARIES targets ...] [LABEL label] [SHARDS count])
#     A GoogleTest program `name`, one ctest test, or SHARDS of them, each with a part of the cases. Its label is the wing that its first source lies in (tests/WING/),
#     unless LABEL says another. Cases with `Exhaustive` in their names are a test of their own, `name_exhaustive`, with
#     the label `exhaustive`: tools/test.sh leaves it to --ci. Paths are relative to the calling CMakeLists.txt.
#
#   gnomon_check(name COMMAND program [arguments ...] [TIMEOUT seconds] [LABELS labels ...] [ENVIRONMENT variables ...])
#     Any other ctest test, with the tests' kernel cache and a time limit.
#
#   gnomon_oclgrind_test(name COMMAND program [arguments ...])
#     Runs a program (a path or a target) under oclgrind (memory accesses, races, API calls). Fails when the program
#     fails or oclgrind reports anything at all. Label `oclgrind`. GNOMON_DEVICE is set, so a program that opened
#     another device fails instead of passing unchecked.
#
# Labels: each wing's name (tools/test.sh WING), `quick` (tools/test.sh quick), `exhaustive` (tools/test.sh --ci alone).
find_package(GTest REQUIRED)

# Compiled kernels of the tests stay in the build folder, so that a test run neither uses nor fills the user's cache.
set(GNOMON_TEST_CACHE_DIR "${PROJECT_BINARY_DIR}/test_kernel_cache")
set(GNOMON_TESTS_DIR "${CMAKE_CURRENT_LIST_DIR}")
# A limit ends a test that hangs; it is about ten times what the test takes on two cores, and a slow machine makes it
# longer by a setting. Compiling kernels takes longest, so the tests that launch most kernels come first, with a limit of
# their own (label `compile`).
set(GNOMON_TEST_TIME_SCALE 1 CACHE STRING "Factor for the time limits of all tests, for slow machines")
set(GNOMON_TEST_TIMEOUT_S 600)
set(GNOMON_COMPILE_TESTS)
foreach(cases IN ITEMS "" _cut_outs _cut_outs_without_double _horizons)
  list(APPEND GNOMON_COMPILE_TESTS compile${cases}_for_cpus compile${cases}_for_gpus)
endforeach()
# A test program takes longer to compile than to run its own code; the oracle is a library, optimised in every build.
set(GNOMON_TEST_OPTIMISATION $<$<CONFIG:Release>:-O1>)
if(GNOMON_SANITIZE)
  set(GNOMON_TEST_TIMEOUT_S 1800)
  # Of each allocation its caller alone is kept: the oracle's code keeps no frame pointers, so that its stacks differ without
  # end, and AddressSanitizer took three quarters of the time to compare them. Run by hand, a program shows whole stacks.
  set(GNOMON_TEST_SANITIZERS ASAN_OPTIONS=malloc_context_size=2)
  set(GNOMON_TEST_OPTIMISATION $<IF:$<BOOL:$<TARGET_PROPERTY:GNOMON_PLAIN>>,-O1,-O0>)
endif()

function(gnomon_check name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "TIMEOUT" "LABELS;ENVIRONMENT;COMMAND")
  if(NOT arg_COMMAND OR arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "gnomon_check(${name}): say COMMAND, and nothing but COMMAND, TIMEOUT, LABELS, ENVIRONMENT")
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT ${GNOMON_TEST_TIMEOUT_S})
  endif()
  math(EXPR seconds "${arg_TIMEOUT} * ${GNOMON_TEST_TIME_SCALE}")
  add_test(NAME ${name} COMMAND ${arg_COMMAND})
  set_tests_properties(${name} PROPERTIES TIMEOUT ${seconds} LABELS "${arg_LABELS}"
    ENVIRONMENT "GNOMON_CACHE_DIR=${GNOMON_TEST_CACHE_DIR};${GNOMON_TEST_SANITIZERS};${arg_ENVIRONMENT}")
  foreach(label IN LISTS arg_LABELS)  # for the target tests_of_LABEL
    set_property(GLOBAL APPEND PROPERTY GNOMON_PROGRAMS_OF_${label} ${arg_COMMAND})
  endforeach()
  if(NOT name IN_LIST GNOMON_COMPILE_TESTS)
    set_tests_properties(${name} PROPERTIES DEPENDS "${GNOMON_COMPILE_TESTS}")
  endif()
endfunction()

function(gnomon_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "LABEL;SHARDS" "SOURCES;LIBRARIES")
  if(NOT arg_SOURCES OR arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "gnomon_test(${name}): say SOURCES, and nothing but SOURCES, LIBRARIES, LABEL, SHARDS")
  endif()
  set(exhaustive)
  foreach(source IN LISTS arg_SOURCES)
    get_filename_component(source "${source}" ABSOLUTE)
    file(STRINGS "${source}" lines REGEX "Exhaustive")
    list(APPEND exhaustive ${lines})
    if(NOT arg_LABEL)
      file(RELATIVE_PATH arg_LABEL "${GNOMON_TESTS_DIR}" "${source}")
      string(REGEX REPLACE "/.*" "" arg_LABEL "${arg_LABEL}")
    endif()
  endforeach()
  add_executable(${name} ${arg_SOURCES})
  target_compile_options(${name} PRIVATE ${GNOMON_TEST_OPTIMISATION})
  target_include_directories(${name} PRIVATE ${GNOMON_TESTS_DIR})
  target_link_libraries(${name} PRIVATE gnomon_build_flags ${arg_LIBRARIES} GTest::gtest_main)
  if(name IN_LIST GNOMON_QUICK_TESTS)
    list(APPEND arg_LABEL quick)
  endif()
  set(filter)
  if(exhaustive)
    set(filter --gtest_filter=-*Exhaustive*)
    gnomon_check(${name}_exhaustive TIMEOUT 1800 LABELS ${arg_LABEL} exhaustive
                 COMMAND ${name} --gtest_filter=*Exhaustive*)
  endif()
  if(NOT arg_SHARDS)
    gnomon_check(${name} LABELS ${arg_LABEL} COMMAND ${name} ${filter})
    return()
  endif()
  foreach(shard RANGE 1 ${arg_SHARDS})
    math(EXPR index "${shard} - 1")
    gnomon_check(${name}_${shard} LABELS ${arg_LABEL} COMMAND ${name} ${filter}
                 ENVIRONMENT GTEST_TOTAL_SHARDS=${arg_SHARDS} GTEST_SHARD_INDEX=${index})
  endforeach()
endfunction()

find_program(GNOMON_OCLGRIND oclgrind)
if(NOT GNOMON_OCLGRIND)
  message(STATUS "oclgrind not found: its tests are left out (Debian package oclgrind)")
endif()

function(gnomon_oclgrind_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "COMMAND")
  if(NOT arg_COMMAND OR arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "gnomon_oclgrind_test(${name}): say COMMAND, and nothing but COMMAND")
  endif()
  # oclgrind is preloaded, and AddressSanitizer insists on being the first library loaded.
  if(NOT GNOMON_OCLGRIND OR GNOMON_SANITIZE)
    return()
  endif()
  list(POP_FRONT arg_COMMAND program)
  if(TARGET ${program})
    set(program "$<TARGET_FILE:${program}>")
  endif()
  gnomon_check(${name} TIMEOUT 1200 LABELS oclgrind exhaustive
               COMMAND "${GNOMON_TESTS_DIR}/build/under_oclgrind.sh" "${GNOMON_OCLGRIND}" "${program}" ${arg_COMMAND})
endfunction()
