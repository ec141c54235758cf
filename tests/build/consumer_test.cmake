# SPDX-License-Identifier: MIT
# Builds and runs tests/consumer as a user would, in a folder of its own, and compares what its programs print: through
# find_package() or as a subproject, and what is installed through pkg-config as well, where PKG_CONFIG is found.
# cmake -D WAY=installed_static|installed_shared|subproject -D SOURCE_DIR=... -D SCRATCH_DIR=... -D BUILD_DIR=...
# -P consumer_test.cmake
# The library is built anew with nothing but its core, so this also shows that the core needs OpenCL alone. All is built
# in BUILD_DIR beside the build's folder and with its options, since a compiler cache then has the files already.
set(tool_arguments -G "${GENERATOR}" "-DCMAKE_C_COMPILER=${CC}" "-DCMAKE_CXX_COMPILER=${CXX}"
                   "-DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}"
                   -DCMAKE_BUILD_TYPE=Release)

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "failed (${status}): ${command}\n${output}")
  endif()
endfunction()

file(REMOVE_RECURSE "${SCRATCH_DIR}" "${BUILD_DIR}")
file(MAKE_DIRECTORY "${SCRATCH_DIR}")
set(prefix "${SCRATCH_DIR}/prefix")
if(WAY STREQUAL "subproject")
  set(where_gnomon_is "-DGNOMON_SOURCE_DIR=${SOURCE_DIR}")
else()
  string(COMPARE EQUAL "${WAY}" "installed_shared" shared)
  run("${CMAKE_COMMAND}" ${tool_arguments} -S "${SOURCE_DIR}" -B "${BUILD_DIR}" -DBUILD_SHARED_LIBS=${shared}
      -DGNOMON_WERROR=${WERROR} -DGNOMON_COMMAND=OFF -DGNOMON_TESTS=OFF -DGNOMON_TOOLS=OFF)
  run("${CMAKE_COMMAND}" --build "${BUILD_DIR}")
  run("${CMAKE_COMMAND}" --install "${BUILD_DIR}" --prefix "${prefix}")
  # What is installed must stand on its own.
  file(REMOVE_RECURSE "${BUILD_DIR}")
  set(where_gnomon_is "-DCMAKE_PREFIX_PATH=${prefix}")
endif()

run("${CMAKE_COMMAND}" ${tool_arguments} -S "${SOURCE_DIR}/tests/consumer" -B "${BUILD_DIR}" "${where_gnomon_is}"
    -DGNOMON_WERROR=${WERROR})
run("${CMAKE_COMMAND}" --build "${BUILD_DIR}")
set(build "${SCRATCH_DIR}/consumer")
file(RENAME "${BUILD_DIR}" "${build}")

function(expect program expected)
  execute_process(COMMAND "${program}" RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE errors)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${program} failed (${status}): ${errors}")
  endif()
  string(FIND "${output}" "${expected}" at)
  if(NOT at EQUAL 0)
    message(FATAL_ERROR "${program} printed\n${output}instead of\n${expected}")
  endif()
endfunction()

# Straight above each point: the roof's middle, its edge (closed, so it blocks), and nothing.
set(example_prints "point 0 is in shadow\npoint 1 is in shadow\npoint 2 is in the light\n")
expect("${build}/example" "${example_prints}")
expect("${build}/embedding" "point 0 is 0.25 bright\npoint 1 is 0.25 bright\npoint 2 is 1.00 bright\n")
expect("${build}/many_lights" "point 0: 8 hours of sun, from 7 to 14 o'clock
point 1: 8 hours of sun, from 10 to 17 o'clock
point 2: 11 hours of sun, from 7 to 17 o'clock
")
set(c_prints "2048 of 4096 points are in the light\n")
expect("${build}/embedding_in_c" "${c_prints}")
expect("${build}/failures" "InvalidArgument\nDeviceNotFound\nOutOfDeviceMemory\nOpenClError\nError\nruntime_error\n")

expect("${build}/rivals" "izb: exact\nshadow-map: a few points wrong\n")

# A program that links the core alone has no kernel of samples, shading, sight or of the classic techniques; one that links
# all has.
foreach(program IN ITEMS example rivals)
  file(SIZE "${build}/${program}" bytes)
  message("${program}: ${bytes} bytes")
  if(NOT WAY STREQUAL "installed_shared")
    file(STRINGS "${build}/${program}" kernels REGEX "^kernels/(samples|shading|rivals|sight)/.*\\.cl")
    list(LENGTH kernels kernels_of_satellites)
    if(kernels_of_satellites GREATER 0 AND program STREQUAL "example" OR
       kernels_of_satellites EQUAL 0 AND program STREQUAL "rivals")
      message(FATAL_ERROR "${program} has ${kernels_of_satellites} kernel files of samples, shading, sight and of the classic techniques")
    endif()
  endif()
endforeach()

if(WAY STREQUAL "installed_shared")
  file(GLOB_RECURSE library "${prefix}/libgnomon.so")
  file(GLOB_RECURSE full_library "${prefix}/libgnomon_full.so")
  if(NM)
    set(symbols "${CMAKE_CURRENT_LIST_DIR}/c_symbols.txt")
    run("${CMAKE_CURRENT_LIST_DIR}/exported_symbols.sh" "${NM}" "${library}" "${prefix}/include" "${symbols}")
    run("${CMAKE_CURRENT_LIST_DIR}/exported_symbols.sh" "${NM}" "${full_library}" "${prefix}/include" "${symbols}"
        "${CMAKE_CURRENT_LIST_DIR}/c_symbols_of_full.txt")
  else()
    message("NOT TESTED: there is no nm to list the exported symbols")
  endif()
endif()

# A program in Rust knows gnomon by the shared library alone.
if(WAY STREQUAL "installed_shared")
  if(RUSTC)
    file(GLOB_RECURSE library "${prefix}/libgnomon.so")
    cmake_path(GET library PARENT_PATH library_dir)
    run("${RUSTC}" --edition 2021 -O -D warnings -L "${library_dir}" -C "link-arg=-Wl,-rpath,${library_dir}"
        -o "${build}/embedding_in_rust" "${SOURCE_DIR}/tests/consumer/embedding.rs")
    expect("${build}/embedding_in_rust" "0.00 0.00 1.00\n")
  else()
    message("NOT TESTED: there is no rustc to compile the program in Rust")
  endif()
endif()

# The example's own calls are gnomon's alone, so that what it links is what gnomon.pc says. The C program is linked by a
# C compiler, which knows no library of C++.
if(NOT WAY STREQUAL "subproject" AND PKG_CONFIG)
  file(GLOB_RECURSE pc "${prefix}/gnomon.pc")
  cmake_path(GET pc PARENT_PATH pc_dir)
  set(ENV{PKG_CONFIG_PATH} "${pc_dir}")
  set(static "")
  if(WAY STREQUAL "installed_static")
    set(static --static)
  endif()
  execute_process(COMMAND "${PKG_CONFIG}" ${static} --cflags --libs gnomon
                  OUTPUT_VARIABLE flags COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(flags UNIX_COMMAND "${flags}")
  run("${CXX}" -std=c++20 "${SOURCE_DIR}/tests/consumer/example.cpp" -o "${build}/example_by_pkg_config" ${flags})
  run("${CC}" -std=c11 "${SOURCE_DIR}/tests/consumer/embedding.c" -o "${build}/c_by_pkg_config" ${flags} -lOpenCL)
  set(ENV{LD_LIBRARY_PATH} "${pc_dir}/..")
  expect("${build}/example_by_pkg_config" "${example_prints}")
  expect("${build}/c_by_pkg_config" "${c_prints}")
endif()
