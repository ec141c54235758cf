# SPDX-License-Identifier: MIT
# In a bare Debian, from the packages alone (clean_root.sh): a stranger installs the command, forgets the driver, renders a
# packaged scene with a home that cannot be written, builds a C program, removes all, comes from an older version, and
# removes all again.
walk=debian
# What bears the name, but for what this script put there, what apt keeps of its own lists, and what a run made: the
# kernels of a user whose home cannot be written.
leaves_nothing() {
    local traces
    rm -rf /root/.cache/gnomon  # of the user, where the command ran as root
    traces=$(find / -xdev -iname '*gnomon*' -not -path '/artefacts/*' -not -path '/var/cache/apt/*' -not -path '/proc/*' \
        -not -path '/tmp/gnomon-pocl-*')
    [ -z "$traces" ] || { echo "left behind: $traces"; exit 1; }
}
packages=(gnomon libgnomon0 libgnomon-dev python3-gnomon)

apt update
apt install /artefacts/gnomon_*.deb
did "gnomon installed by apt in a bare Debian $(cat /etc/debian_version)"
fails 1 "no OpenCL" gnomon render -o a.png
did "without a driver gnomon render says: $said"
fails 2 "needs" gnomon render --size 0x0 -o a.png
did "a size of nothing: $said"
apt install pocl-opencl-icd
fails 1 "cannot write" as_stranger gnomon render --size 64x36 -o /tmp/readonly/a.png
did "into a folder that cannot be written: $said"
mkdir -m 777 pictures
as_stranger gnomon render /usr/share/gnomon/scenes/sponza.glb -o pictures/sponza.png --size 640x360 \
    --eye -1000,150,-40 --target 200,200,-30 --fovy 60 --light-direction 0.12,-1,0.06
as_stranger gnomon render /usr/share/gnomon/scenes/leaves.glb -o pictures/leaves.png --aov pictures/leaves.exr --size 640x360
cp pictures/*.png /results
did "gnomon render of the packaged sponza.glb and leaves.glb (EXR, textures), as nobody with a home that cannot be written"
as_stranger gnomon devices --check | tail -1 | tee check.txt
grep -q '^RIGHT' check.txt
did "gnomon devices --check: $(cat check.txt)"
as_stranger gnomon devices --check --json >/results/check.json
as_stranger gnomon bench --seconds 10 -o pictures/bench.json >/results/bench.txt
cp pictures/bench.json /results
did "gnomon bench --seconds 10: $(grep '^RIGHT' /results/bench.txt)"
for command in '' $(gnomon --help | sed -n '/^Subcommands/,/^$/s/^  \([a-z]\+\) .*/-\1/p'); do
    gzip -t "/usr/share/man/man1/gnomon$command.1.gz"
done
. /usr/share/bash-completion/completions/gnomon
compopt() { :; }
complete_words() { COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) && _gnomon gnomon && echo "${COMPREPLY[*]}"; }
[ "$(complete_words gnomon ren)" = render ]
[ "$(complete_words gnomon bench --sec)" = --seconds ]
did "a man page of each command; bash completes 'gnomon ren' and 'gnomon bench --sec'"

apt install /artefacts/libgnomon0_*.deb /artefacts/libgnomon-dev_*.deb gcc libc6-dev pkg-config ocl-icd-opencl-dev
gcc -std=c11 -Wall -Werror /usr/share/doc/libgnomon-dev/examples/embedding.c -o embedding $(pkg-config --cflags --libs gnomon) -lOpenCL
answer="2048 of 4096 points are in the light"
[ "$(as_stranger ./embedding)" = "$answer" ]
did "embedding.c of libgnomon-dev's examples, compiled by pkg-config: $(./embedding)"
fails 1 "gnomon >= 9" pkg-config --print-errors --exists 'gnomon >= 9'
did "pkg-config 'gnomon >= 9': $said"

apt install /artefacts/python3-gnomon_*.deb
lit='import gnomon; print(gnomon.__version__, gnomon.Scene([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]]).lit([[.2, .2, -1], [2, 2, -1]], direction=(0, 0, -1)).tolist())'
did "python3-gnomon: $(as_stranger python3 -c "$lit")"
as_stranger python3 -c "$lit" | grep -q '\[False, True\]'
python3 -c 'import json; check, bench = (json.load(open(f"/results/{name}.json")) for name in ("check", "bench"))
assert check["wrong"] == 0 and all(a["right"] for a in check["answers"]) and bench["gnomon"] == check["gnomon"]'
did "the JSON of devices --check and bench is read by Python"
apt remove "${packages[@]}"
leaves_nothing
did "apt remove leaves no file of gnomon's"

for package in "${packages[@]}"; do  # an older version: the same files, but for the soname
    dpkg-deb -R /artefacts/${package}_*.deb older
    sed -i -E 's/^Version: .*$/Version: 0.2.0-1/; s/\(= [^)]*\)/(= 0.2.0-1)/' older/DEBIAN/control
    for library in $(find older -name 'libgnomon*.so.0*'); do
        if [ -L "$library" ]; then
            ln -sf "$(readlink "$library" | sed 's/so\.0\.[0-9]*/so.0.2/')" "$library"
        else
            sed -i 's/\(libgnomon[_a-z]*\.so\.0\.\)[0-9]/\12/g' "$library"  # ldconfig believes what is inside
        fi
        mv "$library" "$(sed 's/so\.0\.[0-9]*/so.0.2/' <<<"$library")"
    done
    dpkg-deb -b older /tmp/${package}_older.deb >/dev/null
    rm -r older
done
apt install /tmp/*_older.deb
rm /tmp/*_older.deb
fails 127 "cannot open shared object file" ./embedding
did "the C program beside a library of version 0.2: $said"
apt install /artefacts/*.deb
[ "$(./embedding)" = "$answer" ]
[ -z "$(find / -xdev -name 'libgnomon*.so.0.2*')" ]
did "upgraded all four packages from 0.2.0-1 to $(dpkg-query -W -f '${Version}' gnomon), no file of 0.2 is left, and the C program runs"
apt purge "${packages[@]}"
leaves_nothing
did "apt purge leaves no file of gnomon's"
