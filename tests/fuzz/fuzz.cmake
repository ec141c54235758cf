# SPDX-License-Identifier: MIT
# Fuzz targets. In every build the saved corpus is replayed as a test; with GNOMON_FUZZ (tools/fuzz.sh) the fuzzers
# themselves are built too.
function(gnomon_fuzz_target name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "CORPUS" "SOURCES;FUZZER_SOURCES;LIBRARIES;LINK_OPTIONS")
  add_executable(${name}_replay ${arg_SOURCES} ${CMAKE_CURRENT_LIST_DIR}/replay.cpp)
  gnomon_check(${name}_replay LABELS fuzz COMMAND ${name}_replay ${arg_CORPUS})
  set(programs ${name}_replay)
  if(GNOMON_FUZZ)
    add_executable(${name} ${arg_SOURCES} ${arg_FUZZER_SOURCES})
    target_link_options(${name} PRIVATE -fsanitize=fuzzer)
    list(APPEND programs ${name})
  endif()
  foreach(program IN LISTS programs)
    target_link_libraries(${program} PRIVATE gnomon_build_flags ${arg_LIBRARIES})
    target_link_options(${program} PRIVATE ${arg_LINK_OPTIONS})
  endforeach()
endfunction()

find_package(nlohmann_json REQUIRED)
gnomon_fuzz_target(scene_fuzz
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/scene_fuzz.cpp
  FUZZER_SOURCES ${CMAKE_CURRENT_LIST_DIR}/scene_mutator.cpp
  CORPUS ${CMAKE_CURRENT_LIST_DIR}/corpus/scene.tar
  LIBRARIES gnomon_scene nlohmann_json::nlohmann_json
  LINK_OPTIONS -Wl,--wrap=sysconf)
gnomon_fuzz_target(library_fuzz
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/library_fuzz.cpp
  CORPUS ${CMAKE_CURRENT_LIST_DIR}/corpus/library.tar
  LIBRARIES gnomon_inside gnomon_reference OpenCL::OpenCL)
# The requests of gnomon view's page, read by the parser of command lines.
find_package(CLI11 QUIET)
find_package(fmt CONFIG QUIET)
if(CLI11_FOUND AND fmt_FOUND)
  set(app ${PROJECT_SOURCE_DIR}/host/app)
  gnomon_fuzz_target(view_fuzz
    SOURCES ${CMAKE_CURRENT_LIST_DIR}/view_fuzz.cpp ${app}/options.cpp ${app}/values.cpp ${app}/area_light.cpp
            ${app}/view/request.cpp ${app}/view/guard.cpp
    CORPUS ${CMAKE_CURRENT_LIST_DIR}/corpus/view.tar
    LIBRARIES gnomon_inside gnomon_scene CLI11::CLI11 fmt::fmt)
endif()
# The images of scenes, decoded as the command does.
find_package(OpenImageIO QUIET)
if(OpenImageIO_FOUND)
  gnomon_fuzz_target(image_fuzz
    SOURCES ${CMAKE_CURRENT_LIST_DIR}/image_fuzz.cpp ${PROJECT_SOURCE_DIR}/host/app/decoded_image.cpp
    CORPUS ${CMAKE_CURRENT_LIST_DIR}/corpus/image.tar
    LIBRARIES gnomon OpenImageIO::OpenImageIO)
  target_include_directories(image_fuzz_replay PRIVATE ${PROJECT_SOURCE_DIR}/host/app)
  if(GNOMON_FUZZ)
    target_include_directories(image_fuzz PRIVATE ${PROJECT_SOURCE_DIR}/host/app)
  endif()
endif()
