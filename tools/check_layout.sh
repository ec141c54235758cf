#!/bin/bash
# SPDX-License-Identifier: MIT
# Checks the rules of the house that a compiler cannot check: what may be used where, the order of the wings, and the
# budgets of sizes. Prints every offending line with the rule that it breaks; exits 1 if there is one.
# usage: check_layout.sh [ROOT]
#
# Reads the files that git knows or would take in (not build folders); without git, all files.
set -euo pipefail
shopt -s lastpipe  # complain, at a pipe's end, runs in this shell: it sets `broken`
programs=$(realpath "${BASH_SOURCE[0]%.sh}")
cd "${1:-$(dirname "$0")/..}"

if git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
    mapfile -t all_files < <(git ls-files --cached --others --exclude-standard -- ':!third_party/*/*' | sort -u)
else
    mapfile -t all_files < <(find . -type f -not -path './build*' -not -path './.git/*' -not -path './third_party/*/*' \
        -printf '%P\n' | sort)
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
source='\.(cpp|hpp|h|clh|cl)$'

# The same bits everywhere: nothing whose result the OpenCL specification leaves to the device.
lines_matching "$kernel_or_host.*$source" \
    '\b(native|half|fast)_(cos|sin|tan|divide|recip|sqrt|rsqrt|exp|exp2|exp10|log|log2|log10|powr|length|distance|normalize)\b|\bmad\s*\(' |
    complain 'functions with device-dependent results are banned'
lines_matching '(^|/)(CMakeLists\.txt|CMakePresets\.json)$|\.(cmake|cpp|hpp|h|clh|cl)$' \
    '-cl-(fast-relaxed-math|mad-enable|finite-math-only|no-signed-zeros|unsafe-math-optimizations)|-ffast-math|-Ofast|-funsafe-math-optimizations' |
    complain 'build options that loosen arithmetic are banned'

# OpenCL C has no macros of any number of arguments (6.9 of its specification); PoCL takes them, NVIDIA does not.
lines_matching '^kernels/' '^\s*#\s*define\s+\w+\([^)]*\.\.\.' |
    complain 'macros of any number of arguments are not OpenCL C'

# Clang 14 builds the fuzzers and does not compile the views of GCC 12's library.
lines_matching "^(host|tests|tools)/.*$source" '\bstd::(ranges::)?views::' | complain 'range views do not compile with clang 14'

# One door to OpenCL.
lines_matching "$source" '^\s*#\s*include\s*[<"]CL/' |
    { grep -vE '^(host/(cl/|include/gnomon(\.h|/device\.hpp):)|tests/drivers/)' || true; } |
    complain 'only host/cl, host/include/gnomon/device.hpp, gnomon.h and tests/drivers include OpenCL headers'

# One place that waits for the device: GNOMON_TRACE marks its calls, and tests/query/waits_test.cpp counts them. (The
# other file tries once whether a driver keeps its binaries.)
lines_matching "^host/.*$source" '\bclFinish\s*\(|\bclWaitForEvents\s*\(|clEnqueue\w+\([^;]*CL_TRUE' |
    { grep -vE '^host/cl/(session|program|opencl)\.[ch]pp:' || true; } |
    complain 'only host/cl/session.cpp waits for the device'

# What stands at the top is fixed, so a stray copy of a folder shows.
printf '%s\n' "${all_files[@]}" | sed -n 's|/.*||p' | sort -u |
    { grep -vxE '\.ci|docs|host|kernels|scenes|tests|third_party|tools' || true; } |
    complain 'the folders at the top are .ci, docs, host, kernels, scenes, tests, third_party and tools'

