#!/bin/bash
# SPDX-License-Identifier: MIT
# Fills in what the files of a copy leave open: @VERSION@, @HOME@ and @MAIL@ (addresses; GNOMON_HOME and GNOMON_MAIL come
# first), and the words that are given. A line "# ..." with @HOME@ is a line from then on. A word that is left is an error.
# usage: fill_in.sh [WORD=VALUE]... -- FILE...
set -euo pipefail
here=$(realpath "$(dirname "$0")")
address() { sed -n "s/^$1=//p" "$here/addresses"; }
words=("VERSION=$("$here/version.sh")" "HOME=${GNOMON_HOME:-$(address HOME)}" "MAIL=${GNOMON_MAIL:-$(address MAIL)}")
while [ "$1" != -- ]; do words+=("$1"); shift; done
shift

program='s/^# (.*@HOME@)/\1/;'
for word in "${words[@]}"; do
    [[ ${word#*=} != *[\|\&\\]* ]] || { echo "$word: has a character that no address has" >&2; exit 2; }
    program+="s|@${word%%=*}@|${word#*=}|g;"
done
sed -E -i "$program" "$@"
if grep -nE '@[A-Z0-9]+@' "$@"; then echo "fill_in.sh: words that nobody fills in" >&2; exit 1; fi
