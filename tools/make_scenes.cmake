# SPDX-License-Identifier: MIT
# The scene maker, as build/tools/make_scenes. It needs CLI11, {fmt}, stb and nlohmann-json, nothing of gnomon. Its
# recipes are a library, for the benchmark and the stress suite.
find_package(CLI11 REQUIRED)
find_package(fmt CONFIG REQUIRED)
find_package(nlohmann_json REQUIRED)

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

add_executable(gnomon_make_scenes ${CMAKE_CURRENT_LIST_DIR}/make_scenes.cpp)
target_link_libraries(gnomon_make_scenes PRIVATE gnomon_scene_recipes gnomon_build_flags CLI11::CLI11 fmt::fmt)
set_target_properties(gnomon_make_scenes PROPERTIES OUTPUT_NAME make_scenes)
