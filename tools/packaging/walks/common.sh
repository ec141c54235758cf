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
