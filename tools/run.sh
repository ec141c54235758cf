#!/bin/bash
# SPDX-License-Identifier: MIT
# From a fresh Debian or Ubuntu to a picture: installs the packages that are missing, builds the command gnomon
# (build/gnomon) and renders the built-in sundial to sundial.png. Safe to repeat; what is there is not done again.
set -euo pipefail
cd "$(dirname "$0")/.."

tools/install_packages.sh run

# A build folder that exists keeps its settings (test.sh has more turned on); CMake looks for changes by itself.
if [ ! -f build/CMakeCache.txt ]; then
    cmake -G Ninja -S . -B build -D CMAKE_BUILD_TYPE=Release -D GNOMON_TESTS=OFF -D GNOMON_TOOLS=OFF
fi
cmake --build build --parallel "$(nproc)" --target gnomon_command

if [ ! sundial.png -nt build/gnomon ]; then
    build/gnomon render -o sundial.png
fi
echo "The picture is $(pwd)/sundial.png. Next: build/gnomon render SCENE.glb -o picture.png"
