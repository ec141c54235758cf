#!/bin/bash
# SPDX-License-Identifier: MIT
# Uses the packed plugin once in a headless QGIS: all algorithms, their results against gnomon-study's own, wrong
# inputs, cancelling, and maps drawn with their styles. ZIP is the plugin, which is packed if it is not given. Needs Debian's
# qgis and python3-qgis. usage: check_in_qgis.sh GNOMON-STUDY FOLDER [ZIP]
set -euo pipefail
program=$(realpath -s "$1") tools=$(realpath "$(dirname "$0")")
mkdir -p "$2"
zip=$(realpath "${3:-$("$tools/pack.sh" "$2/gnomon-qgis.zip")}")
cd "$2"
rm -rf profile
mkdir -p profile/profiles/default/python/plugins
python3 -m zipfile -e "$zip" profile/profiles/default/python/plugins
export QGIS_CUSTOM_CONFIG_PATH=$PWD/profile QT_QPA_PLATFORM=offscreen GNOMON_STUDY=$program
# Debian 12's qgis_process passes its binary an option that the binary does not know.
process=$(command -v qgis_process.bin || command -v qgis_process)
"$process" plugins enable gnomon_qgis >/dev/null 2>&1
"$process" list 2>/dev/null | grep -A3 '^gnomon'
/usr/bin/python3 "$tools/check_in_qgis.py" "$PWD"
