#!/bin/bash
# SPDX-License-Identifier: MIT
# Fills in the recipes of vcpkg and conda-forge in FOLDER, and checks them: conda-forge's is parsed by rattler-build's own
# parser, vcpkg's is followed by hand, with the options of its portfile, into FOLDER/gnomon-static.tar.gz, what a user of
# find_package() is handed. SDIST is the source distribution, SOURCE the unpacked sources.
# usage: recipes.sh FOLDER SDIST SOURCE
set -euo pipefail
mkdir -p "$1"
folder=$(realpath "$1") sdist=$(realpath "$2") source=$(realpath "$3")
cd "$(dirname "$0")"
version=$(./version.sh)

rm -rf "$folder"/{vcpkg,conda-forge,prefix}
cp -r vcpkg conda-forge "$folder"
find "$folder/vcpkg" "$folder/conda-forge" -type f -print0 | xargs -0 ./fill_in.sh "COMMIT=$(git rev-parse HEAD)" \
    "SHA256=$(sha256sum "$sdist" | cut -d' ' -f1)" "SDIST=$(basename "$sdist")" --

venv=$(dirname "$folder")/recipes_venv
python3 -m venv "$venv"
nice "$venv/bin/pip" --disable-pip-version-check --quiet install py-rattler-build
"$venv/bin/python" check_recipe.py "$folder/conda-forge/recipe.yaml" "$version"
python3 -m json.tool "$folder/vcpkg/gnomon/vcpkg.json" >/dev/null

mapfile -t options < <(grep -oE -- '-DGNOMON_[A-Z]+=(ON|OFF)' vcpkg/gnomon/portfile.cmake)
[ ${#options[@]} -ge 4 ]
nice cmake -G Ninja -S "$source" -B "$source/build/static" -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=g++ -DBUILD_SHARED_LIBS=OFF \
    -DCMAKE_POSITION_INDEPENDENT_CODE=ON "${options[@]}" >"$folder/build.log"
nice cmake --build "$source/build/static" --parallel 2 >>"$folder/build.log"
cmake --install "$source/build/static" --prefix "$folder/prefix" >>"$folder/build.log"
tar -C "$folder/prefix" -czf "$folder/gnomon-static.tar.gz" .
rm -rf "$folder/prefix"
cp -r ../../tests/consumer "$folder"
