#!/bin/bash
# SPDX-License-Identifier: MIT
# Builds and runs tests; fails if one fails. Safe to repeat.
#   test.sh          does what run.sh does, then runs all tests but the exhaustive ones
#   test.sh quick    the laws of every stage on small scenes, some minutes after a build
#   test.sh WING     the tests of one wing (host/stages.cmake), or of another folder of tests/
#   test.sh --ci     all that CI runs: first the format, and warnings as errors; the exhaustive tests too; the shell
#                    blocks of the pages (tests/build/pages.py); the page of gnomon view (tools/test_view.sh); the
#                    Python package (tools/test_python.sh); other drivers (tools/test_drivers.sh). A machine that
#                    takes more than 55 minutes before leaves out, and says so: six frames beside the last release's
#                    (tools/speed_guard.py); library and command, and the tests that use them as users do, once more
#                    under AddressSanitizer and UndefinedBehaviorSanitizer; the fuzzers
# GNOMON_TEST_TIME_SCALE=N in the environment makes all time limits N times as long, for a slow machine.
set -euo pipefail
cd "$(dirname "$0")/.."

labels() { find tests -mindepth 1 -maxdepth 1 -type d -printf '%f\n' | grep -vxE 'consumer|python|support|view' | sort; }

what=${1:-default}
case $what in
    default | quick | --ci) ;;
    *)
        if [ $# -ne 1 ] || ! labels | grep -qx -- "$what"; then
            echo "usage: $0 [quick | --ci | WING], where WING is one of: $(labels | xargs)" >&2
            exit 2
        fi
        ;;
esac

# A clone finds in ccache what another clone has compiled.
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1

# step NAME: what begins, after how much time by the clock and of processors.
step() {
    local spent
    spent=$(awk -v each="$(getconf CLK_TCK)" '{print int(($16 + $17) / each)}' /proc/$$/stat)  # of children that ended
    printf '\n== %s (after %d s, %d s of processors)\n' "$*" "$SECONDS" "$spent"
}

# configure FOLDER OPTIONS...: a new folder gets Ninja; one that is there keeps its generator.
configure() {
    local folder=$1 generator=()
    shift
    [ -f "$folder/CMakeCache.txt" ] || generator=(-G Ninja)
    if command -v ccache >/dev/null; then set -- "$@" -D CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
    cmake "${generator[@]}" -S . -B "$folder" -D GNOMON_TEST_TIME_SCALE="${GNOMON_TEST_TIME_SCALE:-1}" "$@" >/dev/null
}
configure_release() {
    configure build -D CMAKE_BUILD_TYPE=Release -D GNOMON_COMMAND=ON -D GNOMON_TESTS=ON -D GNOMON_TOOLS=ON "$@"
}

# run_tests FOLDER OPTIONS-OF-CTEST...: the tests share the machine with the driver's own threads, so there are no more
# of them than cores. What a test could not check is said at the end.
run_tests() {
    local folder=$1
    shift
    ctest --test-dir "$folder" --output-on-failure --no-tests=error --parallel "$(nproc)" "$@"
    grep -hE '^\[  SKIPPED \] .*[^:]$|NOT TESTED' "$folder/Testing/Temporary/LastTest.log" | sort | uniq -c |
        sed 's/^/not tested: /' || true
}

case $what in
    default)
        step "Packages"
        tools/install_packages.sh test
        step "Build and picture"
        configure_release
        cmake --build build --parallel "$(nproc)"
        tools/run.sh
        step "Tests"
        run_tests build --label-exclude exhaustive
        step "Left to 'tools/test.sh --ci'"
        ctest --test-dir build --show-only --label-regex exhaustive | grep -c '  Test ' |
            sed 's/$/ exhaustive tests (of oclgrind and Coq, too); sanitizers, fuzzers, Python package, other drivers/'
        exit
        ;;
    --ci) ;;
    *)
        tools/install_packages.sh test
        configure_release
        cmake --build build --parallel "$(nproc)" --target "tests_of_$what"
        left_out=(--label-exclude exhaustive)
        if [ "$what" = proofs ]; then left_out=(); fi  # all of Coq's are exhaustive
        run_tests build --label-regex "^$what\$" "${left_out[@]}"
        exit
        ;;
esac

step "Packages"
tools/install_packages.sh ci
step "Format and layout"
git ls-files -z '*.c' '*.cpp' '*.hpp' '*.h' '*.clh' '*.cl' | xargs -0 clang-format-14 --dry-run --Werror
git grep -lz '^#!/bin/bash' -- tools .ci tests scenes docs | xargs -0 shellcheck --severity warning
tools/check_layout.sh
step "Release build and picture"
configure_release -D GNOMON_WERROR=ON
cmake --build build --parallel "$(nproc)"
tools/run.sh
step "Tests"
run_tests build
step "Shell blocks of the pages"
python3 tests/build/pages.py build
# CI is stopped after 90 minutes. What takes a slow machine the last half hour is left out there.
is_slow() { [ "$SECONDS" -gt 3300 ]; }
if is_slow; then
    step "NOT TESTED, since this machine is slow: processor time beside the last release's"
else
    step "Processor time beside the last release's"
    python3 tools/speed_guard.py build/tools/bench
fi
step "The page of gnomon view, in a browser"
tools/test_view.sh build
step "Python package and other drivers, side by side: both mostly wait for one compiler"
tools/test_drivers.sh build >build/drivers.log 2>&1 &
status=0
CMAKE_ARGS=-DGNOMON_WERROR=ON tools/test_python.sh || status=1  # the release build's objects, from ccache
wait $! || status=1
cat build/drivers.log
[ "$status" -eq 0 ] || exit "$status"
if is_slow; then
    step "NOT TESTED, since this machine is slow: sanitizers, fuzzers"
    exit
fi
step "Host code and its tests under the sanitizers"  # after the release build: the driver has its kernels now
configure build-sanitize -D CMAKE_BUILD_TYPE=RelWithDebInfo -D "CMAKE_CXX_FLAGS_RELWITHDEBINFO=-O1 -g1" \
    -D GNOMON_SANITIZE=ON -D GNOMON_WERROR=ON -D GNOMON_TOOLS=OFF
cmake --build build-sanitize --parallel "$(nproc)"
run_tests build-sanitize --label-exclude exhaustive
step "Fuzzers"
tools/fuzz.sh 30
step "Done"
