# SPDX-License-Identifier: MIT
# The exact predicates, level by level, and the check of the device's arithmetic at start-up.
gnomon_test(predicates_test
  SOURCES
    ${CMAKE_CURRENT_LIST_DIR}/predicates_test.cpp
    ${CMAKE_CURRENT_LIST_DIR}/predicates/cases.cpp
    ${CMAKE_CURRENT_LIST_DIR}/predicates/truth.cpp
  LIBRARIES gnomon_inside gnomon_reference)
target_compile_definitions(predicates_test PRIVATE
  PREDICATES_KERNELS="${CMAKE_CURRENT_LIST_DIR}/predicates/predicates.cl")

gnomon_test(soft_double_test
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/soft_double_test.cpp ${CMAKE_CURRENT_LIST_DIR}/predicates/cases.cpp
  LIBRARIES gnomon_inside gnomon_reference)
target_compile_definitions(soft_double_test PRIVATE
  SOFT_DOUBLE_KERNELS="${CMAKE_CURRENT_LIST_DIR}/predicates/soft_double.cl")

gnomon_test(self_check_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/self_check_test.cpp LIBRARIES gnomon_inside)

gnomon_oclgrind_test(predicates_under_oclgrind
  COMMAND ${CMAKE_COMMAND} -E env GNOMON_PREDICATE_TRIALS=500
          $<TARGET_FILE:predicates_test> --gtest_filter=Inputs/*:Accumulator.*)
gnomon_oclgrind_test(self_check_under_oclgrind COMMAND self_check_test --gtest_filter=SelfCheck.Finds*:SelfCheck.Leaves*)
