# SPDX-License-Identifier: MIT
# What fails in the device, and what is too large for it.
gnomon_test(faults_test
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/faults_test.cpp
  LIBRARIES gnomon_inside gnomon_reference)
gnomon_test(parts_test
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/parts_test.cpp
  LIBRARIES gnomon_inside gnomon_reference)
