#!/bin/bash
# SPDX-License-Identifier: MIT
# Does what run.sh does, then builds and runs all tests; fails if one fails. With --ci also: first the format, and
# warnings as errors; then library and command, and the tests that use them as users do, once more under
# AddressSanitizer and UndefinedBehaviorSanitizer; the fuzzers for a minute; and last the Python package
# (tools/test_python.sh) and other drivers (tools/test_drivers.sh).
# Safe to repeat. usage: test.sh [--ci]
set -euo pipefail
cd "$(dirname "$0")/.."

ci=false
case ${1:-} in
    '') ;;
    --ci) ci=true ;;
    *)
        echo "usage: $0 [--ci]" >&2
        exit 2
        ;;
esac

step() { printf '\n== %s (after %d s)\n' "$*" "$SECONDS"; }

# configure FOLDER OPTIONS...: a new folder gets Ninja; one that is there keeps its generator.
configure() {
    local folder=$1 generator=()
    shift
    [ -f "$folder/CMakeCache.txt" ] || generator=(-G Ninja)
    if command -v ccache >/dev/null; then set -- "$@" -D CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
    cmake "${generator[@]}" -S . -B "$folder" "$@"
}

# The tests share the machine with the driver's own threads, so there are no more of them than cores.
build_and_test() {
    cmake --build "$1" --parallel "$(nproc)"
    ctest --test-dir "$1" --output-on-failure --no-tests=error --parallel "$(nproc)"
}

werror=OFF
if $ci; then
    step "Packages"
    tools/install_packages.sh ci
    step "Format and layout"
    git ls-files -z '*.c' '*.cpp' '*.hpp' '*.h' '*.clh' '*.cl' | xargs -0 clang-format-14 --dry-run --Werror
    tools/check_layout.sh
    werror=ON
else
    tools/install_packages.sh test
fi

step "Release build, picture and tests"
configure build -D CMAKE_BUILD_TYPE=Release -D GNOMON_COMMAND=ON -D GNOMON_TESTS=ON -D GNOMON_TOOLS=ON \
    -D GNOMON_WERROR=$werror
tools/run.sh
build_and_test build
if $ci; then
    step "Host code and its tests under the sanitizers"  # after the release build: the driver has its kernels now
    configure build-sanitize -D CMAKE_BUILD_TYPE=RelWithDebInfo -D "CMAKE_CXX_FLAGS_RELWITHDEBINFO=-O1 -g1" \
        -D GNOMON_SANITIZE=ON -D GNOMON_WERROR=ON -D GNOMON_TOOLS=OFF
    build_and_test build-sanitize
    step "Fuzzers"
    tools/fuzz.sh 30
    step "Python package and other drivers, side by side: both mostly wait for one compiler"
    tools/test_drivers.sh build >build/drivers.log 2>&1 &
    status=0
    tools/test_python.sh || status=1
    wait $! || status=1
    cat build/drivers.log
    exit $status
fi
