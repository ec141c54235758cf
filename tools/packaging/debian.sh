#!/bin/bash
# SPDX-License-Identifier: MIT
# Builds the Debian packages of the commit that is checked out, by dpkg-buildpackage, and has lintian judge them: an error
# of lintian's is one of this script. FOLDER gets the .deb files and the source package. NANOBIND is the folder of
# nanobind's CMake files (python -m nanobind --cmake_dir). usage: debian.sh FOLDER NANOBIND
set -euo pipefail
folder=$(realpath "$1") nanobind=$2
cd "$(dirname "$0")/../.."
version=$(tools/packaging/version.sh)
source=$folder/source/gnomon-$version

rm -rf "$folder/source"
mkdir -p "$folder/source"
git archive --format=tar.gz --prefix="gnomon-$version/" -o "$folder/source/gnomon_$version.orig.tar.gz" HEAD
tar -C "$folder/source" -xzf "$folder/source/gnomon_$version.orig.tar.gz"
cp -r tools/packaging/debian "$source/debian"
maintainer=$(sed -n 's/^Maintainer: //p' "$source/debian/control")
printf 'gnomon (%s-1) unstable; urgency=medium\n\n  * Version %s: see /usr/share/doc/gnomon/changelog.gz.\n\n -- %s  %s\n' \
    "$version" "$version" "$maintainer" "$(git log -1 --format=%cD)" >"$source/debian/changelog"

cd "$source"
NANOBIND=$nanobind nice dpkg-buildpackage --build=full --no-sign --jobs=2 >"$folder/source/build.log" 2>&1 ||
    { tail -40 "$folder/source/build.log" >&2; exit 1; }
mv ../gnomon_* ../*.deb "$folder"
nice lintian --fail-on error --no-tag-display-limit "$folder/gnomon_${version}-1_"*.changes | tee "$folder/lintian.txt"
