# SPDX-License-Identifier: MIT
"""Lines of sight over a raster of whole steps in rational arithmetic, one by one: the sample by which a viewshed is
checked. It shares no code with the kernels that decide."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

#: Parts of a cell in which eyes stand.
PARTS = 256


def is_seen(steps: NDArray[np.int32], none: int, eye: tuple[int, int, int, int], cell: tuple[int, int]) -> bool:
    """Whether a cell (row, column) that has a height is seen. steps: heights, `none` for no data. eye: x and y in parts
    of cells, its height, and the targets' height above the ground, in steps.

    The ground and the line are linear over each triangle: they are compared where the line crosses columns, rows and
    diagonals, at each edge or vertex that exists."""
    x, y, top, above = eye
    row, column = cell
    dx, dy = PARTS * column - x, PARTS * row - y
    rise = int(steps[cell]) + above - top
    for start, run, family in ((x, dx, 0), (y, dy, 1), (x + y, dx + dy, 2)):
        low, high = sorted((start, start + run))
        for line in range(low // PARTS, -(-high // PARTS) + 1):
            if not low < PARTS * line < high:
                continue
            share = Fraction(PARTS * line - start, run)
            place = (y + share * dy if family == 0 else x + share * dx) / PARTS
            whole = place.numerator // place.denominator
            rest = place - whole
            corners = [(whole + i, line) if family == 0 else (line, whole + i) if family == 1
                       else (line - whole - i, whole + i) for i in range(2 if rest else 1)]  # fmt: skip
            heights = [int(steps[corner]) for corner in corners]
            if none in heights:
                continue
            ground = heights[0] + (rest * (heights[1] - heights[0]) if rest else 0)
            if top + share * rise <= ground:
                return False
    return True
