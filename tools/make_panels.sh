#!/bin/bash
# SPDX-License-Identifier: MIT
# Makes docs/panels.png, the README's picture: a part of the sundial by a shadow map of 1024 x 1024, by gnomon, and where
# the two masks differ (red: wrongly lit, blue: wrongly dark). Prints how many pixels differ.
# usage: make_panels.sh [GNOMON]   (default: build/gnomon)
set -euo pipefail
cd "$(dirname "$0")/.."
gnomon=${1:-build/gnomon}
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
cut="420x480+545+470" map=(--technique shadow-map --set size=1024) names=(map exact)

"$gnomon" render --quiet --size 1280x960 --ambient sky --exposure -0.4 "${map[@]}" -o "$folder/map.png" --mask "$folder/map_mask.png"
"$gnomon" render --quiet --size 1280x960 --ambient sky --exposure -0.4 -o "$folder/exact.png" --mask "$folder/exact_mask.png"
for name in "${names[@]}"; do
    oiiotool "$folder/$name.png" --crop "$cut" --origin +0+0 --fullpixels -o "$folder/$name.panel.png"
done
# A pale grey picture, on which each wrong pixel has its colour.
oiiotool "$folder/map_mask.png" "$folder/exact_mask.png" --sub --clamp:min=0:max=1 -d float -o "$folder/lit.exr"
oiiotool "$folder/exact_mask.png" "$folder/map_mask.png" --sub --clamp:min=0:max=1 -d float -o "$folder/dark.exr"
oiiotool "$folder/lit.exr" "$folder/dark.exr" --add --ch 0,0,0 -o "$folder/wrong.exr"
oiiotool "$folder/lit.exr" --ch 0,0,0 --mulc .85,.1,.1 "$folder/dark.exr" --ch 0,0,0 --mulc .1,.25,.9 --add \
    -o "$folder/colours.exr"
oiiotool "$folder/exact.png" --chsum:weight=.3,.6,.1 --ch 0,0,0 --mulc .3 --addc .65 "$folder/wrong.exr" \
    --mulc -1 --addc 1 --mul "$folder/colours.exr" --add --crop "$cut" --origin +0+0 --fullpixels -d uint8 \
    -o "$folder/wrong.panel.png"
oiiotool "$folder/map.panel.png" "$folder/exact.panel.png" "$folder/wrong.panel.png" --mosaic:pad=10 3x1 \
    -d uint8 -o docs/panels.png
oiiotool --stats "$folder/wrong.exr" | grep -m1 'Stats Avg' | awk '{printf "%.2f %% of the pixels differ\n", 100 * $3}'
