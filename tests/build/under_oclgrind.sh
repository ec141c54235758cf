#!/bin/sh
# SPDX-License-Identifier: MIT
# Runs a program under oclgrind and fails if the program fails or oclgrind reports anything.
# oclgrind's own exit status is the program's, so what it reports is read from its log: any line there is a finding.
# Not asked for: --uninitialized. oclgrind 21.10 does not see what clEnqueueFillBuffer writes and reports every buffer
# that was cleared with it.
# usage: under_oclgrind.sh OCLGRIND PROGRAM [ARGUMENTS...]
set -eu
oclgrind=$1
shift
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# The device must be oclgrind's, else a pass would mean nothing; and a cached program of another run would be checked
# instead of the kernels as they are now.
export GNOMON_DEVICE=Oclgrind GNOMON_CACHE_DIR="$scratch/cache"
# Relaxed loads that only save an atomic would be reported as races (kernels/prelude.h, GN_RELAXED_LOAD). Optimised,
# clang 14 leaves llvm.experimental.noalias.scope.decl where structures are returned, which oclgrind 21.10 does not know.
export GNOMON_BUILD_OPTIONS="-DGN_ATOMIC_RELAXED_LOADS -cl-opt-disable"
# Each OpenCL context of the program opens the log anew, which would empty a file: a pipe keeps what the first ones
# said. Held open here, so that its reader waits for the last of them.
mkfifo "$scratch/log"
exec 3<>"$scratch/log"
cat "$scratch/log" 3>&- > "$scratch/findings" &
status=0
"$oclgrind" --check-api --data-races --max-errors 5 --log "$scratch/log" "$@" 3>&- || status=$?
exec 3>&-
wait
if [ -s "$scratch/findings" ]; then
    echo "oclgrind reports:"
    cat "$scratch/findings"
    exit 1
fi
exit $status
