# SPDX-License-Identifier: MIT
# The benchmark: the correctness of its errors and outputs, never its times.
if(NOT TARGET gnomon_bench)
  return()
endif()
find_package(Boost 1.74 REQUIRED)  # a strict XML parser
gnomon_test(bench_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/bench_test.cpp LIBRARIES gnomon_bench_parts Boost::headers)
add_dependencies(bench_test gnomon_bench)
target_compile_definitions(bench_test PRIVATE GNOMON_BENCH="$<TARGET_FILE:gnomon_bench>")
