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
    mkdir -p "$tree"/{kernels/exact,kernels/trace,host/cl,host/trace,host/include,host/app,tests/reference,tests/trace,docs/notebook}
    printf '%s\n' '# SPDX-License-Identifier: MIT' 'gnomon_wing(cl session)' 'gnomon_wing(exact sum)' \
        'gnomon_wing(trace trace' '            again)' >"$tree/host/stages.cmake"
    printf '%s\n' "$licence" '// The prelude.' '#ifdef __cplusplus' '#include <cstdint>' '#endif' \
        '#ifdef __OPENCL_VERSION__' '#define GN_A 1' '#else' '#include <cmath>' '#endif' >"$tree/kernels/prelude.h"
    printf '%s\n' "$licence" '// Sums.' '#include "prelude.h"' >"$tree/kernels/exact/sum.h"
    printf '%s\n' "$licence" '// Device code.' '#include "prelude.h"' >"$tree/kernels/exact/wide.clh"
    printf '%s\n' "$licence" '// A contract.' '#include "exact/sum.h"' '#ifndef __cplusplus' \
        '#include "exact/wide.clh"' '#endif' >"$tree/kernels/trace/trace.h"
    printf '%s\n' "$licence" '// A stage.' '#include "trace/trace.h"' 'float half_width, nomad(int);' \
        >"$tree/kernels/trace/trace.cl"
    printf '%s\n' "$licence" '// The door.' '#include <CL/cl.h>' >"$tree/host/cl/session.cpp"
    mkdir -p "$tree/host/include/gnomon" "$tree/tools/check_layout"
    printf '%s\n' "$licence" '// The face.' '#include <gnomon/device.hpp>' >"$tree/host/include/gnomon.hpp"
    printf '%s\n' "$licence" '// Devices.' '#include <CL/cl.h>' >"$tree/host/include/gnomon/device.hpp"
    printf '%s\n' "$licence" '// In C.' >"$tree/host/include/gnomon.h"
    printf '%s\n' "$licence" '#include "kernels/trace/trace.h"' '#include "cl/session.hpp"' >"$tree/host/trace/trace.hpp"
    printf '%s\n' "$licence" '#include <gnomon.hpp>' '#include "trace/trace.hpp"' >"$tree/host/gnomon.cpp"
    printf '%s\n' "$licence" '#include "scene/scene.hpp"' >"$tree/host/app/main.cpp"
    printf '%s\n' "$licence" '#include "trace/trace.hpp"' >"$tree/tests/trace/trace_test.cpp"
    printf '%s\n' '# See `kernels/trace/trace.cl`, [the face](host/include/gnomon.hpp)' >"$tree/README.md"
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

# Appends text to a file of a good tree; the check must then fail and name that file, or $3 where it is given.
must_catch() {
    local file=$1 text=$2 name=${3:-$1} output
    make_good_tree
    mkdir -p "$(dirname "$tree/$file")"
    [ -f "$tree/$file" ] || printf '%s\n' "$licence" '// New.' >"$tree/$file"
    printf '%s\n' "$text" >>"$tree/$file"
    if output=$("$check_layout" "$tree" 2>&1) || [[ $output != *"$name"* ]]; then
        echo "not caught: '${text:0:200}' in $file; the check said: $output"
        failures=$((failures + 1))
    fi
}

# Appends text that keeps the rules to a file of a good tree.
must_accept() {
    make_good_tree
    printf '%s\n' "$2" >>"$tree/$1"
    must_pass
}

repeated() { yes "$2" | head -"$1"; }  # count, line
function_of() { printf '%s\n' "$2 {"; repeated $(($1 - 2)) '    if (a) { b({1}); }'; echo '}'; }  # lines, head
kernel_of() { echo "__kernel void $2(uint a$(repeated $(($1 - 1)) ', __global const uint* b' | tr -d '\n')) {}"; }

