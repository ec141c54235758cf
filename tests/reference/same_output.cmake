# SPDX-License-Identifier: MIT
# cmake -DFIRST=program -DSECOND=program -P same_output.cmake: fails unless both succeed and print the same, not nothing.
execute_process(COMMAND ${FIRST} OUTPUT_VARIABLE first_output RESULT_VARIABLE first_result)
execute_process(COMMAND ${SECOND} OUTPUT_VARIABLE second_output RESULT_VARIABLE second_result)
if(NOT first_result EQUAL 0 OR NOT second_result EQUAL 0)
  message(FATAL_ERROR "one of the programs failed: ${first_result}, ${second_result}")
endif()
if(first_output STREQUAL "" OR NOT first_output STREQUAL second_output)
  message(FATAL_ERROR "the outputs differ:\n${first_output}\n---\n${second_output}")
endif()
message("${first_output}")
