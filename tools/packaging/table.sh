#!/bin/bash
# SPDX-License-Identifier: MIT
# Writes what tools/release.sh made and tried as two tables: artefacts.csv (size, time of import) and walks.csv (what was
# run in which clean root), each row with the commit that they were made of. usage: table.sh BUILD FOLDER
set -euo pipefail
build=$1 folder=$2
mkdir -p "$folder"
commit=$(cat "$build/commit")
quoted() { sed 's/"/""/g; s/.*/"&"/'; }

{
    echo "commit,artefact,bytes,import"
    for file in "$build"/debian/*.deb "$build"/python/gnomon-* "$build"/qgis/*.zip; do
        import=
        case $file in
            *-abi3-*) import=$(sed -n 's/^import .*: //p' "$build/python/results/wheel_trixie.txt") ;;
            *-cp311-*) import=$(sed -n 's/^import .*: //p' "$build/python/results/wheel_bookworm.txt") ;;
        esac
        echo "$commit,$(basename "$file"),$(stat -c %s "$file"),$import"
    done
} >"$folder/artefacts.csv"
{
    echo "commit,clean root,what was run"
    for results in debian/results/debian:'Debian 12' python/results/wheel_bookworm:'Debian 12' \
        python/results/wheel_trixie:'Debian 13' python/results/older_glibc:'Debian 11' \
        python/results/sdist:'Debian 12' recipes/results/library:'Debian 12' qgis/results/qgis:'Debian 12'; do
        file=$build/${results%:*}.txt
        [ -e "$file" ] || continue
        quoted <"$file" | sed "s/^/$commit,${results#*:},/"
    done
} >"$folder/walks.csv"
cat "$folder"/*.csv
