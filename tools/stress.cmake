# SPDX-License-Identifier: MIT
# The stress suite: a library, which a test runs in small, and the tool that runs it for hours. Embree is asked too
# where its package (libembree-dev) is.
find_package(CLI11 REQUIRED)
find_package(fmt CONFIG REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(embree 3 QUIET)

add_library(gnomon_stress STATIC
  ${CMAKE_CURRENT_LIST_DIR}/stress/cases.cpp
  ${CMAKE_CURRENT_LIST_DIR}/stress/cut_out_cases.cpp
  ${CMAKE_CURRENT_LIST_DIR}/stress/exact_path.cpp
  ${CMAKE_CURRENT_LIST_DIR}/stress/judge.cpp
  ${CMAKE_CURRENT_LIST_DIR}/stress/points.cpp
  ${CMAKE_CURRENT_LIST_DIR}/stress/report.cpp
  ${CMAKE_CURRENT_LIST_DIR}/stress/run.cpp
  ${CMAKE_CURRENT_LIST_DIR}/stress/scenes.cpp
  ${CMAKE_CURRENT_LIST_DIR}/stress/$<IF:$<BOOL:${embree_FOUND}>,embree,no_embree>.cpp
)
target_include_directories(gnomon_stress PUBLIC ${CMAKE_CURRENT_LIST_DIR})
target_compile_definitions(gnomon_stress PRIVATE GNOMON_SCENES="${PROJECT_SOURCE_DIR}/scenes")
target_link_libraries(gnomon_stress
  PUBLIC gnomon_inside gnomon_reference
  PRIVATE gnomon_build_flags fmt::fmt gnomon_scene gnomon_scene_recipes nlohmann_json::nlohmann_json
          $<$<BOOL:${embree_FOUND}>:embree>)

add_executable(gnomon_stress_tool ${CMAKE_CURRENT_LIST_DIR}/stress/stress.cpp)
set_target_properties(gnomon_stress_tool PROPERTIES OUTPUT_NAME stress)
target_link_libraries(gnomon_stress_tool PRIVATE gnomon_stress gnomon_build_flags CLI11::CLI11)
