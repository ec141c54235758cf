# SPDX-License-Identifier: MIT
# The pipeline as a whole: frustum-traced against the oracle, the library as an embedder uses it, and small cases under
# oclgrind.
gnomon_test(frustum_traced_test
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/frustum_traced_test.cpp
  LIBRARIES gnomon::gnomon gnomon_scene gnomon_reference)
target_compile_definitions(frustum_traced_test PRIVATE
  GNOMON_SHARED_SCENES="${PROJECT_SOURCE_DIR}/../shared/scenes" GNOMON_SCENES="${PROJECT_SOURCE_DIR}/scenes")

gnomon_test(library_test
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/library_test.cpp
  LIBRARIES gnomon::gnomon gnomon_reference)
target_compile_definitions(library_test PRIVATE GNOMON_KERNELS="${PROJECT_SOURCE_DIR}/kernels")
