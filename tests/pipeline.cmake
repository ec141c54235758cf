# SPDX-License-Identifier: MIT
# The pipeline as a whole: frustum-traced against the oracle, the library as an embedder uses it, and small cases under
# oclgrind.
gnomon_test(frustum_traced_test
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/frustum_traced_test.cpp
  LIBRARIES gnomon_inside gnomon_scene gnomon_reference)
target_compile_definitions(frustum_traced_test PRIVATE
  GNOMON_SHARED_SCENES="${PROJECT_SOURCE_DIR}/../shared/scenes" GNOMON_SCENES="${PROJECT_SOURCE_DIR}/scenes")

gnomon_test(library_test
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/library_test.cpp
  LIBRARIES gnomon_inside gnomon_reference)
target_compile_definitions(library_test PRIVATE GNOMON_KERNELS="${PROJECT_SOURCE_DIR}/kernels")

add_executable(oclgrind_cases ${CMAKE_CURRENT_LIST_DIR}/oclgrind_cases.cpp)
target_link_libraries(oclgrind_cases PRIVATE gnomon_inside gnomon_reference gnomon_build_flags)
gnomon_oclgrind_test(oclgrind_cases COMMAND oclgrind_cases)
# The same program on the default device, so that what it expects is known to be right; in memory that is not zero when
# it is new (a C library setting that PoCL's buffers follow), so that nothing is right only because memory happens to be
# zero. oclgrind's own check for that is not to be had: see tests/build/under_oclgrind.sh.
add_test(NAME oclgrind_cases_in_dirty_memory COMMAND oclgrind_cases)
set_tests_properties(oclgrind_cases_in_dirty_memory PROPERTIES
  TIMEOUT ${GNOMON_TEST_TIMEOUT_S} ENVIRONMENT "GNOMON_CACHE_DIR=${GNOMON_TEST_CACHE_DIR};MALLOC_PERTURB_=1")
# And with the kernels that are made for GPUs, where the default device is a CPU.
add_test(NAME oclgrind_cases_with_kernels_for_gpus COMMAND oclgrind_cases)
set_tests_properties(oclgrind_cases_with_kernels_for_gpus PROPERTIES
  TIMEOUT ${GNOMON_TEST_TIMEOUT_S} ENVIRONMENT "GNOMON_CACHE_DIR=${GNOMON_TEST_CACHE_DIR};GNOMON_GPU_KERNELS=1")
