# SPDX-License-Identifier: MIT
# The golden record: what an earlier commit answered, bit for bit. Needs the recipes of the scene maker.
if(NOT TARGET gnomon_scene_recipes)
  return()
endif()
set(golden_files ${CMAKE_CURRENT_LIST_DIR}/golden/shared_scenes.txt ${CMAKE_CURRENT_LIST_DIR}/golden/made_scenes.txt)
gnomon_test(golden_test
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/golden/golden_test.cpp
  LIBRARIES gnomon_inside gnomon_scene gnomon_scene_recipes gnomon_reference)
target_include_directories(golden_test PRIVATE ${PROJECT_SOURCE_DIR})
target_compile_definitions(golden_test PRIVATE
  GNOMON_GOLDEN="${CMAKE_CURRENT_LIST_DIR}/golden"
  GNOMON_SHARED_SCENES="${PROJECT_SOURCE_DIR}/../shared/scenes" GNOMON_SCENES="${PROJECT_SOURCE_DIR}/scenes")
# Each line is a test of its own: with other lines there are other tests.
set_property(TARGET golden_test APPEND PROPERTY LINK_DEPENDS ${golden_files})
