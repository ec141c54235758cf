# SPDX-License-Identifier: MIT
"""Facing of a raster's vertices: whether the sun stands strictly above the triangles over which the ray leaves.

The rule is that of docs/numerics.md, 14, for height fields; this module applies it to all vertices of a grid. All
coordinates are whole steps below 2^25, so normals are exact in float64. 32 suns that follow one another are decided
together where all of them are certainly above or certainly below a triangle. Other signs of n . D come from float64
where they are certain, and else from math.fsum over exact products.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .. import _gnomon
from . import planes
from .planes import Planes

#: As many vertices times the suns of a block fit into the cache.
ROWS_AT_ONCE = 256
#: Offsets to the neighbours of a vertex, (rows, columns), row 0 in the north, counter-clockwise from the east. Two that
#: follow one another span a triangle, since the diagonals run from south-west to north-east.
NEIGHBOURS = ((0, 1), (-1, 1), (-1, 0), (0, -1), (1, -1), (1, 0))


class GridFacing:
    """x (C + 2,), y (R + 2,), z (R + 2, C + 2): the vertices of a window and of one more row and column on each side,
    in whole steps; NaN in z for a vertex without a height. inside: (R, C) bool, the n vertices that are decided."""

    def __init__(
        self, x: NDArray[np.float64], y: NDArray[np.float64], z: NDArray[np.float64], inside: NDArray[np.bool_]
    ) -> None:
        rows, columns = inside.shape
        self._row, self._column = np.nonzero(inside)
        is_whole, has_holes = bool(inside.all()), bool(np.isnan(z).any())

        def chosen(values: NDArray[np.float64]) -> NDArray[np.float64]:
            return values.reshape(-1) if is_whole else values[inside]

        self._edges = []  # x (C,), y (R,) of the edge to each neighbour
        heights = []  # (R, C)
        for r, c in NEIGHBOURS:
            dx, dy = x[1 + c : 1 + c + columns] - x[1:-1], y[1 + r : 1 + r + rows] - y[1:-1]
            self._edges.append((dx, dy))
            heights.append(z[1 + r : 1 + r + rows, 1 + c : 1 + c + columns] - z[1:-1, 1:-1])
        self._normals: list[NDArray[np.float64]] = []  # (n, 3) of each of the six triangles, 0 where one is missing
        self._exists: list[NDArray[np.bool_]] = []
        self._largest: list[NDArray[np.float64]] = []  # of the sizes of a normal's coordinates
        for k in range(6):
            (ax, ay), (bx, by) = ((e[0], e[1][:, None]) for e in (self._edges[k], self._edges[(k + 1) % 6]))
            az, bz = heights[k], heights[(k + 1) % 6]
            parts = [chosen(part) for part in (ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx)]
            exists = ~np.isnan(parts[0]) if has_holes else np.ones(len(self._row), bool)
            if has_holes:
                parts = [np.where(exists, part, 0) for part in parts]
            n = np.empty((len(self._row), 3))
            for axis, part in enumerate(parts):
                n[:, axis] = part
                np.abs(part, out=part)
            self._normals.append(n)
            self._exists.append(exists)
            self._largest.append(np.maximum(np.maximum(parts[0], parts[1], out=parts[0]), parts[2], out=parts[0]))
        self._irregular = np.flatnonzero(~np.all(self._exists, axis=0)) if has_holes else np.empty(0, np.int64)

    def faces(self, towards: NDArray[np.float32]) -> Planes:
        """The planes of whether each sun (M, 3), all upwards, is strictly above the surface around each vertex. A
        vertex without triangles faces every sun. Tables whose neighbouring suns are close together take the least
        time."""
        d = towards.astype(np.float64)
        result = planes.ones(len(d), len(self._row))
        is_mixed = np.zeros(len(d), bool)  # suns whose rays leave over different triangles at different vertices
        for k in range(6):
            at_all, at_some = self._leaves_over(k, d)
            is_mixed |= at_some & ~at_all
            self._clear_below(k, d, at_all, result)
        for rows, is_chosen in ((self._irregular, ~is_mixed), (np.arange(len(self._row)), is_mixed)):
            chosen = np.flatnonzero(is_chosen)
            for first in range(0, len(rows) if len(chosen) else 0, ROWS_AT_ONCE):
                part = rows[first : first + ROWS_AT_ONCE]
                answers = np.zeros((len(part), len(d)), bool)
                answers[:, chosen] = self._by_vertex(part, d[chosen])
                result[:, part] = result[:, part] & ~planes.packed(is_chosen[None]) | planes.packed(answers)
        return result

    def _leaves_over(self, k: int, d: NDArray[np.float64]) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """(M,) twice: whether the horizontal part of each sun points into the sector of triangle k at all vertices; and
        whether it may at some. Each product has at most 25 + 24 bits, so it is exact, and so is the comparison of two;
        the largest product is that of the largest or the smallest edge."""
        (ax, ay), (bx, by) = self._edges[k], self._edges[(k + 1) % 6]
        ahead, aside = np.outer(_ends(ax), d[:, 1]), np.outer(_ends(ay), d[:, 0])
        behind, beside = np.outer(_ends(by), d[:, 0]), np.outer(_ends(bx), d[:, 1])
        at_all = (ahead.min(axis=0) >= aside.max(axis=0)) & (behind.min(axis=0) >= beside.max(axis=0))
        at_some = (ahead.max(axis=0) >= aside.min(axis=0)) & (behind.max(axis=0) >= beside.min(axis=0))
        return at_all, at_some

    def _clear_below(self, k: int, d: NDArray[np.float64], chosen: NDArray[np.bool_], result: Planes) -> None:
        """Clears the chosen suns that are not above triangle k. (_by_vertex() decides where it is missing.)"""
        if not chosen.any():
            return
        unsure = _gnomon.clear_below(self._normals[k], self._exists[k], d, chosen, result)
        for row, sun in unsure.reshape(-1, 2).tolist():
            if not exact_sum(self._normals[k][row], d[sun]) > 0:
                result[sun // 32, row] &= ~np.uint32(1 << sun % 32)

    def _above(self, k: int, d: NDArray[np.float64], rows: slice | NDArray[np.int64]) -> NDArray[np.bool_]:
        """(rows, M): whether n . D > 0, n the normal of triangle k at each vertex."""
        n = self._normals[k][rows]
        s = n @ d.T
        above: NDArray[np.bool_] = s > 0
        # |s - exact| is below 3 roundings of products and 2 of sums: 5 x 2^-53 x 3 x largest x |d| < 1.7e-15 of it.
        uncertain = np.abs(s) <= self._largest[k][rows][:, None] * (2e-15 * np.abs(d).max())
        uncertain &= self._exists[k][rows][:, None]
        if uncertain.any():
            for row, sun in np.argwhere(uncertain):
                above[row, sun] = exact_sum(n[row], d[sun]) > 0
        return above

    def _by_vertex(self, rows: NDArray[np.int64], d: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(rows, M): whether each sun is above the surface, over whichever triangle its ray leaves. At borders and
        beside nodata the planes of all triangles extend the surface."""
        row, column = self._row[rows], self._column[rows]
        result = np.ones((len(rows), len(d)), bool)
        leaves = np.zeros_like(result)
        not_below = np.ones_like(result)  # is below no triangle
        for k in range(6):
            (ax, ay), (bx, by) = (
                (e[0][column, None], e[1][row, None]) for e in (self._edges[k], self._edges[(k + 1) % 6])
            )
            exists = self._exists[k][rows, None]
            over = (ax * d[:, 1] >= ay * d[:, 0]) & (by * d[:, 0] >= bx * d[:, 1]) & exists
            above = self._above(k, d, rows)
            leaves |= over
            result &= ~over | above
            not_below &= ~exists | above
        return result & (leaves | not_below)


def _ends(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.array([values.min(), values.max()])


def exact_sum(n: NDArray[np.float64], d: NDArray[np.float64]) -> float:
    """n . d with the right sign: n whole numbers below 2^53, d float32 values. The halves' products are exact, and
    math.fsum rounds once."""
    terms = []
    for a, b in zip(n.tolist(), d.tolist(), strict=True):
        high = float(math.floor(a / 2**27) * 2**27)
        terms += [high * b, (a - high) * b]
    return math.fsum(terms)
