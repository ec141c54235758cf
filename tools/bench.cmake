# SPDX-License-Identifier: MIT
# The benchmark, as build/tools/bench; needs no image library but stb, so that it builds on a bare GPU machine. With
# Embree 3 (Debian's libembree-dev) it measures that beside gnomon.
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(fmt CONFIG REQUIRED)
find_package(Threads REQUIRED)
find_package(embree 3 QUIET)
find_path(GNOMON_STB_INCLUDE stb_image.h PATH_SUFFIXES stb REQUIRED)
find_library(GNOMON_STB_LIBRARY stb REQUIRED)
if(NOT TARGET gnomon_reference)
  add_subdirectory(${PROJECT_SOURCE_DIR}/tests/reference ${PROJECT_BINARY_DIR}/tests/reference)
endif()

set(bench_generated ${PROJECT_BINARY_DIR}/tools/bench_generated)

# The commit, asked at each build: a figure says what it was measured on.
add_custom_target(gnomon_bench_commit
  COMMAND ${CMAKE_COMMAND} -D SOURCE_DIR=${PROJECT_SOURCE_DIR} -D OUTPUT=${bench_generated}/commit.hpp
          -P ${CMAKE_CURRENT_LIST_DIR}/bench/commit.cmake
  BYPRODUCTS ${bench_generated}/commit.hpp)

add_library(gnomon_bench_parts STATIC
  bench/cases.cpp
  bench/contestant.cpp
  bench/experiments.cpp
  bench/json.cpp
  bench/machine.cpp
  bench/many_lights.cpp
  bench/reduced_mask.cpp
  bench/row.cpp
  bench/runner.cpp
  bench/sweep.cpp
  bench/thread_table.cpp
  $<IF:$<BOOL:${embree_FOUND}>,bench/embree_lights.cpp;bench/embree_peer.cpp;bench/embree_rays.cpp;bench/embree_scene.cpp,bench/no_peers.cpp>
)
gnomon_embed_files(gnomon_bench_parts embedded_tables tools/bench/suns_of_latitude_52.csv)
add_dependencies(gnomon_bench_parts gnomon_bench_commit)
target_include_directories(gnomon_bench_parts PUBLIC ${CMAKE_CURRENT_LIST_DIR}
                                              PRIVATE ${bench_generated} ${GNOMON_STB_INCLUDE})
target_link_libraries(gnomon_bench_parts
  PUBLIC fmt::fmt gnomon_scene gnomon_measure gnomon_inside nlohmann_json::nlohmann_json
  PRIVATE gnomon_build_flags gnomon_scene_recipes gnomon_reference Threads::Threads ${GNOMON_STB_LIBRARY}
          $<$<BOOL:${embree_FOUND}>:embree>)

add_executable(gnomon_bench bench/main.cpp)
set_target_properties(gnomon_bench PROPERTIES OUTPUT_NAME bench)
target_link_libraries(gnomon_bench PRIVATE gnomon_bench_parts gnomon_build_flags CLI11::CLI11)
