# SPDX-License-Identifier: MIT
# Embeds files into a program, byte for byte: no Python, nothing generated in git.
#
# Included, it gives   gnomon_embed_files(target function kernels/a.h kernels/b.cl ...)
# with paths relative to gnomon's root. The target then defines gnomon::<function>() of host/cl/embedded_files.hpp, which
# names each file by the same path. Editing a listed file rebuilds.
#
# Run as a script (cmake -D ROOT=... -D OUTPUT=... -D FUNCTION=... -P embed_files.cmake -- FILES...), it writes that
# source file.
#
# Every byte is written as \xNN. Raw string literals would read better, but a file may contain their delimiter, GCC
# turns \r\n into \n inside them, and CMake's text mode trips over semicolons, brackets, backslashes and NUL. Nobody
# reads the generated file; the compiler takes some 10 ms for it.

if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(GNOMON_EMBED_SCRIPT "${CMAKE_CURRENT_LIST_FILE}")
  get_filename_component(GNOMON_EMBED_ROOT "${CMAKE_CURRENT_LIST_DIR}" DIRECTORY)

  function(gnomon_embed_files target function)
    set(output "${CMAKE_CURRENT_BINARY_DIR}/${target}_${function}.cpp")
    list(TRANSFORM ARGN PREPEND "${GNOMON_EMBED_ROOT}/" OUTPUT_VARIABLE inputs)
    add_custom_command(
      OUTPUT "${output}"
      COMMAND "${CMAKE_COMMAND}" -D "ROOT=${GNOMON_EMBED_ROOT}" -D "OUTPUT=${output}" -D "FUNCTION=${function}"
              -P "${GNOMON_EMBED_SCRIPT}" -- ${ARGN}
      DEPENDS ${inputs} "${GNOMON_EMBED_SCRIPT}"
      COMMENT "Embedding ${function} of ${target}"
      VERBATIM)
    target_sources(${target} PRIVATE "${output}")
    target_include_directories(${target} PRIVATE "${GNOMON_EMBED_ROOT}/host")
  endfunction()
  return()
endif()

# The files are the arguments after "--".
set(files)
set(seen_dashes FALSE)
math(EXPR last "${CMAKE_ARGC} - 1")
foreach(i RANGE ${last})
  if(seen_dashes)
    list(APPEND files "${CMAKE_ARGV${i}}")
  elseif("${CMAKE_ARGV${i}}" STREQUAL "--")
    set(seen_dashes TRUE)
  endif()
endforeach()

set(digit "[0-9a-f]")
string(REPEAT "${digit}${digit}" 32 up_to_32_bytes)
file(WRITE "${OUTPUT}.new" "// Written by tools/embed_files.cmake from the files named below: edit those.\n"
                           "#include \"cl/embedded_files.hpp\"\n\n"
                           "namespace gnomon {\nnamespace {\n\n")
set(entries "")
set(number 0)
foreach(path IN LISTS files)
  # Read as hex: two digits per byte, so nothing in the file can mean anything to CMake.
  file(READ "${ROOT}/${path}" hex HEX)
  file(SIZE "${ROOT}/${path}" size_bytes)
  # One adjacent string literal per 32 bytes. The remainder ends with the same line break.
  string(REGEX REPLACE "(${up_to_32_bytes})" "\\1\n" hex "${hex}")
  string(REGEX REPLACE "(${digit}${digit})" "\\\\x\\1" literal "${hex}")
  string(REGEX REPLACE "([^\n]+)" "    \"\\1\"" literal "${literal}")
  file(APPEND "${OUTPUT}.new" "// ${path}\nconstexpr char text_${number}[] =\n    \"\"\n${literal};\n"
                              "static_assert(sizeof(text_${number}) == ${size_bytes} + 1);\n\n")
  string(APPEND entries "    {\"${path}\", {text_${number}, ${size_bytes}}},\n")
  math(EXPR number "${number} + 1")
endforeach()
file(APPEND "${OUTPUT}.new" "constexpr EmbeddedFile files[] = {\n${entries}};\n\n}  // namespace\n\n"
                            "std::span<const EmbeddedFile> ${FUNCTION}() { return files; }\n\n"
                            "}  // namespace gnomon\n")
file(RENAME "${OUTPUT}.new" "${OUTPUT}")
