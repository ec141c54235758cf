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


def is_met(triangles: NDArray[np.int64], eye: NDArray[np.int64], target: NDArray[np.int64]) -> bool:
    """Whether the open line between two points meets one of the closed triangles (F, 3, 3), which lie strictly across
    it: edge-on triangles do not count. All are whole numbers."""
    low, high = np.minimum(eye, target), np.maximum(eye, target)
    is_near = (triangles.max(axis=1) >= low).all(axis=1) & (triangles.min(axis=1) <= high).all(axis=1)
    e, t = ([int(v) for v in point] for point in (eye, target))
    return any(_meets(triangle, e, t) for triangle in triangles[is_near].tolist())


def _meets(triangle: list[list[int]], eye: list[int], target: list[int]) -> bool:
    def volume(a: list[int], b: list[int], c: list[int]) -> int:
        (x, y, z), (u, v, w), (p, q, r) = ([i - j for i, j in zip(end, eye, strict=True)] for end in (a, b, c))
        return x * (v * r - w * q) - y * (u * r - w * p) + z * (u * q - v * p)

    a, b, c = triangle
    of_eye, to_target = volume(a, b, c), [volume(p, q, target) for p, q in ((a, b), (b, c), (c, a))]
    is_inside = all(v >= 0 for v in to_target) or all(v <= 0 for v in to_target)
    whole = sum(to_target)  # of the eye, a base and the target: the part beyond the triangle's plane follows
    return whole != 0 and is_inside and 0 < of_eye * (1 if whole > 0 else -1) < abs(whole)
