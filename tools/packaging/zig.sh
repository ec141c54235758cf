#!/bin/bash
# SPDX-License-Identifier: MIT
# Makes in FOLDER what wheels for an older glibc than this machine's are compiled with: bin/cc and bin/c++, which are zig's
# clang for glibc 2.28 (PyPI's ziglang, of PYTHON's environment, brings its headers, libraries and a static libc++), and
# prefix, where the static libraries lie that read glTF files. Those are compiled of Debian's sources, whose versions the
# packages here have too. Needs deb.debian.org. usage: zig.sh FOLDER PYTHON
set -euo pipefail
mkdir -p "$1"
folder=$(realpath "$1") python=$(realpath -s "$2")
prefix=$folder/prefix
mkdir -p "$folder"/{bin,sources,lists/partial} "$prefix"/{include,lib,share/cmake}

for compiler in cc c++; do
    # A compiler that is written anew is another one to ccache.
    [ -x "$folder/bin/$compiler" ] ||
        printf '#!/bin/sh\nexec %q -m ziglang %s -target %s-linux-gnu.2.28 -idirafter %q "$@"\n' "$python" $compiler \
            "$(uname -m)" "$prefix/include" >"$folder/bin/$compiler"
    chmod 755 "$folder/bin/$compiler"
done
[ ! -e "$prefix/complete" ] || exit 0

# Sources by apt, with lists beside the machine's.
. /etc/os-release
echo "deb-src http://deb.debian.org/debian $VERSION_CODENAME main" >"$folder/sources.list"
get() {
    nice apt-get -qq -o "Dir::Etc::sourcelist=$folder/sources.list" -o Dir::Etc::sourceparts=/dev/null \
        -o "Dir::State::lists=$folder/lists" -o "Dir::Cache=$folder" -o APT::Sandbox::User=root "$@"
}
cd "$folder/sources"
get update
get source tinygltf meshoptimizer fmtlib draco
sed -i '/^add_subdirectory(tests)/d' tinygltf-*/CMakeLists.txt

# Headers without a library of their own. In /usr/include they lie beside glibc's and Debian's libdraco's, which must not
# be found: with those a file of Draco's had no triangles, or ended the process.
cp -r /usr/include/{nlohmann,stb} "$prefix/include"
cp -r /usr/share/cmake/nlohmann_json "$prefix/share/cmake"
# Debian's Python.h takes its configuration from there.
for folder_of_python in /usr/include/*-linux-gnu/python3*; do cp --parents -r "$folder_of_python" "$folder"; done
cp -r "$folder/usr/include/." "$prefix/include"
printf '#define STB_IMAGE%s_IMPLEMENTATION\n#include <stb/stb_image%s.h>\n' '' '' _WRITE _write >stb.c
"$folder/bin/cc" -O2 -fPIC -I"$prefix/include" -c stb.c -o stb.o
"$python" -m ziglang ar rcs "$prefix/lib/libstb.a" stb.o

build() {  # SOURCES OPTIONS...
    nice cmake -G Ninja -S "$1" -B "$1/build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_POSITION_INDEPENDENT_CODE=ON \
        -DCMAKE_C_COMPILER="$folder/bin/cc" -DCMAKE_CXX_COMPILER="$folder/bin/c++" -DBUILD_SHARED_LIBS=OFF \
        -DBUILD_TESTING=OFF -DCMAKE_INSTALL_PREFIX="$prefix" -DCMAKE_INSTALL_LIBDIR=lib -DCMAKE_PREFIX_PATH="$prefix" \
        -DCMAKE_FIND_USE_CMAKE_SYSTEM_PATH=OFF -DCMAKE_POLICY_VERSION_MINIMUM=3.5 "${@:2}"
    nice cmake --build "$1/build" --parallel 2
    cmake --install "$1/build"
}
{
    build fmtlib-* -DFMT_TEST=OFF -DFMT_DOC=OFF
    build meshoptimizer-*
    build tinygltf-* -DTINYGLTF_BUILD_LOADER_EXAMPLE=OFF
    build draco-* -DDRACO_TESTS=OFF -DDRACO_TRANSCODER_SUPPORTED=OFF
} >"$folder/build.log" 2>&1 || { tail -40 "$folder/build.log" >&2; exit 1; }
# A static tinygltf names this target.
sed -i '1i find_package(nlohmann_json REQUIRED)' "$prefix/lib/cmake/TinyGLTF/TinyGLTFConfig.cmake"
# Their licences go into the wheel.
for sources in fmtlib meshoptimizer tinygltf draco; do
    cp $sources-*/debian/copyright "$prefix/share/LICENSE.$sources"
done
touch "$prefix/complete"