# One-way flow. The wings and their order stand in host/stages.cmake: a wing includes itself and the wings above it. The
# files host/*.cpp and host/*.hpp come after all wings. host/include and kernels/prelude.h come before them. No wing
# includes host/app, host/measure, host/python or host/scene. Kernels include only kernels, from kernels/ on.
# A `.h` in kernels/ is a contract: C++ reads it, directly or through another contract. C++ never reads a `.clh`.
mapfile -t wings < <(sed -nE 's/^gnomon_wing\(([a-z_/]+).*/\1/p' host/stages.cmake)
[ ${#wings[@]} -gt 0 ] || echo 'host/stages.cmake' | complain 'gnomon_wing(NAME ...) names each wing'
mapfile -d '' -t sources < <(files_matching "^(kernels|host|tests|tools)/.*$source")
offences=$(printf '%s\n' "${sources[@]}" | awk -v wings="${wings[*]}" -f "$programs/includes.awk")
offences_of() { sed -n "s/^$1 //p" <<<"$offences"; }
offences_of wings |
    complain 'a folder of kernels/ or host/ is a wing of host/stages.cmake or host/{app,include,measure,python,scene}'
offences_of direction | complain 'a wing includes only itself and the wings above it in host/stages.cmake'
offences_of kernels | complain 'kernels include only files of kernels/'
offences_of system | complain 'kernels include system headers only where the compiler is a C++ one'
offences_of contracts | complain 'C++ reads every .h of kernels/, directly or through another, and no .clh'
offences_of references | complain 'tests/reference includes nothing of host/ or kernels/'
files_matching '^tests/.*/' | while IFS= read -r -d '' file; do
    folder=${file#tests/}
    case ${folder%/*} in
        build | command | consumer | drivers | fuzz | fuzz/* | golden | mutants | proofs | protocols | python | python/study | reference | reference/* | support | tools | view) ;;
        *) [[ " ${wings[*]} exact/predicates " == *" ${folder%/*} "* ]] || echo "$file" ;;
    esac
done | complain 'a folder of tests/ is a wing of host/stages.cmake or a room that tools/check_layout.sh names'

# The references share no code with what they check (the includes by path: above).
lines_matching "^tests/reference/.*$source" '^\s*#\s*include\s*<(gnomon|cl/|CL/|host/|kernels/|scene/)' |
    complain 'tests/reference includes nothing of host/ or kernels/'

# Answers are equal or wrong: a tolerance has its place where floats approximate (shadow maps, means, pictures).
lines_matching '^tests/(exact|simd|lists|receivers|occluders|camera/camera|trace|prepared|golden|technique|rivals)[/_][^/]*\.(cpp|hpp)$' \
    '\b(EXPECT|ASSERT)_(NEAR|FLOAT_EQ|DOUBLE_EQ)\b|(?i)\b\w*(epsilon|tolerance)\w*\b' |
    complain 'tests of exact stages use no tolerance'

# A test's suite is named after what it tests (a stage, a part of it, a fixture), the test after what must hold.
lines_matching '^(tests|tools)/.*\.cpp$' '^\s*TEST(_F|_P)?\((?![A-Z][A-Za-z0-9]*(?<!Test), [A-Z][A-Za-z0-9]*\))' |
    complain 'suites and tests have names in CamelCase, without the suffix Test'

# Every file says its licence, and what it promises.
files_matching '(\.(c|cpp|hpp|h|clh|cl|cmake|sh|awk)|(^|/)CMakeLists\.txt|^\.ci/run)$' | xargs -0 -r awk '
    function report() { if (file != "" && !has_licence) print file }
    FNR == 1 { report(); file = FILENAME; has_licence = 0 }
    FNR <= 2 && /^(\/\/|#) SPDX-License-Identifier: MIT$/ { has_licence = 1 }
    END { report() }' | complain 'the first lines must hold "SPDX-License-Identifier: MIT" in a comment'
files_matching '^kernels/.*\.(cl|clh|h)$' | xargs -0 -r awk 'FNR == 2 && !/^(\/\/|\/\*).*[A-Za-z]/ { print FILENAME }' |
    complain 'a kernel file says in a comment, right after the licence line, what it promises'

# Budgets. (docs/ and README.md: below.)
lines_of() { files_matching "$1" | xargs -0 -r awk 'FNR == 1 { files[++n] = FILENAME } { ++lines[FILENAME] }
    END { for (i = 1; i <= n; ++i) print lines[files[i]], files[i] }'; }
lines_of '^kernels/.*\.(cl|clh)$' | awk '$1 > 450 { print $2 ": " $1 " lines" }' |
    complain 'a .cl or .clh has at most 450 lines'
# Each wing has a budget of lines, kernels and host together (tools/check_layout/budgets.txt). A wing that grows takes a
# larger number there, in a commit that says what went for it; one that shrinks takes a smaller one.
budgets=tools/check_layout/budgets.txt
[ -f "$budgets" ] || budgets=/dev/null
lines_of "$kernel_or_host.*$source" | awk -v table="$budgets" '
    function wing_of(path, parts, n) {  # a public header named like a satellite is part of it
        n = split(path, parts, "/")
        sub(/\.hpp$/, "", parts[n])
        return parts[2] == "include" && !is_core(parts[n]) ? parts[n] : n > 2 ? parts[2] : "root"
    }
    function is_core(wing) { return wing !~ /^(app|lattice|measure|python|rivals|samples|scene|shading|sight)$/ }
    { wing = wing_of($2); lines[wing] += $1; if (is_core(wing)) lines["core"] += $1 }
    END {
        while ((getline line < table) > 0)
            if (line !~ /^#/) { split(line, words, " "); budget[words[1]] = words[2] }
        for (wing in budget) if (lines[wing] > budget[wing]) print wing ": " lines[wing] " lines, " budget[wing] " allowed"
        if (table != "/dev/null") for (wing in lines) if (!(wing in budget)) print wing ": no budget"
    }' | sort | complain 'a wing has at most the lines that tools/check_layout/budgets.txt allows it'

files_matching '^kernels/.*/' | tr '\0' '\n' | awk '
    { sub(/\/[^\/]*$/, ""); ++count[$0] }
    function most(folder) { return folder == "kernels/rivals/shadow_map" ? 25 : 15 }
    END { for (f in count) if (count[f] > most(f)) print f ": " count[f] " files" }' |
    sort | complain 'a folder of kernels/ has at most 15 files, kernels/rivals/shadow_map 25'
files_matching "$kernel_or_host.*$source" | xargs -0 -r awk -v most=60 -f "$programs/functions.awk" |
    complain 'a function of the product has at most 60 lines'
arguments=$(files_matching '^kernels/' | xargs -0 -r awk -f "$programs/arguments.awk")
awk '$1 > 14 { print $3 ": " $2 ": " $1 " arguments" }' <<<"$arguments" | sort |
    complain 'a kernel has at most 14 arguments'
awk '$1 > 12 { lines = lines $3 ": " $2 ": " $1 " arguments\n"; ++count } END { if (count > 4) printf "%s", lines }' \
    <<<"$arguments" | sort | complain 'at most 4 kernels have more than 12 arguments'

# What a visitor reads stays short. Proofs (docs/numerics.md), the table of docs/audit.md, the tutorials of interfaces and the notebook may be long.
if [ -f README.md ] && [ "$(wc -c <README.md)" -gt 6000 ]; then
    echo "README.md: $(wc -c <README.md) bytes" | complain 'README.md has at most 6 kB'
fi
lines_of '^CONTRIBUTING\.md$' | awk '$1 > 120 { print $2 ": " $1 " lines" }' |
    complain 'CONTRIBUTING.md has at most 120 lines'
files_matching '^docs/.*\.md$' | xargs -0 -r awk '
    FILENAME !~ /^docs\/(notebook\/|(audit|numerics|python|integrations|ladybug|weather|shares|studies|view|viewshed|embedding|gltf)\.md$)/ { words += NF }
    FILENAME == "docs/view.md" { words_of_view += NF }
    FILENAME == "docs/many_lights.md" { words_of_many_lights += NF }
    FILENAME == "docs/audit.md" { words_of_audit += NF }
    FILENAME == "docs/performance.md" { ++lines }
    END { if (words > 8300) print "docs: " words " words"
          if (words_of_view > 700) print "docs/view.md: " words_of_view " words"
          if (words_of_audit > 5600) print "docs/audit.md: " words_of_audit " words"
          if (words_of_many_lights > 1500) print "docs/many_lights.md: " words_of_many_lights " words"
          if (lines > 150) print "docs/performance.md: " lines " lines" }' |
    complain 'docs/ without audit.md, numerics.md, gltf.md, the tutorials and the notebook has at most 8300 words, docs/audit.md at most 5600, docs/many_lights.md 1500, docs/view.md 700, docs/performance.md at most 150 lines'

# README and CONTRIBUTING are true: what they name is there.
for page in README.md CONTRIBUTING.md; do
    [ -f $page ] || continue
    { grep -oE '`(kernels|host|tests|tools|docs|scenes)/[^` ]+`' $page | tr -d '`'
      grep -oE '\]\((kernels|host|tests|tools|docs|scenes)/[^) ]+\)' $page | sed -E 's/^..(.*).$/\1/'; } |
        sort -u | while IFS= read -r path; do [ -e "$path" ] || echo "$path"; done |
        complain "$page names files that are not there"
done

# docs/audit.md is true: what its rows name is there, a function in the file that the row names before it, outside of
# comments that take a whole line; and its counts, here and in docs/techniques.md, are those of its rows.
if [ -f docs/audit.md ]; then
    awk -F'|' '/^\| *[0-9]+ \|/ {
        n = split($5, names, "`"); for (i = 2; i <= n; i += 2) print $2 + 0, names[i]
        n = split($7, names, "`"); for (i = 2; i <= n; i += 2) if (names[i] ~ /^[a-z]+\/[^ ]*$/) print $2 + 0, names[i]
    }' docs/audit.md | while read -r row name; do
        if [[ $name == */* ]]; then
            file=$name
            [ -f "$file" ] || echo "row $row: $file"
        elif ! [ -f "$file" ] || ! grep -vE '^ *(//|#[^d])' "$file" | grep -wF -- "$name" >/dev/null; then
            echo "row $row: $name in $file"
        fi
    done | complain 'docs/audit.md names files or functions that are not there'
    verdicts=$(awk -F'|' '/^\| *[0-9]+ \|/ { gsub(/[* ]/, "", $6); ++rows[$6] } END {
        print rows["faithful"] + 0 " faithful, " rows["simplified"] + 0 " simplified, " rows["absent"] + 0 " absent, " \
              rows["notapplicable"] + 0 " not applicable" }' docs/audit.md)
    for page in docs/audit.md docs/techniques.md; do grep -qF "$verdicts" $page || echo "$page: $verdicts"; done |
        complain "the rows of docs/audit.md have other verdicts than this page counts"
fi

exit $broken
