# SPDX-License-Identifier: MIT
# Writes OUTPUT, a header with the commit of SOURCE_DIR; leaves it alone if it says so already.
cmake_minimum_required(VERSION 3.22)
execute_process(COMMAND git describe --always --dirty --abbrev=10 WORKING_DIRECTORY ${SOURCE_DIR}
                OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit "unknown")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "inline constexpr const char* commit = \"@commit@\";\n" @ONLY)
