# SPDX-License-Identifier: MIT
# The shadow-map family: each stage by properties of its own, then compositions against exact truth.
foreach(stage IN ITEMS depth_lookup depth_pass diagnostic lamp_perspective mip_chain projection rectilinear_warp shadow_map soft_shadow
              virtual_map visibility_bounds)
  gnomon_test(${stage}_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/shadow_map/${stage}_test.cpp
              LIBRARIES gnomon_stage_support)
endforeach()
