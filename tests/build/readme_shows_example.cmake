# SPDX-License-Identifier: MIT
# The README's listing is the example that the tests compile and run, to the letter, and at most 40 lines long.
# cmake -D README=... -D EXAMPLE=... -P readme_shows_example.cmake
file(READ "${README}" readme HEX)
file(READ "${EXAMPLE}" example HEX)
# Hex, because as text CMake would take semicolons and brackets for lists. "```cpp\n", the example, "```\n".
string(FIND "${readme}" "6060606370700a${example}6060600a" at)
if(at EQUAL -1)
  message(FATAL_ERROR "${README} does not show ${EXAMPLE} as it is: copy its text into the ```cpp block")
endif()
string(REGEX MATCHALL "0a" line_ends "${example}")
list(LENGTH line_ends line_count)
if(line_count GREATER 40)
  message(FATAL_ERROR "${EXAMPLE} has ${line_count} lines; 40 is what a README can bear")
endif()
