#!/bin/bash
# SPDX-License-Identifier: MIT
# Tests and measures gnomon on a machine that has a GPU with its driver and CMake, but no network and no packages. What
# is missing there travels with the source tree in the folder .device/, which git ignores.
#
#   tools/device.sh fetch [FILE...]  here: fills .device/ with Debian packages, and with FILEs that the repository does
#                                    not have, such as a larger scene
#   tools/device.sh build            here, if this system is no newer than there and the time there is dear: builds in
#                                    /tmp/gnomon_device and packs programs, tests and sources into .device/built.tar.xz
#   tools/device.sh run [CTEST ARGS] there, as root: unpacks; builds with the compiler there if .device/ has nothing
#                                    built; runs the tests and the benchmark. The log of the tests and the benchmark's
#                                    rows go to $OUT, if that is set; tools/report.py, here, makes tables and a page of
#                                    bench.json. `run --parallel 8` took 3 minutes for the tests on an H200; alone, one
#                                    after the other, time limits mean more.
#   tools/device.sh bench [ARGS]     there: unpacks and runs the benchmark alone, with ARGS in place of everything
#                                    (such as: --experiment table1 --full)
#
# The command gnomon needs OpenImageIO and stays behind; the library, scene loader, tests and tools come along.
set -euo pipefail
cd "$(dirname "$0")/.."

# Tests know their folders by absolute paths, so it is the same one on both machines.
work=/tmp/gnomon_device

# Everything of these packages lies under /usr; fetch refuses one where that is not so, because unpacking over / could
# replace the links /lib and /bin of the machine by folders.
packages=(
    ocl-icd-libopencl1 ocl-icd-opencl-dev opencl-c-headers opencl-clhpp-headers  # OpenCL's loader and headers
    libtinygltf-dev libtinygltf2d libstb0 libstb-dev nlohmann-json3-dev libcli11-dev  # scene loader and tools
    libmeshoptimizer-dev libmeshoptimizer2d                                      # packed scenes
    libfmt-dev libfmt9                                                           # its sentences
    libgtest-dev libboost1.74-dev libgmp-dev libgmp10 libgmpxx4ldbl              # tests and references
)
# The whole tree that travels must stay under 64 MiB.
largest_tree_mib=60

fetch() {
    local deb
    rm -rf .device
    mkdir -p .device/packages
    (cd .device/packages && apt-get -o APT::Sandbox::User=root download -qq "${packages[@]}")
    for deb in .device/packages/*.deb; do
        if dpkg-deb --fsys-tarfile "$deb" | tar -t | grep -vE '^\./(usr/.*|usr)?$'; then
            echo "$deb holds the files above, outside /usr: it must not be unpacked over a running system" >&2
            exit 1
        fi
    done
    [ $# -eq 0 ] || cp "$@" .device/
    check_size
}

check_size() {
    local tree_kib
    tree_kib=$({ git ls-files -z --cached --others --exclude-standard; find .device -type f -print0; } |
        du --files0-from=- --apparent-size --block-size=1K --total | tail -1 | cut -f1)
    echo "$((tree_kib / 1024)) MiB travel, $(du -sm .device | cut -f1) MiB of them in .device/"
    if [ $((tree_kib / 1024)) -ge $largest_tree_mib ]; then
        echo "that is more than $largest_tree_mib MiB: leave out a FILE" >&2
        exit 1
    fi
}

# Of this source tree, into the folder of all that is made.
compile() {
    rm -rf "$work/src"
    mkdir -p "$work/src"
    find . -mindepth 1 -maxdepth 1 -not -name '.git' -not -name '.device' -not -name 'build*' \
        -exec cp -r -t "$work/src" {} +
    cmake -S "$work/src" -B "$work/build" -D CMAKE_BUILD_TYPE=Release -D GNOMON_COMMAND=OFF -D GNOMON_TESTS=ON \
        -D GNOMON_TOOLS=ON -D GNOMON_INSTALL=OFF "$@"
    cmake --build "$work/build" --parallel "$(nproc)"
}

build() {
    mkdir -p .device
    compile -D CMAKE_DISABLE_FIND_PACKAGE_embree=ON -D GNOMON_DRACO=OFF  # their libraries are not there
    # What runs, and what tells ctest of it. Whole or not at all: half an archive would be taken for one.
    find "$work/build/tests" "$work/build/tools" -type f -executable -not -name '*.sh' -exec strip {} +
    find "$work/src" "$work/build/tests" "$work/build/tools" -type f \
        -not -path '*/CMakeFiles/*' -not -name '*.a' -not -path '*_cache/*' -print0 |
        tar --null --files-from - --absolute-names -C / -cJf .device/built.part \
            "$work/build/CTestTestfile.cmake" "$work"/build/host
    mv .device/built.part .device/built.tar.xz
    check_size
}

unpack() {
    local deb driver
    for deb in .device/packages/*.deb; do dpkg-deb -x "$deb" /; done
    ldconfig
    # The loader asks the drivers that are named here.
    mkdir -p /etc/OpenCL/vendors
    driver=$(find / -name 'libnvidia-opencl.so*' -not -path '/proc/*' 2>/dev/null | sort | head -1 || true)
    if [ -n "$driver" ]; then
        echo "$driver" >/etc/OpenCL/vendors/nvidia.icd
    elif ! ls /etc/OpenCL/vendors/*.icd >/dev/null 2>&1; then
        echo "There is no OpenCL driver on this machine: no libnvidia-opencl.so, nothing in /etc/OpenCL/vendors" >&2
        exit 1
    fi
}

out=${OUT:-/tmp/out}

# Everything in its place, and the environment of what runs.
make_ready() {
    mkdir -p "$out"
    [ -d .device ] || { echo "There is no .device/ here: run tools/device.sh fetch where the network is" >&2; exit 1; }
    unpack
    # Compiled kernels of an earlier run are kept there; the first start of this run must compile.
    export GNOMON_CACHE_DIR=/tmp/gnomon_cache
    if [ -e .device/built.tar.xz ]; then
        tar --absolute-names -xJf .device/built.tar.xz
        # Some tests are CMake scripts, by the path that CMake has on Debian.
        [ -e /usr/bin/cmake ] || ln -s "$(command -v cmake)" /usr/bin/cmake
    else
        compile
    fi
}

# With the real scenes, wherever an experiment wants them.
bench() {
    "$work/build/tools/bench" --scenes-folder scenes "$@"
}

bench_alone() {
    make_ready
    bench "$@" --json "$out/bench.json" --csv "$out/bench.csv"
}

run() {
    local status=0
    make_ready
    ctest --test-dir "$work/build" --output-on-failure --no-tests=error --output-log "$out/ctest.log" "$@" || status=$?
    # Every view of the scenes with its hash and stages, then all experiments.
    bench scenes/sponza.glb scenes/lost_empire.glb --size 1920x1080 --size 3840x2160 --stages --json "$out/views.json" |
        tee "$out/bench.txt" || status=$?
    bench --experiment all --full --seconds 1 --json "$out/bench.json" --csv "$out/bench.csv" |
        tee -a "$out/bench.txt" || status=$?
    return $status
}

case ${1:-} in
    fetch | build | run) "$@" ;;
    bench) bench_alone "${@:2}" ;;
    *)
        echo "usage: $0 fetch [FILES] | build | run [CTEST ARGUMENTS] | bench [BENCH ARGUMENTS]" >&2
        exit 2
        ;;
esac
