#!/bin/bash
# SPDX-License-Identifier: MIT
# Makes the man pages of the command from its --help, gnomon.1 and gnomon-COMMAND.1. usage: man_pages.sh GNOMON FOLDER
set -euo pipefail
gnomon=$(realpath "$1")
mkdir -p "$2"
cd "$2"
version=$("$gnomon" --version)

# make_page NAME COMMAND...: the sentence of its help is the page's.
make_page() {
    local name=$1 sentence
    shift
    sentence=$("$@" --help | sed -n '1s/^gnomon: //;1p')
    help2man --no-info --section=1 --name="${sentence%.}" --version-string="${version#gnomon }" --output="$name.1" \
        --help-option=--help "$*"
    sed -i "/^\.SH NAME/{n;s/^gnomon [a-z]* /$name /}" "$name.1"
}
make_page gnomon "$gnomon"
for command in $("$gnomon" --help | sed -n '/^Subcommands/,/^$/s/^  \([a-z]\+\) .*/\1/p'); do
    make_page "gnomon-$command" "$gnomon" "$command"
done
