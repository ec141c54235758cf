#!/bin/bash
# SPDX-License-Identifier: MIT
# In a bare Debian without OpenCL, from the wheels alone (clean_root.sh): a stranger installs the wheel that fits the Python
# there, imports it, forgets the driver, takes [pocl], and with the argument "study" maps sun hours of a GeoTIFF.
set -euo pipefail
cd /tmp
python_name=$(. /etc/os-release; echo "$VERSION_CODENAME")
did() { printf '%s\n' "$*" | tee -a "/results/wheel_$python_name.txt"; }
apt() { apt-get -qq --no-install-recommends "$@" >/results/apt.log 2>&1 || { tail -20 /results/apt.log; exit 1; }; }
apt update
apt install python3-venv libexpat1
python3 -m venv /venv
pip() { /venv/bin/pip --quiet "$@"; }
[ -z "$(find / -xdev -name 'libOpenCL*')" ]
pip install --no-index --no-deps --find-links /artefacts gnomon
for wheel in /artefacts/gnomon-*.whl; do
    ! /venv/bin/pip install --dry-run --no-deps --quiet "$wheel" 2>/dev/null || break
done
pip install numpy
did "$(basename "$wheel") installed for $(/venv/bin/python --version) in a bare Debian, no OpenCL"
mkdir -p /tmp/readonly && chmod 555 /tmp/readonly
as_stranger() { setpriv --reuid=65534 --regid=65534 --clear-groups env HOME=/tmp/readonly "$@"; }
cat >import.py <<'P'
import sys, time
import numpy
begin = time.perf_counter()
import gnomon
print(f"{(time.perf_counter() - begin) * 1e3:.0f} ms")
P
as_stranger /venv/bin/python import.py >/dev/null
did "import gnomon (numpy's import not counted): $(as_stranger /venv/bin/python -B import.py)"
cat >first.py <<'P'
import gnomon, numpy as np
box = [[[0, 0, 1], [1, 0, 1], [0, 1, 1]], [[-3, -3, 0], [4, -3, 0], [4, 4, 0]], [[-3, -3, 0], [4, 4, 0], [-3, 4, 0]]]
scene = gnomon.Scene(np.float32(box))
print(scene.lit([[.2, .2, .5], [2, 2, .5]], direction=(0, 0, -1)).tolist())
view = scene.view(eye=(2, -4, 4), target=(.5, .5, .5), up=(0, 0, 1), size=(320, 180))
picture = view.image(direction=(.3, .2, -1))[..., :3]
with open("/tmp/pictures/first.ppm", "wb") as file:
    file.write(b"P6 320 180 255\n" + picture.tobytes())
P
mkdir -m 777 pictures
if said=$(as_stranger /venv/bin/python first.py 2>&1); then echo "ran without a driver: $said"; exit 1; fi
[[ $said == *"gnomon[pocl]"* ]]
did "without OpenCL: $(tail -1 <<<"$said")"
pip install "$wheel[pocl]"
if said=$(as_stranger /venv/bin/python first.py 2>&1); then echo "PyPI's PoCL needs no compiler any more: docs/python.md"; exit 1; fi
[[ $said == *"gcc libc6-dev"* ]]
did "with [pocl] and without a C compiler: $(grep -o "PyPI's PoCL.*" <<<"$said" | head -1)"
apt install gcc libc6-dev
said=$(as_stranger /venv/bin/python first.py)
[ "$said" = "[False, True]" ]
cp pictures/first.ppm "/results/first_$python_name.ppm"
did "with [pocl], as nobody with a home that cannot be written: points $said, and a picture of 320x180"
if [ "${1:-}" = study ]; then
    pip install "$wheel[pocl,study]"
    cp /artefacts/sun_study.py .
    mkdir -m 777 study
    (cd study && as_stranger env MPLCONFIGDIR=/tmp/study /venv/bin/python ../sun_study.py) | tee study.txt
    cp study/town.png /results
    /venv/bin/python -c 'import rasterio; print(rasterio.open("/tmp/study/sun_hours.tif").profile)' >/dev/null
    did "sun hours of a GeoTIFF (sun_study.py): $(tail -1 study.txt); sun_hours.tif is a GeoTIFF again"
    printf 'raster = "nowhere.tif"\nstart = 2026-03-20\nend = 2026-03-21\nstep = "30min"\nutc_offset = 1\n' >wrong.toml
    if said=$(as_stranger /venv/bin/gnomon-study run wrong.toml 2>&1); then echo "ran without a raster"; exit 1; fi
    did "a raster that is not there: $(tail -1 <<<"$said")"
fi
pip uninstall --yes gnomon
if [ -n "$(find /venv -iname '*gnomon*')" ]; then find /venv -iname '*gnomon*'; exit 1; fi
did "pip uninstall leaves no file of gnomon's"
