// SPDX-License-Identifier: MIT
// The version of gnomon, for C and C++. CMake, pyproject.toml and tools/packaging read it here. What a header calls
// stable changes with a minor version alone (from 1.0 on: a major one), and the changelog names what it became; what it
// calls experimental may change with any version. The version itself is stable.
#ifndef GNOMON_VERSION_H
#define GNOMON_VERSION_H

/// While it is zero, the interface may change.
#define GNOMON_VERSION_MAJOR 0
/// Changes with the interface.
#define GNOMON_VERSION_MINOR 3
/// Changes otherwise.
#define GNOMON_VERSION_PATCH 0
/// As one number, to compare.
#define GNOMON_VERSION (GNOMON_VERSION_MAJOR * 10000 + GNOMON_VERSION_MINOR * 100 + GNOMON_VERSION_PATCH)

#endif
