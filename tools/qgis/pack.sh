#!/bin/bash
# SPDX-License-Identifier: MIT
# Packs the QGIS plugin, with version and addresses of tools/packaging. usage: pack.sh [ZIP]
set -euo pipefail
zip=$(realpath -m "${1:-gnomon-qgis.zip}")
cd "$(dirname "$0")"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp -r gnomon_qgis "$folder"
../packaging/fill_in.sh -- "$folder/gnomon_qgis/metadata.txt"
rm -f "$zip"
python3 -m zipfile -c "$zip" "$folder/gnomon_qgis"
python3 - "$zip" <<'PYTHON'
import sys, zipfile
names = zipfile.ZipFile(sys.argv[1]).namelist()
stray = [n for n in names if "__pycache__" in n]
assert not stray, f"pack.sh: {stray}: remove them first"
assert {"gnomon_qgis/metadata.txt", "gnomon_qgis/LICENSE"} <= set(names)
PYTHON
echo "$zip"
