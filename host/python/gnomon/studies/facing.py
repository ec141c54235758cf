# SPDX-License-Identifier: MIT
"""Facing of a raster's vertices: whether the sun stands strictly above the triangles over which the ray leaves.

The rule is that of docs/numerics.md, 14, for height fields; this module applies it to all vertices of a grid. All
coordinates are whole steps below 2^25, so normals are exact in float64. 32 suns that follow one another are decided
together where all of them are certainly above or certainly below a triangle. Other signs of n . D come from float32 or
float64 where they are certain, and else from math.fsum over exact products.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

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
        self._edges = []  # x (C,), y (R,), z (n,) of the edge to each neighbour
        for r, c in NEIGHBOURS:
            dx, dy = x[1 + c : 1 + c + columns] - x[1:-1], y[1 + r : 1 + r + rows] - y[1:-1]
            dz = (z[1 + r : 1 + r + rows, 1 + c : 1 + c + columns] - z[1:-1, 1:-1])[inside]
            self._edges.append((dx, dy, dz))
        self._normals = []  # (n, 3) of each of the six triangles, 0 where a triangle is missing
        self._exists: list[NDArray[np.bool_]] = []
        for k in range(6):
            (ax, ay, az), (bx, by, bz) = (
                self._edge(k, self._row, self._column),
                self._edge(k + 1, self._row, self._column),
            )
            parts = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
            exists = np.logical_and.reduce([np.isfinite(part) for part in parts])
            n = np.stack(parts, axis=1)
            n[~exists] = 0
            self._normals.append(n)
            self._exists.append(exists)
        self._largest = [np.maximum(np.maximum(*np.abs(n.T[:2])), np.abs(n[:, 2])) for n in self._normals]
        self._normals32 = [n.astype(np.float32) for n in self._normals]
        self._irregular = np.flatnonzero(~np.all(self._exists, axis=0))

    def _edge(
        self, k: int, row: NDArray[np.int64], column: NDArray[np.int64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        dx, dy, dz = self._edges[k % 6]
        return dx[column], dy[row], dz

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
        (ax, ay, _), (bx, by, _) = self._edges[k], self._edges[(k + 1) % 6]
        ahead, aside = np.outer(_ends(ax), d[:, 1]), np.outer(_ends(ay), d[:, 0])
        behind, beside = np.outer(_ends(by), d[:, 0]), np.outer(_ends(bx), d[:, 1])
        at_all = (ahead.min(axis=0) >= aside.max(axis=0)) & (behind.min(axis=0) >= beside.max(axis=0))
        at_some = (ahead.max(axis=0) >= aside.min(axis=0)) & (behind.max(axis=0) >= beside.min(axis=0))
        return at_all, at_some

    def _clear_below(self, k: int, d: NDArray[np.float64], chosen: NDArray[np.bool_], result: Planes) -> None:
        """Clears the chosen suns that are not above triangle k. With c the middle of up to 32 suns and e the largest
        |d - c| in each coordinate, n . d differs from n . c by at most |n| . e. Each of the two float32 products rounds
        five times, and the normal once, by 2^-24 of 3 x largest x |c| (or e) in all six: 4e-6 covers both."""
        groups = [np.flatnonzero(chosen[first : first + 32]) + first for first in range(0, len(d), 32)]
        words = np.array([w for w, group in enumerate(groups) if len(group)], np.int64)
        if not len(words):
            return
        ends = np.array([(d[g].min(axis=0), d[g].max(axis=0)) for g in groups if len(g)])
        middle = ends.mean(axis=1).astype(np.float32)
        spread = np.abs(ends - middle[:, None]).max(axis=1).astype(np.float32)
        spread = np.nextafter(spread, np.float32(np.inf))
        rounding = (4e-6 * (np.abs(middle).max(axis=1) + spread.max(axis=1))).astype(np.float32)
        bits = np.array([np.bitwise_or.reduce(np.uint32(1) << (groups[w] % 32).astype(np.uint32)) for w in words])
        for first in range(0, len(self._row), planes.ROWS_AT_ONCE // 2):
            part = slice(first, first + planes.ROWS_AT_ONCE // 2)
            n, exists = self._normals32[k][part], self._exists[k][part]
            s = middle @ n.T
            bound = spread @ np.abs(n).T + rounding[:, None] * self._largest[k][part].astype(np.float32)
            is_below = s < -bound
            result[words, part] &= ~(is_below * bits[:, None])
            uncertain = ~(is_below | (s > bound)) & exists  # _by_vertex() decides the others
            for i in np.flatnonzero(uncertain.any(axis=1)).tolist():
                suns, rows = groups[words[i]], np.flatnonzero(uncertain[i]) + first
                result[words[i], rows] &= self._above_of_word(k, d, suns, rows) | ~bits[i]

    def _above_of_word(
        self, k: int, d: NDArray[np.float64], suns: NDArray[np.int64], rows: NDArray[np.int64]
    ) -> Planes:
        """(rows,) words of the answers of _above() for suns of one word. float32 decides nearly all of them."""
        s = self._normals32[k][rows] @ d[suns].T.astype(np.float32)
        bound = (self._largest[k][rows] * (2e-6 * np.abs(d[suns]).max())).astype(np.float32)[:, None]
        above = s > bound
        uncertain = (above != (s > -bound)).any(axis=1)
        if uncertain.any():
            above[uncertain] = self._above(k, d[suns], rows[uncertain])
        answers = np.zeros((len(rows), 32), bool)
        answers[:, suns % 32] = above
        return planes.packed(answers)[0]

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
