# SPDX-License-Identifier: MIT
# Runs the scene maker as a person would, and compares the committed scenes with what it makes.
if(NOT TARGET gnomon_make_scenes)
  return()
endif()
find_package(nlohmann_json REQUIRED)
gnomon_test(make_scenes_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/make_scenes_test.cpp
            LIBRARIES nlohmann_json::nlohmann_json)
add_dependencies(make_scenes_test gnomon_make_scenes)
target_compile_definitions(make_scenes_test PRIVATE
  GNOMON_MAKE_SCENES="$<TARGET_FILE:gnomon_make_scenes>"
  GNOMON_SCENES_DIR="${CMAKE_CURRENT_LIST_DIR}/../scenes")
