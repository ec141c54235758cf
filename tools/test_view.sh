#!/bin/bash
# SPDX-License-Identifier: MIT
# Tests the page of gnomon view: its server's protocol, and the page itself in headless Chromium (Debian's, by selenium
# from PyPI). Needs the command, python3 with venv, PyPI, chromium and its driver. usage: test_view.sh [BUILD-FOLDER]
set -euo pipefail
cd "$(dirname "$0")/.."
build=$(realpath -m "${1:-build}")
tools="build-view/venv"

[ -x "$tools/bin/python" ] || python3 -m venv "$tools"
if ! "$tools/bin/pip" install --disable-pip-version-check --quiet pytest pillow selenium; then
    echo "SKIPPED: PyPI cannot be reached, so gnomon view was not tested" >&2
    exit 0
fi
export GNOMON_BINARY=$build/gnomon GNOMON_CACHE_DIR=${GNOMON_CACHE_DIR:-$build/test_kernel_cache}
"$tools/bin/python" -m pytest -q -p no:cacheprovider tests/view
