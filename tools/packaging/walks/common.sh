# SPDX-License-Identifier: MIT
# What all walks have (clean_root.sh puts it before them). A walk writes what it did to /results/NAME.txt.
set -euo pipefail
cd /tmp
did() { printf '%s\n' "$*" | tee -a "/results/$walk.txt"; }
apt() { apt-get -qq --no-install-recommends "$@" >/results/apt.log 2>&1 || { tail -20 /results/apt.log; exit 1; }; }

# Somebody without rights, whose home cannot be written.
mkdir -p -m 555 /tmp/readonly
as_stranger() { setpriv --reuid=65534 --regid=65534 --clear-groups env HOME=/tmp/readonly "$@"; }

# fails STATUS WORDS COMMAND...: must fail so, and say these words; "said" has the line with them (where CMake broke it,
# which indents by two, with what follows).
fails() {
    local status=0 all
    all=$("${@:3}" 2>&1) || status=$?
    if [ $status -ne "$1" ] || [[ $all != *"$2"* ]]; then
        echo "${*:3}: exit $status, must be $1 with '$2': $all" >&2
        exit 1
    fi
    said=$(awk -v words="$2" '!found && !index($0, words) { next }
        found && !/^  [^ ]/ { exit }
        { line = $0; sub(/^ +/, "", line); printf "%s%s", found ? " " : "", line; found = 1 }
        !/^  / { exit }' <<<"$all")
}

# first: what a stranger does first with the Python package. emulate_older_cpu: the compiler of PyPI's PoCL knows no CPU that
# is newer than Zen 4; where gnomon says so, first runs on an older one that QEMU emulates.
emulation=()
first() { as_stranger "${emulation[@]}" /venv/bin/python /artefacts/first.py; }
emulate_older_cpu() {
    ! first >first.txt 2>&1 || return 0
    grep -q "compiler is older than the CPU" first.txt || return 0
    fails 1 "compiler is older than the CPU" first
    did "with [pocl] on a CPU newer than PyPI's PoCL:${said#*(-11):}"
    apt install qemu-user-static
    emulation=(qemu-x86_64-static -cpu Haswell)
    did "from here on with [pocl] on an older CPU (${emulation[*]})"
}
