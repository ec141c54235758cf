#!/bin/bash
# SPDX-License-Identifier: MIT
# Fails if a shared library shows a symbol that the public headers do not declare, or lacks one that other programs
# need to catch its exceptions; and if the functions of gnomon.h that it shows are not exactly those of the list: a
# program that was linked with this version needs each. usage: exported_symbols.sh NM LIBRARY HEADERS LISTS...
#
# What the compiler made of the standard library's templates for types that the header declares is weak, and shown.
set -euo pipefail
nm=$1 library=$2 headers=$3 lists=("${@:4}")

wanted=$(grep -hv '^#' "${lists[@]}")
if ! diff <(sort <<<"$wanted") <("$nm" -D --defined-only "$library" | awk '$3 ~ /^gnomon_/ { print $3 }' | sort); then
    echo "the functions of gnomon.h are not those of ${lists[*]} (<: listed, >: shown)"
    exit 1
fi

# At the start of a line, so at the namespace's level: members are indented.
declared=$(sed -s -n '/visibility push/,/visibility pop/p' "$headers"/gnomon/*.hpp |
    sed -nE 's/^(class|struct) (\w+)( .*\{|;.*)$/\2/p; s/^[A-Za-z][^(]* (\w+)\(.*/\1/p; s/^inline constexpr [^=]* (\w+) = .*/\1/p')
shown=$("$nm" -DC --defined-only "$library" | sed -E 's/^[0-9a-f]+ //')  # the symbol's kind, a letter, and its name

awk -v declared="$declared" -v in_c="$wanted" '
    BEGIN {
        split(declared, lines, "\n"); for (i in lines) is_declared[lines[i]]
        split(in_c, lines, "\n"); for (i in lines) is_in_c[lines[i]]
    }
    !($2 in is_in_c) {
        stranger = !/^[A-Za-z] ((vtable|typeinfo|typeinfo name) for )?gnomon::/ && !(/^[WVu] / && /std::/)
        for (rest = $0; match(rest, /gnomon::\(?[A-Za-z_0-9]+/); rest = substr(rest, RSTART + RLENGTH))
            if (!(substr(rest, RSTART + 8, RLENGTH - 8) in is_declared)) stranger = 1
        if (stranger) { print "shown, but not declared: " $0; failed = 1 }
    }
    END { exit failed }' <<<"$shown"

for class in Error InvalidArgument DeviceNotFound OpenClError OutOfDeviceMemory Cancelled Technique; do
    for part in typeinfo vtable; do
        if ! grep -qx "[A-Za-z] $part for gnomon::$class" <<<"$shown"; then
            echo "not shown: $part for gnomon::$class"
            exit 1
        fi
    done
done