make_good_tree
must_pass
must_catch host/trace/trace.hpp 'for (int i : list | std::views::reverse) use(i);'
must_catch kernels/trace/trace.cl 'float a = mad(b, c, d);'
must_catch kernels/trace/trace.cl 'float a = native_sqrt(b);'
must_catch kernels/exact/sum.h 'float a = half_recip(b);'
must_catch kernels/trace/trace.cl 'float3 n = fast_normalize(v);'
must_catch host/cl/session.cpp 'const char* options = "-cl-fast-relaxed-math";'
must_catch host/cl/session.cpp 'const char* options = "-cl-mad-enable";'
must_catch host/cl/session.cpp 'const char* options = "-cl-finite-math-only";'
must_catch host/cl/session.cpp 'const char* options = "-cl-no-signed-zeros";'
must_catch host/cl/session.cpp 'const char* options = "-cl-unsafe-math-optimizations";'
must_catch host/options.cmake 'add_compile_options(-ffast-math)'
must_catch host/trace/stage.cpp '#include <CL/cl.h>'
must_accept host/include/gnomon.h '#include <CL/cl.h>'
must_catch host/include/gnomon.hpp '#include <CL/cl.h>'
must_accept host/cl/session.cpp 'void f() { clFinish(queue); }'
must_catch host/trace/trace.hpp 'void f() { clFinish(queue); }'
must_catch host/trace/trace.hpp 'void f() { clWaitForEvents(1, &event); }'
must_catch host/trace/trace.hpp 'void f() { clEnqueueReadBuffer(queue, buffer, CL_TRUE, 0, 4, to, 0, 0, 0); }'
must_catch tests/trace/stage_test.cpp '#  include <CL/opencl.hpp>'
must_catch kernels/trace/trace.cl '#include <gnomon.hpp>'
must_catch kernels/trace/trace.cl '#include "missing.h"'
must_catch kernels/trace/trace.cl '#include <math.h>'
must_catch kernels/prelude.h '#include <cstdint>'
must_catch tests/reference/truth.cpp '#include "../../kernels/prelude.h"'
must_catch tests/reference/truth.cpp '#include <gnomon.hpp>'
must_catch tests/reference/truth.cpp '#include "trace/trace.hpp"'
must_catch README.md 'The promise is in `kernels/missing.h`.'
must_catch README.md '![a picture](docs/missing.png)'
must_catch CONTRIBUTING.md 'The promise is in `kernels/missing.h`.' kernels/missing.h

# The order of the wings: from kernels/, from host/, out of the order, and out of the wings.
must_catch kernels/exact/sum.h '#include "trace/trace.h"'
must_catch host/cl/session.cpp '#include "trace/trace.hpp"'
must_catch host/cl/session.cpp '#include "../trace/trace.hpp"'
must_catch host/cl/session.cpp '#include "kernels/exact/sum.h"'
must_catch kernels/prelude.h '#include "exact/sum.h"'
must_catch host/trace/trace.hpp '#include "../gnomon.cpp"'
must_catch host/trace/trace.hpp '#include "app/main.cpp"'
must_catch elsewhere/trace/trace.cl '// A stray copy of a folder.' '    elsewhere'
must_catch host/elsewhere/stage.cpp '// A folder that is no wing.'
must_catch kernels/elsewhere/stage.cl '// A folder that is no wing.'
must_catch tests/elsewhere/stage_test.cpp '// A folder that is no wing.'
must_accept host/app/main.cpp '#include "trace/trace.hpp"'
must_accept host/gnomon.cpp '#include "cl/session.cpp"'

# Contracts and device code.
must_catch kernels/exact/unread.h '// No C++ file reads it.'
must_catch host/trace/trace.hpp '#include "kernels/exact/wide.clh"'
must_catch tests/trace/trace_test.cpp '#include "kernels/exact/wide.clh"'
must_catch kernels/trace/trace.h '#include "exact/wide.clh"'

# Budgets, each with what just keeps it.
must_catch kernels/trace/trace.cl "$(repeated 450 '//')"
must_catch kernels/exact/wide.clh "$(repeated 450 '//')"
must_accept kernels/exact/wide.clh "$(repeated 447 '//')"
all_wings=$(printf '%s 99\n' app cl exact include root)
must_accept tools/check_layout/budgets.txt "$all_wings"$'\ncore 9999\ntrace 99'
must_catch tools/check_layout/budgets.txt "$all_wings"$'\ncore 9999\ntrace 7' 'trace: 13 lines, 7 allowed'
must_catch tools/check_layout/budgets.txt "$all_wings"$'\ncore 9999' 'trace: no budget'
must_catch tools/check_layout/budgets.txt "$all_wings"$'\ncore 12\ntrace 99' 'core: 43 lines, 12 allowed'
for head in 'int f(int a)' 'static void f(uint a, __global uint* b)' 'Stage::Stage() : a_{1}, b_(2)' 'auto f() -> int' \
            'template <typename T> int f(T a = {})' 'namespace x { struct Y { bool operator==(int a) const'; do
    must_catch host/trace/trace.hpp "$(function_of 61 "$head")"
    must_accept host/trace/trace.hpp "$(function_of 60 "$head")"
done
must_catch kernels/trace/trace.cl "$(printf '#ifdef A\nvoid f(int a) {\n#else\nvoid f(int b) {\n#endif\n'
                                     repeated 58 '    b();'; echo '}')"
