#!/bin/bash
# SPDX-License-Identifier: MIT
# The command links no OpenCL library, loads one when a device is asked for, and names what is wrong with the file that
# GNOMON_OPENCL_LIBRARY names. usage: opencl_library_test.sh GNOMON
set -euo pipefail
gnomon=$1
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

fail() {
    echo "$1" >&2
    [ ! -f "$scratch/out" ] || cat "$scratch/out" >&2
    exit 1
}

# must_fail_with FILE TEXT: `gnomon devices` ends with status 1 and one line that has TEXT.
must_fail_with() {
    local status=0
    GNOMON_OPENCL_LIBRARY=$1 "$gnomon" devices >"$scratch/out" 2>&1 || status=$?
    [ "$status" -eq 1 ] || fail "exit status $status with GNOMON_OPENCL_LIBRARY=$1"
    [ "$(wc -l <"$scratch/out")" -eq 1 ] || fail "more than one line with GNOMON_OPENCL_LIBRARY=$1"
    grep -qF -- "$2" "$scratch/out" || fail "no \"$2\" with GNOMON_OPENCL_LIBRARY=$1"
}

if ldd "$gnomon" | grep -q libOpenCL; then fail "the command links an OpenCL library"; fi
GNOMON_OPENCL_LIBRARY=/nonexistent/libOpenCL.so.1 "$gnomon" techniques >"$scratch/out" 2>&1 ||
    fail "a command that needs no device asked for the OpenCL library"
must_fail_with /nonexistent/libOpenCL.so.1 "/nonexistent/libOpenCL.so.1: cannot open shared object file"
must_fail_with libm.so.6 "libm.so.6 is no OpenCL 1.2 library: it lacks clBuildProgram"
GNOMON_OPENCL_LIBRARY=libOpenCL.so.1 "$gnomon" devices >"$scratch/out" 2>&1 || fail "the system's library named by hand"
