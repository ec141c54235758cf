#!/bin/bash
# SPDX-License-Identifier: MIT
# Runs a walk (walks/common.sh, then SCRIPT) as root in a copy of a bare Debian (debootstrap --variant=minbase), which is thrown away afterwards. It has
# no repository, no compiler and no OpenCL; FOLDER is copied to /artefacts. What the walk writes to /results comes back
# as FOLDER/results. Needs root, debootstrap and a Debian mirror. usage: clean_root.sh SUITE FOLDER SCRIPT [ARGUMENTS]
set -euo pipefail
suite=$1 folder=$(realpath "$2") script=$(realpath "$3")
shift 3
roots=$(realpath -m "$(dirname "$0")/../../build-release/roots")
bare=$roots/$suite
mirror=http://deb.debian.org/debian

if [ ! -e "$bare/.complete" ]; then
    rm -rf "$bare"
    mkdir -p "$roots"
    nice debootstrap --variant=minbase --include=ca-certificates "$suite" "$bare" "$mirror" >"$roots/$suite.log"
    touch "$bare/.complete"
fi

root=$(mktemp -d "$roots/$suite.XXXXXX")
trap 'rm -rf "$root"' EXIT
cp -a --reflink=auto "$bare/." "$root"
# Names and certificates are the machine's; packages that one root downloaded another need not.
cp -L /etc/resolv.conf "$root/etc/resolv.conf"
cp -L /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/ca-certificates.crt"
mkdir -p "$roots/archives_$suite" "$root/artefacts" "$root/results"
cp -a --reflink=auto "$roots/archives_$suite/." "$root/var/cache/apt/archives"
cp -a "$folder/." "$root/artefacts"
rm -rf "$root/artefacts/results"
echo force-unsafe-io >"$root/etc/dpkg/dpkg.cfg.d/thrown_away"
{ echo '#!/bin/bash'; cat "$(dirname "$0")/walks/common.sh" "$script"; } >"$root/script"
chmod 755 "$root" "$root/script"

status=0
# Its own mounts and processes: nothing outlives the walk. PoCL asks /sys for the processor's cores.
nice unshare --mount --pid --fork bash -c '
    mount -t proc proc "$0/proc"
    mount --rbind --make-rslave /sys "$0/sys"
    exec chroot "$0" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive HOME=/root \
        PIP_CERT=/etc/ssl/certs/ca-certificates.crt PIP_DISABLE_PIP_VERSION_CHECK=1 /script "$@"' "$root" "$@" || status=$?
find "$root/var/cache/apt/archives" -maxdepth 1 -name '*.deb' -exec cp -u {} "$roots/archives_$suite" \;
mkdir -p "$folder/results"
cp -r "$root/results/." "$folder/results"
exit $status
