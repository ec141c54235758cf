# SPDX-License-Identifier: MIT
# The command, run as a user runs it.
find_package(OpenImageIO REQUIRED)
find_package(nlohmann_json REQUIRED)
gnomon_test(command_test
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/command_test.cpp
  LIBRARIES OpenImageIO::OpenImageIO nlohmann_json::nlohmann_json)
target_compile_definitions(command_test PRIVATE GNOMON_BINARY="$<TARGET_FILE:gnomon_command>")
add_dependencies(command_test gnomon_command)
