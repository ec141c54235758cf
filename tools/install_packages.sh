#!/bin/bash
# SPDX-License-Identifier: MIT
# Installs the Debian or Ubuntu packages that gnomon needs, and only those that are missing: when nothing is missing it
# neither reaches for the network nor asks for a password.
# usage: install_packages.sh run|test|ci   (each includes what stands before it)
set -euo pipefail

run_packages=(
    g++ cmake ninja-build          # the build
    ocl-icd-opencl-dev             # OpenCL headers and loader: all that the core library needs
    pocl-opencl-icd                # an OpenCL device for every CPU; a GPU's driver brings its own
    libtinygltf-dev nlohmann-json3-dev libcli11-dev  # the command: scenes, statistics, options
    libfmt-dev                     # the command: sentences
    libmeshoptimizer-dev           # the command: packed scenes, as scenes/sponza.glb is
    libdraco-dev                   # optional: meshes that Draco compressed
    libstb-dev zlib1g-dev          # the command, tools and tests: PNG files
    liberfa-dev                    # optional: the sun's positions for gnomon hours
    libopenimageio-dev             # the command: EXR files, and images of scenes
    openimageio-tools              # OpenImageIO's CMake files refuse to be found without its tools
    libcpp-httplib-dev libturbojpeg0-dev  # the command: gnomon view
    pkg-config                     # finds these two, and what is installed
)
test_packages=(
    libgtest-dev                   # the test framework
    libboost-dev libgmp-dev        # exact arithmetic for the references
    oclgrind                       # finds out-of-bounds accesses and races in kernels
    git                            # check_layout.sh asks it which files are the project's
)
ci_packages=(
    ccache                         # the next run compiles only what changed
    clang-14 libclang-rt-14-dev    # the fuzzers
    python3-venv python3-dev       # the Python package is built and tested in an environment of its own
    chromium chromium-driver       # the page of gnomon view (tools/test_view.sh)
    libclc-15                      # what Mesa's rusticl reads (tools/test_drivers.sh); registers no driver
    gappa coq libcoq-flocq         # check the proofs of tests/proofs (250 MB, a minute)
    spin                           # explores the orders of steps of tests/protocols
    rustc                          # docs/embedding.md's program in Rust (55 MB)
    doxygen                        # the pages of gnomon.h and gnomon.hpp (tools/api_pages.sh)
    shellcheck                     # the scripts' quotes and expansions
    clang-format-14                # one formatter version, or the check would depend on the machine
)

case ${1:-} in
    run) packages=("${run_packages[@]}") ;;
    test) packages=("${run_packages[@]}" "${test_packages[@]}") ;;
    ci) packages=("${run_packages[@]}" "${test_packages[@]}" "${ci_packages[@]}") ;;
    *)
        echo "usage: $0 run|test|ci" >&2
        exit 2
        ;;
esac

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    echo "This is no Debian or Ubuntu: install what corresponds to these packages, then build with CMake as the README" \
        "says: ${packages[*]}" >&2
    exit 1
fi

missing=()
for package in "${packages[@]}"; do
    [[ $(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null) == installed ]] || missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
        echo "These packages are missing and there is no sudo here: run as root: apt-get install ${missing[*]}" >&2
        exit 1
    fi
    as_root=(sudo)
fi
echo "Installing: ${missing[*]}"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
