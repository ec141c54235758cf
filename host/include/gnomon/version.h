// SPDX-License-Identifier: MIT
// The version of gnomon, for C and C++. CMake and pyproject.toml read it here. Before 1.0 every minor version may
// change the interface.
#ifndef GNOMON_VERSION_H
#define GNOMON_VERSION_H

/// While it is zero, the interface may change.
#define GNOMON_VERSION_MAJOR 0
/// Changes with the interface.
#define GNOMON_VERSION_MINOR 2
/// Changes otherwise.
#define GNOMON_VERSION_PATCH 0
/// As one number, to compare.
#define GNOMON_VERSION (GNOMON_VERSION_MAJOR * 10000 + GNOMON_VERSION_MINOR * 100 + GNOMON_VERSION_PATCH)

#endif
