#!/bin/bash
# SPDX-License-Identifier: MIT
# Builds the fuzzers (clang, AddressSanitizer, UndefinedBehaviorSanitizer) and runs each for some seconds from its saved
# corpus, tests/fuzz/corpus/{scene,image,view,library}.tar. What a run finds beyond that stays in build-fuzz/found/ for the next; an
# input that breaks a promise is printed, kept in build-fuzz/broken/, and ends the script with an error. With --save,
# inputs that cover new code are added to the saved corpus.
# usage: fuzz.sh [SECONDS EACH, default 30] [--save]
#        fuzz.sh --unpack FOLDER    writes the saved corpus to FOLDER/scene and so on, one file per input
#        fuzz.sh --pack FOLDER      makes the saved corpus from these folders; the same files make the same bytes
set -euo pipefail

unpack() {  # folder
    local target
    for target in scene image view library; do
        mkdir -p "$1/$target"
        tar -xf "$corpus/$target.tar" -C "$1/$target"
    done
}
pack() {  # folder
    local target
    for target in scene image view library; do
        (cd "$1/$target" && LC_ALL=C tar --format=ustar --owner=0 --group=0 --numeric-owner --mtime=@0 --mode=0644 \
            -cf "$corpus/$target.tar" -- *)
    done
}
corpus=$(realpath "$(dirname "$0")/../tests/fuzz/corpus")
case ${1:-} in
    --unpack | --pack)
        "${1#--}" "${2:?which folder?}"
        exit
        ;;
esac
cd "$(dirname "$0")/.."

seconds=${1:-30}
save=${2:-}
folder=build-fuzz
compiler=$(command -v clang++-14 || command -v clang++) || {
    echo "clang++ is missing: tools/install_packages.sh ci installs it" >&2
    exit 1
}
launcher=()
if command -v ccache >/dev/null; then launcher=(-D CMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
cmake -G Ninja -S . -B "$folder" -D CMAKE_CXX_COMPILER="$compiler" -D CMAKE_BUILD_TYPE=RelWithDebInfo \
    -D "CMAKE_CXX_FLAGS_RELWITHDEBINFO=-O1 -g1" -D GNOMON_SANITIZE=ON -D GNOMON_FUZZ=ON -D GNOMON_COMMAND=OFF \
    -D GNOMON_TOOLS=OFF "${launcher[@]}" >/dev/null
cmake --build "$folder" --parallel "$(nproc)" --target scene_fuzz image_fuzz view_fuzz library_fuzz

export GNOMON_CACHE_DIR=$PWD/$folder/test_kernel_cache
# PoCL alone, whose leaks sanitizer_defaults.cpp knows: Mesa's drivers, where installed, leak 200 bytes a run.
export OCL_ICD_VENDORS=${OCL_ICD_VENDORS:-pocl.icd}
rm -rf "$folder/saved"
unpack "$folder/saved"
for target in scene image view library; do
    found=$folder/found/$target
    saved=$folder/saved/$target
    mkdir -p "$found" "$folder/broken"
    # Leaks are looked for once, at the end: OpenCL's threads would have them looked for after every input. Memory of
    # the device that is not given back is looked for by the target itself.
    options=(-timeout=60 -rss_limit_mb=4096 -malloc_limit_mb=1024 -detect_leaks=0 "-artifact_prefix=$folder/broken/$target-")
    if [ "$target" = library ]; then options+=(-max_len=1200); else options+=(-max_len=4096); fi
    echo "== $target: $seconds s"
    "$folder/tests/${target}_fuzz" "$found" "$saved" -max_total_time="$seconds" -print_final_stats=1 \
        -verbosity=0 "${options[@]}"
    if [ "$save" = --save ]; then
        "$folder/tests/${target}_fuzz" -set_cover_merge=1 -use_counters=0 "$saved" "$found" -verbosity=0 "${options[@]}"
        pack "$folder/saved"
    fi
done
