#!/bin/bash
# SPDX-License-Identifier: MIT
# In a bare Debian, from the static library alone (recipes.sh): a stranger's project finds it by find_package() and by
# pkg-config, in C++ and in C, and asks for a version that is not there.
set -euo pipefail
cd /tmp
did() { printf '%s\n' "$*" | tee -a /results/library.txt; }
apt() { apt-get -qq --no-install-recommends "$@" >/results/apt.log 2>&1 || { tail -20 /results/apt.log; exit 1; }; }
apt update
apt install g++ cmake make pkg-config opencl-c-headers ocl-icd-opencl-dev pocl-opencl-icd
tar -C /usr/local -xzf /artefacts/gnomon-static.tar.gz

cmake -S /artefacts/consumer -B build -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build build >build.log 2>&1 || { tail -20 build.log; exit 1; }
[ "$(build/example | head -3)" = "$(printf 'point 0 is in shadow\npoint 1 is in shadow\npoint 2 is in the light')" ]
[ "$(build/embedding_in_c)" = "2048 of 4096 points are in the light" ]
did "find_package(gnomon), static: example.cpp, and embedding.c: $(build/embedding_in_c)"
gcc -std=c11 /artefacts/consumer/embedding.c -o by_pkg_config $(pkg-config --static --cflags --libs gnomon) -lOpenCL
[ "$(./by_pkg_config)" = "2048 of 4096 points are in the light" ]
did "pkg-config --static gnomon: the same"

sed -i 's/find_package(gnomon [0-9.]* REQUIRED)/find_package(gnomon 0.2 REQUIRED)/' /artefacts/consumer/CMakeLists.txt
if said=$(cmake -S /artefacts/consumer -B wrong 2>&1); then echo "version 0.2 was found"; exit 1; fi
[[ $said == *'compatible with requested version "0.2"'* || $said == *"requested version"* ]]
did "find_package(gnomon 0.2): refused, another minor version"
