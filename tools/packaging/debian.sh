#!/bin/bash
# SPDX-License-Identifier: MIT
# Builds the Debian packages of the commit that is checked out, by dpkg-buildpackage, and has lintian judge them: an
# error of lintian's is one of this script. FOLDER gets the .deb files and the source package; the sources are unpacked
# and built beside it, in source. NANOBIND is the folder of nanobind's CMake files (python -m nanobind --cmake_dir).
# usage: debian.sh FOLDER NANOBIND
set -euo pipefail
mkdir -p "$1"
folder=$(realpath "$1") nanobind=$2
cd "$(dirname "$0")/../.."
version=$(tools/packaging/version.sh)
work=$(dirname "$folder")/source
source=$work/gnomon-$version

rm -rf "$work"
mkdir -p "$work"
git archive --format=tar.gz --prefix="gnomon-$version/" -o "$work/gnomon_$version.orig.tar.gz" HEAD
tar -C "$work" -xzf "$work/gnomon_$version.orig.tar.gz"
cp -r tools/packaging/debian "$source/debian"
tools/packaging/fill_in.sh -- "$source/debian"/{control,copyright}
maintainer=$(sed -n 's/^Maintainer: //p' "$source/debian/control")
printf 'gnomon (%s-1) unstable; urgency=medium\n\n  * Version %s: see /usr/share/doc/gnomon/changelog.gz.\n\n -- %s  %s\n' \
    "$version" "$version" "$maintainer" "$(git log -1 --format=%cD)" >"$source/debian/changelog"

cd "$source"
NANOBIND=$nanobind nice dpkg-buildpackage --build=full --no-sign --jobs=2 >"$work/build.log" 2>&1 ||
    { tail -40 "$work/build.log" >&2; exit 1; }
mv ../*.deb ../*.dsc ../*.tar.* ../*.changes ../*.buildinfo "$folder"
nice lintian --fail-on error --tag-display-limit 0 --allow-root "$folder/gnomon_${version}-1_"*.changes | tee "$folder/lintian.txt"
