#!/bin/bash
# SPDX-License-Identifier: MIT
# Fails if a file names another version than host/include/gnomon/version.h, if the packages' files name one at all (they
# are filled in when they are copied), if an address of gnomon's stands elsewhere than in tools/packaging/addresses, or if a
# public header does not say what of it is stable. usage: versions_agree.sh ROOT
set -euo pipefail
cd "$1"
failed=0
complain() { echo "$*"; failed=1; }

version=$(tools/packaging/version.sh)
minor=${version%.*}
newest=$(sed -nE 's/^## ([0-9.]+).*/\1/p' CHANGELOG.md | head -1)
[ "$newest" = "$version" ] || complain "CHANGELOG.md begins with $newest, version.h says $version"
grep -qx "version: $version" CITATION.cff || complain "CITATION.cff does not say version: $version"
grep -q "find_package(gnomon $minor " tests/consumer/CMakeLists.txt ||
    complain "tests/consumer/CMakeLists.txt does not ask for gnomon $minor"
grep -rnE "(^|[^0-9.])${version//./\\.}([^0-9.]|$)" tools/packaging tools/qgis && complain "tools/packaging and tools/qgis write @VERSION@ for the version"
grep -rn '\.invalid\b' tools docs host CITATION.cff pyproject.toml --exclude=addresses --exclude-dir=build &&
    complain "tools/packaging/addresses has the addresses: write @HOME@ or @MAIL@"
for header in host/include/gnomon.h host/include/gnomon.hpp host/include/gnomon/*.h*; do
    sed '/^#/q' "$header" | grep -iE '\b(stable|experimental)\b' >/dev/null || complain "$header does not say what of it is stable"
done
exit $failed
