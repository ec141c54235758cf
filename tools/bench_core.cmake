# SPDX-License-Identifier: MIT
# What the benchmark and `gnomon bench` share: the scenes that are made, the runs of one view that take turns, and their rows as
# JSON. Needs {fmt}, nlohmann-json and stb.
find_package(nlohmann_json REQUIRED)
find_package(fmt CONFIG REQUIRED)
find_path(GNOMON_STB_INCLUDE stb_image.h PATH_SUFFIXES stb REQUIRED)
find_library(GNOMON_STB_LIBRARY stb REQUIRED)

add_library(gnomon_scene_recipes STATIC
  ${CMAKE_CURRENT_LIST_DIR}/make_scenes/city.cpp
  ${CMAKE_CURRENT_LIST_DIR}/make_scenes/colonnade.cpp
  ${CMAKE_CURRENT_LIST_DIR}/make_scenes/edge_scenes.cpp
  ${CMAKE_CURRENT_LIST_DIR}/make_scenes/foliage.cpp
  ${CMAKE_CURRENT_LIST_DIR}/make_scenes/glb.cpp
  ${CMAKE_CURRENT_LIST_DIR}/make_scenes/leaves.cpp
  ${CMAKE_CURRENT_LIST_DIR}/make_scenes/pipes.cpp
  ${CMAKE_CURRENT_LIST_DIR}/make_scenes/png.cpp
  ${CMAKE_CURRENT_LIST_DIR}/make_scenes/recipes.cpp
  ${CMAKE_CURRENT_LIST_DIR}/make_scenes/shapes.cpp
  ${CMAKE_CURRENT_LIST_DIR}/make_scenes/small_scenes.cpp
  ${CMAKE_CURRENT_LIST_DIR}/make_scenes/terrain.cpp
  ${CMAKE_CURRENT_LIST_DIR}/make_scenes/town.cpp
)
target_link_libraries(gnomon_scene_recipes PRIVATE gnomon_build_flags nlohmann_json::nlohmann_json)

set(bench_generated ${PROJECT_BINARY_DIR}/tools/bench_generated)

# The commit, asked at each build: a figure says what it was measured on.
add_custom_target(gnomon_bench_commit
  COMMAND ${CMAKE_COMMAND} -D SOURCE_DIR=${PROJECT_SOURCE_DIR} -D OUTPUT=${bench_generated}/commit.hpp
          -P ${CMAKE_CURRENT_LIST_DIR}/bench/commit.cmake
  BYPRODUCTS ${bench_generated}/commit.hpp)

add_library(gnomon_bench_core STATIC
  ${CMAKE_CURRENT_LIST_DIR}/bench/cases.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bench/contestant.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bench/machine.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bench/row.cpp
  ${CMAKE_CURRENT_LIST_DIR}/bench/row_json.cpp
)
add_dependencies(gnomon_bench_core gnomon_bench_commit)
target_include_directories(gnomon_bench_core PUBLIC ${CMAKE_CURRENT_LIST_DIR}
                                             PRIVATE ${bench_generated} ${GNOMON_STB_INCLUDE})
target_link_libraries(gnomon_bench_core
  PUBLIC fmt::fmt gnomon_scene gnomon_measure gnomon_inside nlohmann_json::nlohmann_json
  PRIVATE gnomon_build_flags gnomon_scene_recipes ${GNOMON_STB_LIBRARY})
