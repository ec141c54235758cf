#!/bin/bash
# SPDX-License-Identifier: MIT
# Runs the tests of exactness on drivers that this machine need not have installed, each from a folder of its own, so that
# the system's drivers and gnomon's default stay as they are:
#   pocl   PoCL 3.0, from PyPI (pocl-binary-distribution), which Python's package relies on
#   intel  Intel's runtime for CPUs, from PyPI (intel-opencl-rt)
#   mesa   Mesa's rusticl on llvmpipe, from Debian (mesa-opencl-icd); a part of the tests, since it compiles slowly
# Kernels are compiled afresh. A driver that cannot be downloaded, or whose compiler does not know this CPU, is skipped,
# and the last lines name it.
# usage: test_drivers.sh [BUILD-FOLDER [DRIVER...]]    (the folder holds the tests; default: build, all drivers)
set -euo pipefail
cd "$(dirname "$0")/.."
build=$(realpath "${1:-build}")
shift || true
drivers=("$@")
[ ${#drivers[@]} -gt 0 ] || drivers=(pocl intel mesa)
python=${PYTHON:-python3}
place=$build/drivers
skipped=()
failed=false
unset OCL_ICD_VENDORS OPENCL_LAYERS GNOMON_DEVICE GNOMON_GPU_KERNELS CL_CONFIG_CPU_VECTORIZER_MODE

# from_pypi PACKAGE...: into a fresh environment; false where PyPI cannot be reached.
from_pypi() {
    rm -rf "$place/venv-$driver"
    "$python" -m venv "$place/venv-$driver"
    "$place/venv-$driver/bin/pip" --disable-pip-version-check --quiet install "$@"
}

# from_debian PACKAGE...: unpacked, not installed; false where Debian cannot be reached.
from_debian() {
    rm -rf "$place/debian"
    mkdir -p "$place/debian"
    (
        cd "$place/debian"
        apt-get download "$@" >/dev/null 2>&1 || exit 1
        for package in ./*.deb; do dpkg -x "$package" .; done
    )
}

library() { find "$1" -name "$2" | sort | head -1; }

# What each test compares with: the golden record or the oracle.
golden='*/sundial_default_sun:*/degenerate_main_sun:*/lattice_main_lamp_samples_8:*/pillars_point_light_main_lamp:*/leaves_main_low_samples_8'
exact='SameBits.*:Receivers.*:BadNumbers.*:*Extremes*'

# run COMMAND...: under the environment `variables`; notes a failure and goes on.
run() {
    echo "-- $driver: ${variables[*]##*/} ${*##*/}"
    local status=0
    env GNOMON_CACHE_DIR="$place/cache-$driver" POCL_CACHE_DIR="$place/pocl-cache-$driver" "${variables[@]}" \
        timeout 1800 "$@" >"$place/log" 2>&1 || status=$?
    grep -E '^\[  (PASSED|FAILED)|WRONG|work-groups of 0' "$place/log" | sed 's/^/   /' || true
    if [ $status -eq 0 ]; then return; fi
    tail -40 "$place/log"
    echo "FAILED with status $status on $driver: $*"
    failed=true
}

# tests VARIABLE=VALUE...
tests() {
    variables=("$@")
    run "$build/tests/self_check_test" "--gtest_filter=SelfCheck.*"
    run "$build/tests/oclgrind_cases"
    run "$build/tests/golden_test" --gtest_filter="$golden"
    run "$build/tests/frustum_traced_test" --gtest_filter="$exact"
}

# refuses VARIABLE=VALUE...: with kernels that let Intel's compiler join work-items, the self-check must name its fault.
refuses() {
    rm -rf "$place/joined"
    cp -r kernels "$place/joined"
    sed -i '/^#define __kernel/d' "$place/joined/prelude.h"
    echo "-- $driver: ${*##*/}, work-items joined: the self-check must refuse it"
    local said
    said=$(env GNOMON_CACHE_DIR="$place/joined" GNOMON_KERNELS_DIR="$place/joined" "$@" "$build/gnomon" devices --check 2>&1) || true
    if [[ $said != *"mixes up work-items"* ]]; then
        echo "FAILED: it was not refused: $said"
        failed=true
    fi
}

# makes_wrong_avx512 VARIABLE=VALUE...: true where Intel's compiler makes wrong code for this CPU's AVX-512
# (docs/drivers.md). `gnomon devices --check` must have found wrong answers.
makes_wrong_avx512() {
    grep -qw avx512f /proc/cpuinfo || return 1
    local said
    said=$(env GNOMON_CACHE_DIR="$place/cache-$driver" "$@" "$build/gnomon" devices --check 2>&1) && return 1
    if [[ $said != *"answers of the device"*"are wrong: do not use it"* ]]; then return 1; fi
    echo "-- $driver: 'gnomon devices --check' finds wrong answers with AVX-512, as docs/drivers.md says; tested with AVX2"
}

# knows_this_cpu VARIABLE=VALUE...
knows_this_cpu() {
    local said
    said=$(env GNOMON_CACHE_DIR="$place/cache-$driver" POCL_CACHE_DIR="$place/pocl-cache-$driver" "$@" \
        "$build/gnomon" devices --check 2>&1) || true
    [[ $said != *"compiler is older than the CPU"* ]]
}

for driver in "${drivers[@]}"; do
    echo "== $driver"
    rm -rf "$place/cache-$driver" "$place/pocl-cache-$driver"
    mkdir -p "$place/pocl-cache-$driver"
    case $driver in
        pocl)
            from_pypi pocl-binary-distribution || { skipped+=("$driver"); continue; }
            icd=$(library "$place/venv-pocl" 'libpocl*.so')
            knows_this_cpu OCL_ICD_VENDORS="$icd" || { skipped+=("$driver (its compiler is older than this CPU)"); continue; }
            tests OCL_ICD_VENDORS="$icd"
            tests OCL_ICD_VENDORS="$icd" GNOMON_GPU_KERNELS=1
            ;;
        intel)
            from_pypi intel-opencl-rt intel-cmplr-lib-rt || { skipped+=("$driver"); continue; }
            icd=$(library "$place/venv-intel" 'libintelocl.so')
            refuses OCL_ICD_VENDORS="$icd"
            refuses OCL_ICD_VENDORS="$icd" GNOMON_GPU_KERNELS=1
            with=(OCL_ICD_VENDORS="$icd")
            if makes_wrong_avx512 "${with[@]}"; then with+=(CL_CONFIG_CPU_TARGET_ARCH=core-avx2); fi
            tests "${with[@]}"
            tests "${with[@]}" GNOMON_GPU_KERNELS=1
            ;;
        mesa)
            # Mesa looks for libclc's files in the system's folder alone (libclc-15, tools/install_packages.sh ci).
            if ! from_debian mesa-opencl-icd libllvmspirvlib15 libclang-cpp15 libllvm15 libdrm2 libdrm-amdgpu1 \
                libdrm-nouveau2 libdrm-radeon1 libsensors5 libelf1 || [ ! -e /usr/lib/clc/spirv64-mesa3d-.spv ]; then
                skipped+=("$driver")
                continue
            fi
            icd=$(library "$place/debian" 'libRusticlOpenCL.so.1')
            variables=(OCL_ICD_VENDORS="$icd" RUSTICL_ENABLE=llvmpipe LD_LIBRARY_PATH="$(dirname "$icd")"
                XDG_CACHE_HOME="$place/cache-mesa")
            run "$build/tests/self_check_test" "--gtest_filter=SelfCheck.*"
            run "$build/tests/frustum_traced_test" --gtest_filter=SameBits.WithDoublePrecisionHidden
            run "$build/tests/golden_test" --gtest_filter='*/degenerate_main_sun'
            ;;
        *)
            echo "there is no driver $driver here: pocl, intel, mesa" >&2
            exit 2
            ;;
    esac
done

if [ ${#skipped[@]} -gt 0 ]; then
    printf 'SKIPPED: not to be had here, so not tested: %s\n' "${skipped[@]}" >&2
fi
if $failed; then exit 1; fi