must_catch kernels/trace/trace.cl "$(repeated 60 '#define F \'; echo F)"
must_accept kernels/trace/trace.cl "$(function_of 40 'void f(int a)'; function_of 40 'void g(int a)')"
must_accept host/trace/trace.hpp "$(printf 'namespace a {\nstruct B {\n'; repeated 70 '    int f() { return "}}"[0]; }'
                                    printf '};\nconst int c[] = {\n'; repeated 70 '    1,'; printf '};\n}\n')"
must_catch kernels/trace/trace.cl "$(kernel_of 15 f)"
must_accept kernels/trace/trace.cl "$(kernel_of 14 f)"
must_catch kernels/trace/trace.cl "$(for f in a b c d e; do kernel_of 13 $f; done)"
must_accept kernels/trace/trace.cl "$(for f in a b c d; do kernel_of 13 $f; done; kernel_of 12 e)"
must_catch kernels/trace/trace.cl "$(printf '#define MORE , uint x, \\\n    uint y\n__kernel void f(uint a MORE'
                                     repeated 12 ', uint b'; echo ') {}')"
must_catch docs/page.md "$(repeated 8301 'word')" 'docs: 8'
must_catch docs/many_lights.md "$(repeated 1501 'word')"
must_catch CONTRIBUTING.md "$(repeated 120 'word')"
must_catch docs/performance.md "$(repeated 150 '-')"
must_catch README.md "$(repeated 600 '123456789')"
must_accept docs/numerics.md "$(repeated 8301 'word')"

# The table of docs/audit.md: files and functions that are not there, in both columns, and counts that are not its own.
audit_of() { printf '%s\n' "| 1 | 2.1 | Sums are exact. | $1 | faithful | $2 |" '1 faithful, 0 simplified, 0 absent, 0 not applicable'; }
must_audit() {  # rows, what the check must name ('': it must pass)
    local output
    make_good_tree
    printf '%s\n' '1 faithful, 0 simplified, 0 absent, 0 not applicable' >"$tree/docs/techniques.md"
    printf '%s\n' "$1" >"$tree/docs/audit.md"
    output=$("$check_layout" "$tree" 2>&1) || true
    if [[ -z $2 && -n $output || $output != *"$2"* ]]; then
        echo "audit, '$2' must be found in '$1'; the check said: $output"
        failures=$((failures + 1))
    fi
}
must_audit "$(audit_of '`kernels/trace/trace.cl`: `nomad`' 'See `kernels/exact/sum.h`, `fit=a`.')" ''
must_audit "$(audit_of '`kernels/trace/gone.cl`: `nomad`' '')" 'row 1: kernels/trace/gone.cl'
must_audit "$(audit_of '`kernels/trace/trace.cl`: `gone`' '')" 'row 1: gone in kernels/trace/trace.cl'
must_audit "$(audit_of '`kernels/trace/trace.cl`: `stage`' '')" 'row 1: stage in kernels/trace/trace.cl'
must_audit "$(audit_of '`kernels/trace/trace.cl`' 'See `kernels/gone.h`.')" 'kernels/gone.h'
must_audit "$(audit_of '`kernels/trace/trace.cl`' '' | sed 's/1 faithful/2 faithful/')" 'docs/audit.md: 1 faithful, 0 simplified'
must_catch docs/audit.md "$(repeated 5601 'word')"
must_accept docs/notebook/page.md "$(repeated 8301 'word')"
must_catch tests/trace/trace_test.cpp '    EXPECT_NEAR(a, b, 1e-6);'
must_catch tests/trace/trace_test.cpp 'constexpr float epsilon = 1e-6f;'
must_catch tests/trace/trace_test.cpp 'TEST(trace, EqualsReference) {'
must_catch tests/trace/trace_test.cpp 'TEST_F(Trace, equals_reference) {'
must_catch tests/trace/trace_test.cpp 'TEST_P(TraceTest, EqualsReference) {'
must_accept tests/trace/trace_test.cpp 'TEST_P(Trace, EqualsReference) {'

make_good_tree
for i in $(seq 14); do printf '%s\n' "$licence" '// One more.' >"$tree/kernels/trace/stage_$i.cl"; done
if output=$("$check_layout" "$tree") || [[ $output != *'kernels/trace: 16 files'* ]]; then
    echo 'not caught: 16 files in a folder of kernels/'; failures=$((failures + 1))
fi
rm "$tree/kernels/trace/stage_1.cl"
must_pass
make_good_tree
echo 'int no_licence;' >"$tree/host/no_licence.cpp"
if "$check_layout" "$tree" >/dev/null; then echo 'not caught: no licence line'; failures=$((failures + 1)); fi
make_good_tree
printf '%s\n' "$licence" 'kernel void no_promise() {}' >"$tree/kernels/no_promise.cl"
if "$check_layout" "$tree" >/dev/null; then echo 'not caught: no first comment'; failures=$((failures + 1)); fi

[ $failures -eq 0 ] && echo "every rule bites"
