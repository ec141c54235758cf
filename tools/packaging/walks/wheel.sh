# SPDX-License-Identifier: MIT
# In a bare Debian without OpenCL, from the wheels alone (clean_root.sh): a stranger installs the wheel that fits the Python
# there, imports it, forgets the driver, takes [pocl], and with the argument "study" maps sun hours of a GeoTIFF.
walk=wheel_$(. /etc/os-release; echo "$VERSION_CODENAME")
apt update
apt install python3-venv libexpat1
python3 -m venv /venv
pip() { /venv/bin/pip --quiet "$@"; }
[ -z "$(find / -xdev -name 'libOpenCL*')" ]
pip install --no-index --no-deps --find-links /artefacts --only-binary :all: gnomon
for file in /artefacts/gnomon-*.whl; do
    if /venv/bin/pip install --dry-run --no-deps --quiet "$file" 2>/dev/null; then wheel=$file; else other=$file; fi
done
pip install numpy
did "$(basename "$wheel") installed for $(/venv/bin/python --version) in a bare Debian, no OpenCL"
if [ -n "${other:-}" ]; then
    fails 1 "not a supported wheel" pip install "$other"
    did "the wheel of another Python: $said"
fi
fails 1 "gnomon>=9" pip install --no-index --find-links /artefacts 'gnomon>=9'
did "a version that is not there: $said"
cat >import.py <<'E'
import sys, time
import numpy
begin = time.perf_counter()
import gnomon
print(f"{(time.perf_counter() - begin) * 1e3:.0f} ms")
E
as_stranger /venv/bin/python import.py >/dev/null
did "import gnomon (numpy's import not counted): $(as_stranger /venv/bin/python -B import.py)"
mkdir -m 777 pictures
cd pictures
fails 1 "gnomon[pocl]" first
did "without OpenCL: $said"
pip install "$wheel[pocl]"
emulate_older_cpu
# As soon as PyPI's PoCL needs no compiler, docs/python.md has a sentence too many.
fails 134 "gcc libc6-dev" first
did "with [pocl] and without a C compiler: ${said##*UserWarning: }"
apt install gcc libc6-dev
[ "$(first)" = "[False, True]" ]
cp first.ppm "/results/first_${walk#wheel_}.ppm"
did "with [pocl], as nobody with a home that cannot be written: points [False, True], and a picture of 320x180"
if [ "${1:-}" = study ]; then
    pip install "$wheel[pocl,study]"
    if [ ${#emulation[@]} -gt 0 ]; then  # too slow for a study: the driver that gnomon's message names
        pip uninstall --yes pocl-binary-distribution
        apt install pocl-opencl-icd
        did "in place of PyPI's PoCL: Debian's $(dpkg-query -W -f '${Version}' pocl-opencl-icd)"
    fi
    cp /artefacts/sun_study.py /tmp
    mkdir -m 777 /tmp/study
    cd /tmp/study
    as_stranger env MPLCONFIGDIR=/tmp/study /venv/bin/python ../sun_study.py | tee ../study.txt
    cp town.png /results
    /venv/bin/python -c 'import rasterio; print(rasterio.open("/tmp/study/sun_hours.tif").profile)' >/dev/null
    did "sun hours of a GeoTIFF (sun_study.py): $(tail -1 ../study.txt); sun_hours.tif is a GeoTIFF again"
    printf 'raster = "nowhere.tif"\nstart = 2026-03-20\nend = 2026-03-21\nstep = "30min"\nutc_offset = 1\n' >wrong.toml
    fails 1 "nowhere.tif" as_stranger /venv/bin/gnomon-study run wrong.toml
    did "a raster that is not there: $said"
fi
pip uninstall --yes gnomon
if [ -n "$(find /venv -iname '*gnomon*')" ]; then find /venv -iname '*gnomon*'; exit 1; fi
did "pip uninstall leaves no file of gnomon's"
