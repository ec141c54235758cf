# SPDX-License-Identifier: MIT
# The scene maker, as build/tools/make_scenes. It needs CLI11, {fmt}, stb and nlohmann-json, nothing of gnomon. Its
# recipes are a library (bench_core.cmake), for the benchmark and the stress suite.
find_package(CLI11 REQUIRED)
find_package(fmt CONFIG REQUIRED)

add_executable(gnomon_make_scenes ${CMAKE_CURRENT_LIST_DIR}/make_scenes.cpp)
target_link_libraries(gnomon_make_scenes PRIVATE gnomon_scene_recipes gnomon_build_flags CLI11::CLI11 fmt::fmt)
set_target_properties(gnomon_make_scenes PROPERTIES OUTPUT_NAME make_scenes)
