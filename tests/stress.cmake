# SPDX-License-Identifier: MIT
# The stress suite in small. Its library belongs to the tools.
if(TARGET gnomon_stress)
  gnomon_test(stress_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/stress_test.cpp LIBRARIES gnomon_stress)
  target_compile_definitions(stress_test PRIVATE
    GNOMON_SHARED_SCENES="${PROJECT_SOURCE_DIR}/../shared/scenes")
endif()
