# SPDX-License-Identifier: MIT
# glTF files good and bad, the built-in sundial, and the defaults.
find_package(nlohmann_json REQUIRED)
gnomon_test(scene_test
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/scene_test.cpp
  LIBRARIES gnomon_scene nlohmann_json::nlohmann_json)
target_compile_definitions(scene_test PRIVATE GNOMON_SHARED_SCENES="${PROJECT_SOURCE_DIR}/../shared/scenes")
