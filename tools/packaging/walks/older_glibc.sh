# SPDX-License-Identifier: MIT
# In a bare Debian 11, whose glibc is older than this machine's and whose Python is older than gnomon needs: the loader
# finds all functions that the wheels' modules name, but Python's own.
walk=older_glibc
apt update
apt install python3
glibc=$(ldd --version | sed -n '1s/.* //p')
for wheel in /artefacts/gnomon-*.whl; do
    python3 -m zipfile -e "$wheel" unpacked
    module=$(echo unpacked/gnomon/_gnomon.*so)
    ldd -r "$module" >found.txt 2>&1
    missing=$(grep -E 'not found|undefined symbol' found.txt | grep -vE 'undefined symbol: _?Py[A-Z_]' || true)
    [ -z "$missing" ] || { echo "$(basename "$wheel"): $missing"; exit 1; }
    grep -q 'undefined symbol: PyModule' found.txt
    did "$(basename "$wheel"): glibc $glibc and its libm have all that $(basename "$module") needs"
    rm -r unpacked
done
