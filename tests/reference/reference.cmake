# SPDX-License-Identifier: MIT
# The reference and its own tests: each test twice, against the optimised reference and the one without optimisation,
# and one that compares what the two print. Included by tests/CMakeLists.txt.
if(NOT TARGET gnomon_reference)
  add_subdirectory(${CMAKE_CURRENT_LIST_DIR} ${PROJECT_BINARY_DIR}/tests/reference)
endif()

function(add_reference_test suffix optimisation label)
  add_executable(reference_test${suffix} ${PROJECT_SOURCE_DIR}/tests/reference/reference_test.cpp)
  add_executable(reference_digest${suffix} ${PROJECT_SOURCE_DIR}/tests/reference/digest.cpp)
  foreach(target reference_test${suffix} reference_digest${suffix})
    target_compile_options(${target} PRIVATE ${optimisation} -Wshadow)
    target_link_libraries(${target} PRIVATE gnomon_reference${suffix} gnomon_build_flags)
  endforeach()
  target_link_libraries(reference_test${suffix} PRIVATE GTest::gtest_main)
  gnomon_check(reference_test${suffix} LABELS ${label} COMMAND reference_test${suffix})
endfunction()

add_reference_test("" -O3 reference)
add_reference_test("_unoptimised" -O0 exhaustive)

gnomon_check(reference_is_the_same_at_both_optimisation_levels LABELS reference
  COMMAND ${CMAKE_COMMAND} -DFIRST=$<TARGET_FILE:reference_digest> -DSECOND=$<TARGET_FILE:reference_digest_unoptimised>
          -P ${CMAKE_CURRENT_LIST_DIR}/same_output.cmake)

# The tool is built when the tools are; its test needs it and OpenImageIO.
if(TARGET gnomon_check_view)
  find_package(OpenImageIO REQUIRED)
  add_executable(check_view_test ${PROJECT_SOURCE_DIR}/tests/reference/check_view_test.cpp)
  target_compile_options(check_view_test PRIVATE -Wshadow)
  target_compile_definitions(check_view_test PRIVATE CHECK_VIEW="$<TARGET_FILE:gnomon_check_view>")
  target_link_libraries(check_view_test PRIVATE gnomon_reference gnomon_build_flags OpenImageIO::OpenImageIO
                                                GTest::gtest_main)
  add_dependencies(check_view_test gnomon_check_view)
  gnomon_check(check_view_test LABELS reference COMMAND check_view_test)
endif()
