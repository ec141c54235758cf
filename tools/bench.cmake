# SPDX-License-Identifier: MIT
# The benchmark; needs no image library, so that it builds on a bare GPU machine.
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
add_executable(gnomon_bench bench.cpp)
set_target_properties(gnomon_bench PROPERTIES OUTPUT_NAME bench)
target_link_libraries(gnomon_bench PRIVATE gnomon_scene gnomon::gnomon gnomon_build_flags nlohmann_json::nlohmann_json
                                           CLI11::CLI11)
