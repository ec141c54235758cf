# SPDX-License-Identifier: MIT
"""Facing of a raster's vertices: whether the sun stands strictly above the triangles over which the ray leaves.

The rule is docs/numerics.md, 14, for height fields; here for many vertices of one grid and one sun at a time. All
coordinates are whole steps below 2^25, so normals are exact in float64. The sign of n . D is taken from float64 where
it is certain, else from math.fsum over products that are exact.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

#: Neighbours of a vertex as (rows, columns) away, row 0 in the north, in the order of their azimuth from the east on.
#: Two that follow one another span a triangle, as the diagonals run from south-west to north-east.
NEIGHBOURS = ((0, 1), (-1, 1), (-1, 0), (0, -1), (1, -1), (1, 0))


class GridFacing:
    """x (C + 2,), y (R + 2,), z (R + 2, C + 2): the vertices of a window and of one more row and column on each side,
    in whole steps; NaN in z where there is none. Answers for the R x C vertices inside."""

    def __init__(self, x: NDArray[np.float64], y: NDArray[np.float64], z: NDArray[np.float64]) -> None:
        rows, columns = z.shape[0] - 2, z.shape[1] - 2
        self.shape = rows, columns
        at = z[1:-1, 1:-1]
        self._edges = []  # x (C,), y (R,), z (R, C) of the edge to each neighbour
        for r, c in NEIGHBOURS:
            dx, dy = x[1 + c : 1 + c + columns] - x[1:-1], y[1 + r : 1 + r + rows] - y[1:-1]
            self._edges.append((dx, dy, z[1 + r : 1 + r + rows, 1 + c : 1 + c + columns] - at))
        self._normals = []
        self._is_there = []
        for k in range(6):
            (ax, ay, az), (bx, by, bz) = self._edges[k], self._edges[(k + 1) % 6]
            n = np.empty((3, rows, columns))
            n[0] = ay[:, None] * bz - az * by[:, None]
            n[1] = az * bx - ax * bz
            n[2] = ax[None, :] * by[:, None] - ay[:, None] * bx[None, :]
            there = np.isfinite(n[0]) & np.isfinite(n[1])
            n[:, ~there] = 0
            self._normals.append(n)
            self._is_there.append(there)
        self._largest = [np.abs(n).max(axis=0) for n in self._normals]

    def faces(self, towards: NDArray[np.float32]) -> NDArray[np.bool_]:
        """(R, C): whether the sun in this direction, upwards, is strictly above the surface around each vertex. A
        vertex without triangles faces every sun."""
        d = towards.astype(np.float64)
        result = np.ones(self.shape, bool)
        leaves = np.zeros(self.shape, bool)
        for k in range(6):
            over = self._leaves_over(k, d)
            if over is None:
                continue
            over = np.broadcast_to(over, self.shape) & self._is_there[k]
            leaves |= over
            result &= ~over | self._above(k, d, over)
        extended = ~leaves
        if extended.any():  # at a border or beside nodata: strictly above the planes of all triangles
            for k in range(6):
                some = extended & self._is_there[k]
                if some.any():
                    result &= ~some | self._above(k, d, some)
        return result

    def _leaves_over(self, k: int, d: NDArray[np.float64]) -> NDArray[np.bool_] | None:
        """Whether the horizontal part of d points into the sector of triangle k; None: nowhere. Each product has at
        most 25 + 24 bits, so it is exact, and so is the comparison of two."""
        (ax, ay, _), (bx, by, _) = self._edges[k], self._edges[(k + 1) % 6]
        ahead, aside = ax * d[1], ay * d[0]
        behind, beside = by * d[0], bx * d[1]
        if ahead.max() < aside.min() or behind.max() < beside.min():
            return None
        over = (ahead[None, :] >= aside[:, None]) & (behind[:, None] >= beside[None, :])
        return over if over.any() else None

    def _above(self, k: int, d: NDArray[np.float64], wanted: NDArray[np.bool_]) -> NDArray[np.bool_]:
        n = self._normals[k]
        s = n[0] * d[0] + n[1] * d[1] + n[2] * d[2]
        above = s > 0
        # |s - exact| is below 3 roundings of products and 2 of sums: 5 x 2^-53 x 3 x largest x |d| < 1.7e-15 of it.
        unsure = wanted & (np.abs(s) <= self._largest[k] * (2e-15 * np.abs(d).max()))
        for r, c in np.argwhere(unsure):
            above[r, c] = exact_sum(n[:, r, c], d) > 0
        return above


def exact_sum(n: NDArray[np.float64], d: NDArray[np.float64]) -> float:
    """n . d with the right sign: n whole numbers below 2^53, d float32 values. The halves' products are exact, and
    math.fsum rounds once."""
    terms = []
    for a, b in zip(n.tolist(), d.tolist(), strict=True):
        high = float(math.floor(a / 2**27) * 2**27)
        terms += [high * b, (a - high) * b]
    return math.fsum(terms)
