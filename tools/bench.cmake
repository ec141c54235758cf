# SPDX-License-Identifier: MIT
# The benchmark, as build/tools/bench; needs no image library but stb, so that it builds on a bare GPU machine. With
# Embree 3 (Debian's libembree-dev) it measures that beside gnomon.
find_package(CLI11 REQUIRED)
find_package(Threads REQUIRED)
find_package(embree 3 QUIET)
if(NOT TARGET gnomon_reference)
  add_subdirectory(${PROJECT_SOURCE_DIR}/tests/reference ${PROJECT_BINARY_DIR}/tests/reference)
endif()

add_library(gnomon_bench_parts STATIC
  bench/experiments.cpp
  bench/json.cpp
  bench/many_lights.cpp
  bench/reduced_mask.cpp
  bench/runner.cpp
  bench/sweep.cpp
  bench/terrain_raster.cpp
  bench/thread_table.cpp
  $<IF:$<BOOL:${embree_FOUND}>,bench/embree_lights.cpp;bench/embree_peer.cpp;bench/embree_rays.cpp;bench/embree_scene.cpp,bench/no_peers.cpp>
)
gnomon_embed_files(gnomon_bench_parts embedded_tables tools/bench/suns_of_latitude_52.csv)
target_link_libraries(gnomon_bench_parts
  PUBLIC gnomon_bench_core
  PRIVATE gnomon_build_flags gnomon_scene_recipes gnomon_reference Threads::Threads $<$<BOOL:${embree_FOUND}>:embree>)

add_executable(gnomon_bench bench/main.cpp)
set_target_properties(gnomon_bench PROPERTIES OUTPUT_NAME bench)
target_link_libraries(gnomon_bench PRIVATE gnomon_bench_parts gnomon_build_flags CLI11::CLI11)
