# SPDX-License-Identifier: MIT
# What the gallery and the benchmark measure: the error figures.
gnomon_test(visibility_errors_test
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/visibility_errors_test.cpp
  LIBRARIES gnomon_measure)
