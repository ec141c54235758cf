#!/bin/bash
# SPDX-License-Identifier: MIT
# Builds the Python package's wheel, installs it into a fresh virtual environment and tests it there: with PyPI's PoCL
# alone, as if the system had no OpenCL driver, then with the system's. Makes the API pages (tools/api_pages.sh), where
# there is doxygen. Needs python3 with venv and its headers, and PyPI. usage: test_python.sh [BUILD-FOLDER]
set -euo pipefail
cd "$(dirname "$0")/.."
build=$(realpath -m "${1:-build-python}")
python=${PYTHON:-python3}

rm -rf "$build/venv" "$build/wheel"
"$python" -m venv "$build/venv"
pip=("$build/venv/bin/pip" --disable-pip-version-check --quiet)
if ! "${pip[@]}" download --no-deps --dest "$build/probe" nanobind; then
    echo "SKIPPED: PyPI cannot be reached, so the Python package was neither built nor tested" >&2
    exit 0
fi

# Python names another compiler than CMake does (g++, not c++), which a compiler cache takes for another one.
export CXX=${CXX:-c++}
if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
# What the build needs lies in the environment and not in one of each build, so that all builds share their objects.
requirements='import tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["build-system"]["requires"], sep="\n")'
"${pip[@]}" install --requirement <("$build/venv/bin/python" -c "$requirements")
# The folder lies as deep as the release build's: then a compiler cache knows the files of one with the same options.
shared=(--no-build-isolation --config-settings=build-dir="$build-objects")
"${pip[@]}" wheel . --no-deps --wheel-dir "$build/wheel" "${shared[@]}"
wheel=$(echo "$build"/wheel/gnomon-*.whl)
echo "-- docs/python.md's lines of pip, of which README.md has one"
lines_of_pip() { sed -n '/^```sh$/,/^```$/s/^\(pip [^#]*[^# ]\).*/\1/p' "$1"; }
lines_of_pip docs/python.md | grep -qxF "$(lines_of_pip README.md)"
pip() { "${pip[@]}" "$@" "${shared[@]}"; }
eval "$(lines_of_pip docs/python.md)"
unset -f pip
"${pip[@]}" install "${wheel}[pocl,test,study,weather]" pdoc
ls -l "$wheel"
if command -v doxygen >/dev/null; then tools/api_pages.sh "$build/venv/bin/python"; fi

tests() { "$build/venv/bin/python" -m pytest -q -p no:cacheprovider "$@" tests/python; }
drivers=("$build"/venv/lib/python3*/site-packages/pyopencl/.libs/libpocl*.so)
try='import gnomon; gnomon.Scene([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]]).lit([[0, 0, 1]], direction=(0, 0, -1))'
if said=$(OCL_ICD_VENDORS=${drivers[0]} "$build/venv/bin/python" -c "$try" 2>&1) ||
    [[ $said != *"compiler is older than the CPU"* ]]; then
    echo "-- PyPI's PoCL, the system's drivers hidden"
    OCL_ICD_VENDORS=${drivers[0]} tests
    echo "-- the system's OpenCL library (studies, reports, integrations, viewsheds and docs were tested above, and use it no otherwise)"
    GNOMON_OPENCL_LIBRARY=libOpenCL.so.1 tests --ignore=tests/python/study --ignore=tests/python/test_report.py \
        --ignore=tests/python/test_nothing_grows.py --ignore=tests/python/test_weather.py \
        --ignore=tests/python/test_surfaces.py --ignore=tests/python/test_ladybug.py \
        --ignore=tests/python/test_tutorial.py --ignore=tests/python/test_viewshed.py
else
    echo "SKIPPED: the compiler of PyPI's PoCL is older than this CPU, so the package is tested with the system's driver alone" >&2
    GNOMON_OPENCL_LIBRARY=libOpenCL.so.1 tests
fi
