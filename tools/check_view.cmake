# SPDX-License-Identifier: MIT
# The outside checker, as build/tools/check_view: it knows the files that gnomon writes, and nothing of gnomon itself.
find_package(CLI11 REQUIRED)
find_package(fmt CONFIG REQUIRED)
find_package(OpenImageIO REQUIRED)
if(NOT TARGET gnomon_reference)
  add_subdirectory(${PROJECT_SOURCE_DIR}/tests/reference ${PROJECT_BINARY_DIR}/tests/reference)
endif()

add_executable(gnomon_check_view ${CMAKE_CURRENT_LIST_DIR}/check_view.cpp)
target_compile_options(gnomon_check_view PRIVATE -Wshadow)
target_link_libraries(gnomon_check_view PRIVATE gnomon_build_flags gnomon_reference CLI11::CLI11 fmt::fmt
                                                OpenImageIO::OpenImageIO)
set_target_properties(gnomon_check_view PROPERTIES OUTPUT_NAME check_view)
