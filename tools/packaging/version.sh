#!/bin/bash
# SPDX-License-Identifier: MIT
# Prints the version that host/include/gnomon/version.h states, the one place where it stands.
set -euo pipefail
sed -nE 's/^#define GNOMON_VERSION_(MAJOR|MINOR|PATCH) ([0-9]+)$/\2/p' "$(dirname "$0")/../../host/include/gnomon/version.h" |
    paste -sd.
