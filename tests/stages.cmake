# SPDX-License-Identifier: MIT
# A program per stage: its laws (equals_reference, order_free, shape_free, survives_degenerates, writes_only_its_own,
# grows), with the exact predicates as the judge.
add_library(gnomon_stage_support STATIC ${CMAKE_CURRENT_LIST_DIR}/support/light_stages.cpp)
target_include_directories(gnomon_stage_support PUBLIC ${CMAKE_CURRENT_LIST_DIR})
target_link_libraries(gnomon_stage_support
  PUBLIC gnomon_inside gnomon_reference GTest::gtest PRIVATE gnomon_build_flags)

foreach(stage IN ITEMS bins camera clusters conservative_map decisions facing farthest_height izb light_frame
                      lit_receivers prepared_light samples scan sort trace triangle_setup)
  gnomon_test(${stage}_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/${stage}_test.cpp LIBRARIES gnomon_stage_support)
endforeach()

# A frame does not hang on the size of work-groups: with the kernels that are made for GPUs, too, also where the default
# device is a CPU.
add_test(NAME setup_in_any_shape_with_kernels_for_gpus
  COMMAND triangle_setup_test --gtest_filter=triangle_setup.shape_free)
set_tests_properties(setup_in_any_shape_with_kernels_for_gpus PROPERTIES
  TIMEOUT ${GNOMON_TEST_TIMEOUT_S} ENVIRONMENT "GNOMON_CACHE_DIR=${GNOMON_TEST_CACHE_DIR};GNOMON_GPU_KERNELS=1")
