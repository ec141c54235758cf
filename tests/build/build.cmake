# SPDX-License-Identifier: MIT
# Tests of the build itself, included by tests/CMakeLists.txt.
set(here "${CMAKE_CURRENT_LIST_DIR}")

# A file with everything that a text tool could trip over must arrive unchanged; so must an empty one.
gnomon_test(embed_files_test SOURCES build/embed_files_test.cpp)
target_compile_definitions(embed_files_test PRIVATE GNOMON_ROOT="${PROJECT_SOURCE_DIR}")
gnomon_embed_files(embed_files_test embedded_kernels tests/build/nasty.bin tests/build/empty.bin)

# oclgrind's own exit status says nothing, so see that a kernel with a fault does fail a gnomon_oclgrind_test.
add_executable(faulty_kernel build/faulty_kernel.cpp)
target_link_libraries(faulty_kernel PRIVATE gnomon_inside OpenCL::OpenCL gnomon_build_flags)
gnomon_oclgrind_test(oclgrind_passes_a_good_kernel COMMAND faulty_kernel none)
foreach(fault out_of_bounds race)
  gnomon_oclgrind_test(oclgrind_catches_${fault} COMMAND faulty_kernel ${fault})
endforeach()
if(TEST oclgrind_passes_a_good_kernel)
  set_tests_properties(oclgrind_catches_out_of_bounds PROPERTIES PASS_REGULAR_EXPRESSION "Invalid write of size 4")
  set_tests_properties(oclgrind_catches_race PROPERTIES PASS_REGULAR_EXPRESSION "data race")
endif()

# The OpenCL library is loaded when it is needed, and one sentence names what is wrong with it.
if(GNOMON_COMMAND)
  gnomon_check(opencl_library_is_loaded_lazily LABELS build
               COMMAND "${here}/opencl_library_test.sh" "$<TARGET_FILE:gnomon_command>")
endif()

gnomon_check(versions_agree LABELS build quick COMMAND "${here}/versions_agree.sh" "${PROJECT_SOURCE_DIR}")
gnomon_check(layout LABELS build quick COMMAND "${PROJECT_SOURCE_DIR}/tools/check_layout.sh")
gnomon_check(layout_rules_bite LABELS build exhaustive
             COMMAND "${here}/check_layout_test.sh" "${PROJECT_SOURCE_DIR}/tools/check_layout.sh")

# Seven programs show how gnomon is used. Each is shown by a page, run by the tests (the Python ones by
# tests/python/test_examples.py), and checks its own answer.
function(gnomon_page_shows page language example)
  get_filename_component(name ${page} NAME_WE)
  string(TOLOWER ${name}_shows_${example} test)
  string(REPLACE "." "_" test ${test})
  gnomon_check(${test} LABELS build
               COMMAND "${CMAKE_COMMAND}" -D README=${PROJECT_SOURCE_DIR}/${page} -D LANGUAGE=${language}
                   -D EXAMPLE=${PROJECT_SOURCE_DIR}/tests/consumer/${example} -P "${here}/readme_shows_example.cmake")
endfunction()
gnomon_page_shows(README.md cpp example.cpp)
gnomon_page_shows(docs/embedding.md c embedding.c)
gnomon_page_shows(docs/embedding.md rust embedding.rs)
gnomon_page_shows(docs/many_lights.md cpp many_lights.cpp)
gnomon_page_shows(docs/python.md python lit_points.py)
gnomon_page_shows(docs/python.md python on_device.py)
gnomon_page_shows(docs/studies.md python sun_study.py)

# The example as a user builds it: against an installed static library, an installed shared one, and as a subproject.
# A sanitized library is of no use to a program built without the sanitizers.
if(NOT GNOMON_SANITIZE AND GNOMON_INSTALL)
  find_program(GNOMON_PKG_CONFIG pkg-config)
  if(NOT GNOMON_PKG_CONFIG)
    message(WARNING "pkg-config not found: gnomon.pc goes untested (Debian package pkg-config)")
  endif()
  find_program(GNOMON_RUSTC rustc PATHS /usr/bin NO_DEFAULT_PATH)  # the one that the page names
  find_program(GNOMON_RUSTC rustc)
  if(NOT GNOMON_RUSTC)
    message(WARNING "rustc not found: the program in Rust goes untested (Debian package rustc)")
  endif()
  find_program(GNOMON_NM nm)
  if(NOT GNOMON_NM)
    message(WARNING "nm not found: the shared library's symbols go untested (Debian package binutils)")
  endif()
  foreach(way installed_static installed_shared subproject)
    gnomon_check(consumer_${way} TIMEOUT 1800 LABELS consumer exhaustive
             COMMAND "${CMAKE_COMMAND}" -D WAY=${way} -D SOURCE_DIR=${PROJECT_SOURCE_DIR}
                     -D SCRATCH_DIR=${CMAKE_CURRENT_BINARY_DIR}/consumer_${way}
                     -D BUILD_DIR=${PROJECT_BINARY_DIR}-${way} -D WERROR=${GNOMON_WERROR} -D CXX=${CMAKE_CXX_COMPILER}
                     -D CC=${CMAKE_C_COMPILER} -D NM=${GNOMON_NM}
                     -D LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER} -D GENERATOR=${CMAKE_GENERATOR}
                     -D PKG_CONFIG=${GNOMON_PKG_CONFIG} -D RUSTC=${GNOMON_RUSTC}
                     -P "${here}/consumer_test.cmake")
    set_tests_properties(consumer_${way} PROPERTIES SKIP_REGULAR_EXPRESSION "NOT TESTED")
  endforeach()
endif()
