# SPDX-License-Identifier: MIT
# Faults that a review found once, each as the smallest scene that shows it.
gnomon_test(regressions_test
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/regressions_test.cpp
  LIBRARIES gnomon_inside gnomon_reference)
target_compile_definitions(regressions_test PRIVATE GNOMON_KERNELS="${PROJECT_SOURCE_DIR}/kernels")
