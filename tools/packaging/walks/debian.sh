#!/bin/bash
# SPDX-License-Identifier: MIT
# In a bare Debian, from the packages alone (clean_root.sh): a stranger installs the command, forgets the driver, renders a
# packaged scene with a home that cannot be written, builds a C program, upgrades, and removes all of it.
set -euo pipefail
cd /tmp
did() { printf '%s\n' "$*" | tee -a /results/debian.txt; }
fails() {  # STATUS WORDS COMMAND...: must fail so, with these words
    local status=0 said
    said=$("${@:3}" 2>&1) || status=$?
    if [ $status -ne "$1" ] || [[ $said != *"$2"* ]]; then echo "exit $status, must be $1 with '$2': $said"; exit 1; fi
}
apt() { apt-get -qq --no-install-recommends "$@" >/results/apt.log 2>&1 || { tail -20 /results/apt.log; exit 1; }; }
# What bears the name, but for what this script put there, what apt keeps of its own lists, and what a run made: the
# kernels of a user whose home cannot be written.
traces() {
    find / -xdev -iname '*gnomon*' -not -path '/artefacts/*' -not -path '/var/cache/apt/*' -not -path '/proc/*' \
        -not -path '/tmp/gnomon-pocl-*'
}

apt update
apt install /artefacts/gnomon_*.deb
did "gnomon installed by apt in a bare Debian $(cat /etc/debian_version)"
fails 1 "no OpenCL" gnomon render -o a.png
did "without a driver gnomon render ends with one sentence: $(gnomon render -o a.png 2>&1 | head -c 160 || true)"
fails 2 "needs" gnomon render --size 0x0 -o a.png
apt install pocl-opencl-icd
mkdir -p /tmp/readonly && chmod 555 /tmp/readonly
as_stranger() { setpriv --reuid=65534 --regid=65534 --clear-groups env HOME=/tmp/readonly "$@"; }
mkdir -m 777 pictures
as_stranger gnomon render /usr/share/gnomon/scenes/sponza.glb -o pictures/sponza.png --size 640x360 \
    --eye -1000,150,-40 --target 200,200,-30 --fovy 60 --light-direction 0.12,-1,0.06
as_stranger gnomon render /usr/share/gnomon/scenes/leaves.glb -o pictures/leaves.png --aov pictures/leaves.exr --size 640x360
cp pictures/*.png /results
did "gnomon render of the packaged sponza.glb and leaves.glb (EXR, textures), as nobody with a home that cannot be written"
as_stranger gnomon devices --check | tail -1 | tee check.txt
grep -q '^RIGHT' check.txt
did "gnomon devices --check: $(cat check.txt)"
for page in /usr/share/man/man1/gnomon*.1.gz; do gzip -t "$page"; done
test -f /usr/share/bash-completion/completions/gnomon

apt install /artefacts/libgnomon0_*.deb /artefacts/libgnomon-dev_*.deb gcc libc6-dev pkg-config ocl-icd-opencl-dev
gcc -std=c11 -Wall -Werror /usr/share/doc/libgnomon-dev/examples/embedding.c -o embedding $(pkg-config --cflags --libs gnomon) -lOpenCL
[ "$(as_stranger ./embedding)" = "2048 of 4096 points are in the light" ]
did "embedding.c of libgnomon-dev's examples, compiled by pkg-config: $(./embedding)"
soname=$(ldd embedding | grep -o 'libgnomon\.so\.[0-9.]*' | head -1)
if pkg-config --exists 'gnomon >= 1'; then echo "pkg-config takes version 1"; exit 1; fi
sed "s/$soname/libgnomon.so.9.9/" embedding >wrong && chmod +x wrong
fails 127 "cannot open shared object file" ./wrong
did "soname $soname; a program of another minor version is refused by the loader, pkg-config refuses gnomon >= 1"

apt install /artefacts/python3-gnomon_*.deb
lit='import gnomon; print(gnomon.__version__, gnomon.Scene([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]]).lit([[.2, .2, -1], [2, 2, -1]], direction=(0, 0, -1)).tolist())'
did "python3-gnomon: $(as_stranger python3 -c "$lit")"
as_stranger python3 -c "$lit" | grep -q '\[False, True\]'

for package in gnomon libgnomon0 libgnomon-dev python3-gnomon; do  # the next version: the same files
    dpkg-deb -R /artefacts/${package}_*.deb next
    sed -i -E 's/^(Version: .*)$/\1+next/; s/\(= ([^)]*)\)/(= \1+next)/' next/DEBIAN/control
    dpkg-deb -b next /tmp/${package}_next.deb >/dev/null
    rm -r next
done
apt install /tmp/*_next.deb
gnomon --version >/dev/null
[ "$(./embedding)" = "2048 of 4096 points are in the light" ]
did "upgraded all four packages to $(dpkg-query -W -f '${Version}' gnomon); the C program still runs"
rm -f /tmp/*_next.deb
apt purge gnomon libgnomon0 libgnomon-dev python3-gnomon
rm -rf /root/.cache/gnomon  # of the user, where the command ran as root
if [ -n "$(traces)" ]; then echo "left behind:"; traces; exit 1; fi
did "apt purge leaves no file of gnomon's"
