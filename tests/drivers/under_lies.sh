#!/bin/bash
# SPDX-License-Identifier: MIT
# Runs a program on a device that lies (lying_layer.cpp). Without a sentence the program must succeed, so its answers are
# right under the lie. With one it must refuse: exit status 1, and on standard error one line that matches.
# usage: under_lies.sh LAYER LIES SENTENCE PROGRAM [ARGUMENT...]     (SENTENCE: an extended regular expression, or -)
set -uo pipefail
layer=$1 lies=$2 sentence=$3
shift 3
export OPENCL_LAYERS=$layer GNOMON_TEST_LIES=$lies GNOMON_DEVICE=lies
if [ "$sentence" = - ]; then exec "$@"; fi

errors=$(mktemp)
trap 'rm -f "$errors"' EXIT
"$@" 2>"$errors"
status=$?
sed -i -E '/^gnomon: .* \.\.\. [0-9]+ s$/d' "$errors"  # progress
cat "$errors"
if [ $status -ne 1 ]; then
    echo "WRONG: exit status $status instead of 1 under $lies"
    exit 1
fi
if [ "$(wc -l <"$errors")" -ne 1 ] || ! grep -qE "^gnomon: error: .*($sentence)" "$errors"; then
    echo "WRONG: not one line that matches \"$sentence\" under $lies"
    exit 1
fi
