#!/bin/bash
# SPDX-License-Identifier: MIT
# Each rule of tools/check_layout.sh bites: a small tree that keeps all of them passes, and with one offence added it
# fails and names the offending file. usage: check_layout_test.sh CHECK_LAYOUT
set -euo pipefail
check_layout=$(realpath "$1")
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
licence='// SPDX-License-Identifier: MIT'
failures=0

make_good_tree() {
    rm -rf "${tree:?}"/*
    mkdir -p "$tree"/{kernels/exact,host/cl,host/include,tests/reference}
    printf '%s\n' "$licence" '// The prelude.' '#ifdef __cplusplus' '#include <cstdint>' '#endif' \
        '#ifdef __OPENCL_VERSION__' '#define GN_A 1' '#else' '#include <cmath>' '#endif' >"$tree/kernels/prelude.h"
    printf '%s\n' "$licence" '// Sums.' '#include "prelude.h"' >"$tree/kernels/exact/sum.h"
    printf '%s\n' "$licence" '// A stage.' '#include "exact/sum.h"' 'float half_width, nomad(int);' >"$tree/kernels/stage.cl"
    printf '%s\n' "$licence" '// The door.' '#include <CL/cl.h>' >"$tree/host/cl/session.cpp"
    printf '%s\n' "$licence" '// The face.' '#include <CL/cl.h>' >"$tree/host/include/gnomon.hpp"
    printf '%s\n' '# See `kernels/stage.cl`, [the face](host/include/gnomon.hpp)' >"$tree/README.md"
    printf '%s\n' "$licence" '// Exact.' >"$tree/tests/reference/exact.hpp"
    printf '%s\n' "$licence" '// Truth.' '#include <gmp.h>' '#include "exact.hpp"' >"$tree/tests/reference/truth.cpp"
}

must_pass() {
    local output
    if ! output=$("$check_layout" "$tree" 2>&1) || [ -n "$output" ]; then
        echo "a tree that keeps the rules was refused: $output"
        failures=$((failures + 1))
    fi
}

# Appends a line to a file of a good tree; the check must then fail and name that file.
must_catch() {
    local file=$1 line=$2 output
    make_good_tree
    [ -f "$tree/$file" ] || printf '%s\n' "$licence" '// New.' >"$tree/$file"
    echo "$line" >>"$tree/$file"
    if output=$("$check_layout" "$tree" 2>&1) || [[ $output != *"$file"* ]]; then
        echo "not caught: '$line' in $file; the check said: $output"
        failures=$((failures + 1))
    fi
}

make_good_tree
must_pass
must_catch kernels/stage.cl 'float a = mad(b, c, d);'
must_catch kernels/stage.cl 'float a = native_sqrt(b);'
must_catch kernels/exact/sum.h 'float a = half_recip(b);'
must_catch kernels/stage.cl 'float3 n = fast_normalize(v);'
must_catch host/cl/session.cpp 'const char* options = "-cl-fast-relaxed-math";'
must_catch host/cl/session.cpp 'const char* options = "-cl-mad-enable";'
must_catch host/cl/session.cpp 'const char* options = "-cl-finite-math-only";'
must_catch host/cl/session.cpp 'const char* options = "-cl-no-signed-zeros";'
must_catch host/cl/session.cpp 'const char* options = "-cl-unsafe-math-optimizations";'
must_catch host/options.cmake 'add_compile_options(-ffast-math)'
must_catch host/stage.cpp '#include <CL/cl.h>'
must_catch tests/stage_test.cpp '#  include <CL/opencl.hpp>'
must_catch kernels/stage.cl '#include <gnomon.hpp>'
must_catch kernels/stage.cl '#include "missing.h"'
must_catch kernels/stage.cl '#include <math.h>'
must_catch kernels/prelude.h '#include <cstdint>'
must_catch tests/reference/truth.cpp '#include "../../kernels/prelude.h"'
must_catch tests/reference/truth.cpp '#include <gnomon.hpp>'
must_catch tests/reference/truth.cpp '#include <gnomon.hpp>'
must_catch README.md 'The promise is in `kernels/missing.h`.'
must_catch README.md '![a picture](docs/missing.png)'

make_good_tree
echo 'int no_licence;' >"$tree/host/no_licence.cpp"
if "$check_layout" "$tree" >/dev/null; then echo 'not caught: no licence line'; failures=$((failures + 1)); fi
make_good_tree
printf '%s\n' "$licence" 'kernel void no_promise() {}' >"$tree/kernels/no_promise.cl"
if "$check_layout" "$tree" >/dev/null; then echo 'not caught: no first comment'; failures=$((failures + 1)); fi

[ $failures -eq 0 ] && echo "every rule bites"
