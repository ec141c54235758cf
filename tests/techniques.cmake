# SPDX-License-Identifier: MIT
# The techniques beside the exact one, each by properties of its own and against exact truth.
gnomon_test(conservative_map_alone_test
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/conservative_map_alone_test.cpp
  LIBRARIES gnomon_stage_support)

gnomon_test(shadow_volumes_test
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/shadow_volumes_test.cpp
  LIBRARIES gnomon_stage_support)

gnomon_test(sub_pixel_shadow_map_test
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/sub_pixel_shadow_map_test.cpp
  LIBRARIES gnomon_stage_support)
