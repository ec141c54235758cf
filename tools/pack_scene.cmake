# SPDX-License-Identifier: MIT
# The packer of scenes, as build/tools/pack_scene. It needs CLI11, nlohmann-json and meshoptimizer, and nothing of gnomon.
find_package(CLI11 REQUIRED)
find_package(fmt CONFIG REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(meshoptimizer CONFIG REQUIRED)

add_executable(gnomon_pack_scene ${CMAKE_CURRENT_LIST_DIR}/pack_scene.cpp)
target_link_libraries(gnomon_pack_scene PRIVATE gnomon_build_flags CLI11::CLI11 fmt::fmt nlohmann_json::nlohmann_json
                                                meshoptimizer::meshoptimizer)
set_target_properties(gnomon_pack_scene PROPERTIES OUTPUT_NAME pack_scene)
