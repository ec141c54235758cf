# SPDX-License-Identifier: MIT
# In a bare Debian with a C++ compiler and without OpenCL, from the source distribution alone (clean_root.sh): a stranger
# builds it by pip, imports it, forgets the driver, and takes [pocl].
walk=sdist
apt update
apt install python3-venv python3-dev g++
python3 -m venv /venv
[ -z "$(find / -xdev -name 'libOpenCL*')" ]
sdist=$(echo /artefacts/gnomon-*.tar.gz)
/venv/bin/pip --quiet install "$sdist"
did "$(basename "$sdist") built and installed by pip for $(/venv/bin/python --version) with g++, no OpenCL"
mkdir -m 777 pictures
cd pictures
fails 1 "gnomon[pocl]" first
did "without OpenCL: $said"
/venv/bin/pip --quiet install pyopencl pocl-binary-distribution
emulate_older_cpu
[ "$(first)" = "[False, True]" ]
cp first.ppm /results/first_sdist.ppm
did "with what [pocl] names, as nobody with a home that cannot be written: points [False, True], and a picture of 320x180"
