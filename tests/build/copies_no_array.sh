#!/bin/bash
# SPDX-License-Identifier: MIT
# Runs the C example under GNOMON_TRACE, and fails if the library copied as many bytes between host and device as the
# smallest of the example's arrays has, all its copies together. usage: copies_no_array.sh PROGRAM
set -euo pipefail
smallest=16384  # the visibility of 64 x 64 points; positions and triangles take more

trace=$(GNOMON_TRACE=1 "$1" 2>&1)
grep -qx '2048 of 4096 points are in the light' <<<"$trace" || { echo "another answer: $trace"; exit 1; }
copied=$(awk '/^gnomon: trace: (reading|writing) / { sum += $4 } END { print sum + 0 }' <<<"$trace")
launches=$(grep -cE '^gnomon: trace: .* x ' <<<"$trace")
echo "$launches launches, $copied bytes copied"
# A run reads its counters, and the check of the device writes its inputs: a trace without these is no trace.
grep -q '^gnomon: trace: reading ' <<<"$trace"
grep -q '^gnomon: trace: writing ' <<<"$trace"
[ "$launches" -gt 5 ] && [ "$copied" -lt "$smallest" ]
