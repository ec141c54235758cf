#!/bin/bash
# SPDX-License-Identifier: MIT
# Makes the pages of the public interfaces: build/api/cpp (gnomon.h and gnomon.hpp, by doxygen) and build/api/python (by
# pdoc). A warning is an error, and so is what has no comment. PYTHON is an interpreter with the packages gnomon[study]
# and pdoc; without it, they are built and installed into build/api/venv first. usage: api_pages.sh [PYTHON]
set -euo pipefail
cd "$(dirname "$0")/.."
mkdir -p build/api

doxygen tools/Doxyfile
# A struct's comment may describe its fields, and the head of gnomon.h describes all functions that destroy.
if grep -vE '\(variable\) of |gnomon_[a-z_]*_destroy\(' build/api/warnings.txt; then exit 1; fi

python=${1:-build/api/venv/bin/python}
if [ $# -eq 0 ]; then
    python3 -m venv build/api/venv
    "$python" -m pip --disable-pip-version-check --quiet install '.[study]' pdoc \
        --config-settings=build-dir=build/api/objects
fi
"$python" tools/api_pages.py build/api/python
echo "build/api/cpp/index.html and build/api/python/gnomon.html"
