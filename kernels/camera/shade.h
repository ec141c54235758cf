// SPDX-License-Identifier: MIT
// Contract of the shading: the table that turns linear light in [0, 1] into 8-bit sRGB.
#ifndef GN_SHADE_H
#define GN_SHADE_H

#include "prelude.h"

#define SRGB_TABLE_SIZE 4096

#endif
