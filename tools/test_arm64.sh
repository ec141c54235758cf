#!/bin/bash
# SPDX-License-Identifier: MIT
# Tests gnomon on another processor: Debian's packages for ARM64, PoCL among them, emulated by qemu. It needs root on
# Debian, and from there debootstrap, qemu-user-static, clang-14, lld-14 and gcc; 1.1 GB; and longer than CI has: on
# 2026-11-27 21 minutes for 24 tests, which all passed, after 9 for unpacking and compiling (8 of processor time; two cores with
# a load of 6 to 14). The golden lines, 13 minutes, and the predicates are last. A test that has passed is not run again.
#
# usage: test_arm64.sh FOLDER     FOLDER: made if it is not there; a second run goes on with what the first one left
#
# The programs are compiled here, and run in a root of ARM64. There the driver starts a linker: a small program that
# starts ARM64's by qemu, since not every machine lets qemu register itself for foreign programs.
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -eq 1 ] || { echo "usage: $0 FOLDER" >&2; exit 2; }
mkdir -p "$1"
folder=$(realpath "$1")
root=$folder/root
build=$folder/build

packages=pocl-opencl-icd,ocl-icd-opencl-dev,g++,libgtest-dev,libgmp-dev,libboost-dev,libstb-dev,zlib1g-dev
packages+=,libmeshoptimizer-dev,libfmt-dev,libtinygltf-dev,nlohmann-json3-dev,libcli11-dev
if [ ! -f "$folder/unpacked" ]; then
    debootstrap --foreign --arch=arm64 --variant=minbase --include="$packages" bookworm "$root"
    for package in "$root"/var/cache/apt/archives/*.deb; do dpkg -x "$package" "$root"; done
    cp /usr/bin/qemu-aarch64-static "$root/usr/bin/"
    gcc -static -x c - -o "$folder/linker" <<'C'
#include <unistd.h>
int main(int count, char** given) {
    char* command[count + 2];
    command[0] = "qemu-aarch64-static";
    command[1] = "/usr/bin/aarch64-linux-gnu-ld.bfd";
    for (int i = 1; i <= count; ++i) command[i + 1] = given[i];  // the last is the null pointer
    execv("/usr/bin/qemu-aarch64-static", command);
    return 127;
}
C
    for name in ld aarch64-linux-gnu-ld; do
        rm -f "$root/usr/bin/$name"
        cp "$folder/linker" "$root/usr/bin/$name"
    done
    touch "$folder/unpacked"
fi

cat >"$folder/toolchain.cmake" <<CMAKE
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_SYSROOT $root)
set(CMAKE_C_COMPILER clang-14)
set(CMAKE_CXX_COMPILER clang++-14)
set(CMAKE_C_COMPILER_TARGET aarch64-linux-gnu)
set(CMAKE_CXX_COMPILER_TARGET aarch64-linux-gnu)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
add_link_options(-fuse-ld=lld)
CMAKE
cmake -S . -B "$build" -G Ninja -D CMAKE_TOOLCHAIN_FILE="$folder/toolchain.cmake" -D CMAKE_BUILD_TYPE=Release \
    -D GNOMON_COMMAND=OFF -D GNOMON_TESTS=ON -D GNOMON_TOOLS=ON -D GNOMON_DRACO=OFF
tests=(self_check_test small_cases_test soft_double_test predicates_test golden_test)
cmake --build "$build" --parallel "$(nproc)" --target "${tests[@]}"

mounted=()
trap 'for place in "${mounted[@]}"; do umount "$place"; done' EXIT
for place in /proc /dev /sys "$build" "$PWD"; do
    mkdir -p "$root$place"
    mount --bind "$place" "$root$place"
    mounted+=("$root$place")
done
export HOME=/root POCL_CACHE_DIR=/tmp/kernels GNOMON_CACHE_DIR=/tmp/kernels
export GNOMON_SMALL_CASES=2 GNOMON_PREDICATE_TRIALS=200
mkdir -p "$root/tmp/kernels" "$folder/passed"
emulated() { chroot "$root" /usr/bin/qemu-aarch64-static "$build/tests/$1" "${@:2}"; }
sources=$(find kernels tests/golden tests/exact -type f -print0 | sort -z | xargs -0 sha256sum | sha256sum)
# each_of PROGRAM [FILTER]: the program's tests, one at a time. A test that has passed is remembered until the program, a
# kernel or an expected value changes, so a run that was stopped goes on where it was.
each_of() {
    local program=$1 suite='' tests test name remembered begun
    tests=$(emulated "$program" --gtest_list_tests --gtest_filter="${2:-*}" | grep -E '^ |[.]( |$)' | sed 's/ *#.*//')
    while IFS= read -r test; do
        [[ $test == " "* ]] || { suite=$test; continue; }
        name=$suite${test// /}
        remembered=$folder/passed/$(sha256sum - "$build/tests/$program" <<<"$name $sources" | sha256sum | cut -c1-32)
        if [ ! -f "$remembered" ]; then
            begun=$SECONDS
            emulated "$program" --gtest_filter="$name" >"$folder/output" 2>&1 || { cat "$folder/output"; exit 1; }
            { grep -E 'SKIPPED  ] [0-9]|cases, digest' "$folder/output" | sed 's/^/   /' || true
              echo "passed: $program $name, $((SECONDS - begun)) s"; } >"$remembered.new"
            mv "$remembered.new" "$remembered"
        fi
        cat "$remembered"
    done <<<"$tests"
}
each_of self_check_test 'SelfCheck.*'
each_of small_cases_test
each_of soft_double_test
each_of golden_test '*sphere_closed_main*'
each_of predicates_test
