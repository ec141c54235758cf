# SPDX-License-Identifier: MIT
# A document's listing is a part of the example that the tests compile and run, to the letter, and at most 14 lines long:
# the lines between "// README begins" and "// README ends".
# cmake -D README=... -D EXAMPLE=... [-D LANGUAGE=c] -P readme_shows_example.cmake
if(NOT LANGUAGE)
  set(LANGUAGE cpp)
endif()
string(HEX "${LANGUAGE}" language)
file(READ "${README}" readme HEX)
file(READ "${EXAMPLE}" example HEX)
# Hex, because as text CMake would take semicolons and brackets for lists.
set(begins "2f2f20524541444d4520626567696e730a")
set(ends "202020202f2f20524541444d4520656e6473")
string(FIND "${example}" "${begins}" first)
string(FIND "${example}" "${ends}" last)
if(first EQUAL -1 OR last EQUAL -1)
  message(FATAL_ERROR "${EXAMPLE} must hold the lines \"// README begins\" and \"// README ends\"")
endif()
string(LENGTH "${begins}" length)
math(EXPR first "${first} + ${length}")
math(EXPR length "${last} - ${first}")
string(SUBSTRING "${example}" ${first} ${length} excerpt)
# "```cpp\n", the excerpt, "```\n".
string(FIND "${readme}" "606060${language}0a${excerpt}6060600a" at)
if(at EQUAL -1)
  message(FATAL_ERROR "${README} does not show the lines that ${EXAMPLE} marks: copy them into the ```${LANGUAGE} block")
endif()
string(REGEX MATCHALL "0a" line_ends "${excerpt}")
list(LENGTH line_ends line_count)
if(line_count GREATER 14)
  message(FATAL_ERROR "${EXAMPLE} marks ${line_count} lines; 14 is what a README can bear")
endif()
