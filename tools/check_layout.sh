#!/bin/bash
# SPDX-License-Identifier: MIT
# Checks the rules of the house that a compiler cannot: what may be used where. Prints every offending line and the
# rule it breaks; exits 1 if there is one. usage: check_layout.sh [ROOT]
#
# Looks at the files git knows or would take in (not at build folders); without git, at everything.
set -euo pipefail
shopt -s lastpipe  # complain, at a pipe's end, runs in this shell: it sets `broken`
cd "${1:-$(dirname "$0")/..}"

if git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
    mapfile -t all_files < <(git ls-files --cached --others --exclude-standard | sort -u)
else
    mapfile -t all_files < <(find . -type f -not -path './build*' -not -path './.git/*' -printf '%P\n' | sort)
fi

broken=0
complain() {  # rule, then offending lines on standard input
    local lines
    lines=$(cat)
    [ -n "$lines" ] || return 0
    printf '%s:\n%s\n' "$1" "$lines" | sed '2,$s/^/    /'
    broken=1
}

files_matching() {  # regular expression on the path; deleted files are left out
    local file
    for file in "${all_files[@]}"; do
        if [[ $file =~ $1 && -f $file ]]; then printf '%s\0' "$file"; fi
    done
}

lines_matching() {  # path expression, line expression: file:line:text
    files_matching "$1" | { xargs -0 -r grep -nHP -- "$2" || true; }
}

kernel_or_host='^(kernels|host)/'
source='\.(cpp|hpp|h|cl)$'

# The same bits everywhere: nothing whose result the OpenCL specification leaves to the device.
lines_matching "$kernel_or_host.*$source" \
    '\b(native|half|fast)_(cos|sin|tan|divide|recip|sqrt|rsqrt|exp|exp2|exp10|log|log2|log10|powr|length|distance|normalize)\b|\bmad\s*\(' |
    complain 'functions with device-dependent results are banned'
lines_matching '(^|/)(CMakeLists\.txt|CMakePresets\.json)$|\.(cmake|cpp|hpp|h|cl)$' \
    '-cl-(fast-relaxed-math|mad-enable|finite-math-only|no-signed-zeros|unsafe-math-optimizations)|-ffast-math|-Ofast|-funsafe-math-optimizations' |
    complain 'build options that loosen arithmetic are banned'

# OpenCL C has no macros of any number of arguments (6.9 of its specification); PoCL takes them, NVIDIA does not.
lines_matching '^kernels/' '^\s*#\s*define\s+\w+\([^)]*\.\.\.' |
    complain 'macros of any number of arguments are not OpenCL C'

# One door to OpenCL.
lines_matching "$source" '^\s*#\s*include\s*[<"]CL/' | { grep -vE '^host/(cl/|include/gnomon\.hpp:)' || true; } |
    complain 'only host/cl and host/include/gnomon.hpp include OpenCL headers'

# One-way flow: kernels know only kernels. Headers shared with C++ may include the standard library for C++ alone.
lines_matching '^kernels/' '^\s*#\s*include\s*"' |
    while IFS= read -r line; do
        file=${line%%:*}
        included=$(sed -E 's/.*#[[:space:]]*include[[:space:]]*"([^"]*)".*/\1/' <<<"$line")
        for path in "kernels/$included" "$(dirname "$file")/$included"; do
            if [[ -f $path && $(realpath --relative-to=. "$path") == kernels/* ]]; then continue 2; fi
        done
        echo "$line"
    done | complain 'kernels include only files of kernels/'
files_matching '^kernels/' | xargs -0 -r awk '
    # in_cxx[depth]: whether the branch of the conditional at this depth is for C++ alone (1), or not for C++ (-1).
    FNR == 1 { depth = 0 }
    /^[ \t]*#[ \t]*if/ { in_cxx[++depth] = /__cplusplus/ ? 1 : /__OPENCL_VERSION__/ ? -1 : 0
                         if (/ifndef|!/) in_cxx[depth] = -in_cxx[depth] }
    /^[ \t]*#[ \t]*else/ { in_cxx[depth] = -in_cxx[depth] }
    /^[ \t]*#[ \t]*elif/ { in_cxx[depth] = 0 }
    /^[ \t]*#[ \t]*endif/ { --depth }
    /^[ \t]*#[ \t]*include[ \t]*</ { for (d = 1; d <= depth; ++d) if (in_cxx[d] == 1) next
                                     print FILENAME ":" FNR ":" $0 }' |
    complain 'kernels include system headers only where the compiler is a C++ one'

# The references share no code with what they check.
lines_matching "^tests/reference/.*$source" '^\s*#\s*include\s*"' |
    while IFS= read -r line; do
        file=${line%%:*}
        included=$(sed -E 's/.*#[[:space:]]*include[[:space:]]*"([^"]*)".*/\1/' <<<"$line")
        for path in "tests/$included" "tests/reference/$included" "$(dirname "$file")/$included"; do
            if [[ -f $path && $(realpath --relative-to=. "$path") == tests/reference/* ]]; then continue 2; fi
        done
        echo "$line"
    done | complain 'tests/reference includes nothing of host/ or kernels/'
lines_matching "^tests/reference/.*$source" '^\s*#\s*include\s*<(gnomon|cl/|CL/|host/|kernels/|scene/)' |
    complain 'tests/reference includes nothing of host/ or kernels/'

# Every file says its licence, and what it promises.
files_matching '(\.(cpp|hpp|h|cl|cmake|sh)|(^|/)CMakeLists\.txt|^\.ci/run)$' |
    while IFS= read -r -d '' file; do
        head -2 "$file" | grep -qE '^(//|#) SPDX-License-Identifier: MIT$' || echo "$file"
    done | complain 'the first lines must hold "SPDX-License-Identifier: MIT" in a comment'
files_matching '^kernels/' |
    while IFS= read -r -d '' file; do
        [[ $(sed -n 2p "$file") =~ ^(//|/\*).*[[:alpha:]] ]] || echo "$file"
    done | complain 'a kernel file says in a comment, right after the licence line, what it promises'

# The README is true: what it names is there.
if [ -f README.md ]; then
    { grep -oE '`(kernels|host|tests|tools|docs|scenes)/[^` ]+`' README.md | tr -d '`'
      grep -oE '\]\((kernels|host|tests|tools|docs|scenes)/[^) ]+\)' README.md | sed -E 's/^..(.*).$/\1/'; } |
        sort -u | while IFS= read -r path; do [ -e "$path" ] || echo "$path"; done |
        complain 'README.md names files that are not there'
fi

exit $broken
