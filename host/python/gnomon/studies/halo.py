# SPDX-License-Identifier: MIT
"""The halo: the caster tiles that can shadow a box of receivers, found by a pyramid of highest points.

A caster tile is a box on the map and the height of its highest point, its top. A ray from a receiver towards a sun
passes over a tile, or it enters the tile's box below the top: only then can the tile shadow the receiver. The test
starts at the lowest point of a box of receivers and widens boxes by a pad that is far larger than any rounding, so a
tile that is left out can shadow none of the receivers. Nodes of the pyramid are boxes around tiles with the highest of
their tops.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

FAN_OUT = 16


class Curvature(NamedTuple):
    """Heights are lowered by per_square x the squared distance from the centre x, y; per_square is 0 for a plane."""

    x: float
    y: float
    per_square: float

    def lowered(self, x: NDArray[np.float64], y: NDArray[np.float64], z: NDArray[np.float64]) -> NDArray[np.float64]:
        return z if self.per_square == 0 else z - self.per_square * ((x - self.x) ** 2 + (y - self.y) ** 2)

    def least(self, boxes: NDArray[np.float64]) -> NDArray[np.float64]:
        """(K,) the least by which a height in each box (K, 4) is lowered."""
        dx = np.maximum(np.maximum(boxes[:, 0] - self.x, self.x - boxes[:, 2]), 0)
        dy = np.maximum(np.maximum(boxes[:, 1] - self.y, self.y - boxes[:, 3]), 0)
        return self.per_square * (dx**2 + dy**2)


def _interval(
    low: NDArray[np.float64], high: NDArray[np.float64], d: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The interval of t for which low <= t d <= high: first, last; empty where first > last."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        a, b = low / d, high / d
    first, last = np.minimum(a, b), np.maximum(a, b)
    is_parallel = d == 0
    is_inside = (low <= 0) & (high >= 0)
    first = np.where(is_parallel, np.where(is_inside, -np.inf, np.inf), first)
    last = np.where(is_parallel, np.where(is_inside, np.inf, -np.inf), last)
    return first, last


def rises_above(
    boxes: NDArray[np.float64],
    tops: NDArray[np.float64],
    receivers: NDArray[np.float64],
    lowest: NDArray[np.float64],
    towards: NDArray[np.float64],
    pad: float,
) -> NDArray[np.bool_]:
    """Whether a ray from the receivers' box may enter a caster's box below its top. Arrays broadcast: boxes (..., 4)
    as x0, y0, x1, y1, tops (...), receivers (..., 4), lowest (...), towards (..., 3) with z above 0."""
    x_low, x_high = boxes[..., 0] - receivers[..., 2] - pad, boxes[..., 2] - receivers[..., 0] + pad
    y_low, y_high = boxes[..., 1] - receivers[..., 3] - pad, boxes[..., 3] - receivers[..., 1] + pad
    x0, x1 = _interval(x_low, x_high, towards[..., 0])
    y0, y1 = _interval(y_low, y_high, towards[..., 1])
    first = np.maximum(np.maximum(x0, y0), 0)
    last = np.minimum(x1, y1)
    with np.errstate(invalid="ignore", over="ignore"):
        climb = np.where(first > 0, first, 0) * towards[..., 2]
        return (first <= last) & (lowest + climb <= tops + pad)


class Pyramid:
    """Boxes (K, 4) of caster tiles, their tops (K,), +infinity where unknown; and the nodes of the levels above."""

    def __init__(self, boxes: NDArray[np.float64], tops: NDArray[np.float64]) -> None:
        order = _morton_order(boxes)
        self.ids = order
        self._levels = [(boxes[order], tops[order])]
        while len(self._levels[-1][1]) > FAN_OUT:
            children, child_tops = self._levels[-1]
            first = np.arange(0, len(child_tops), FAN_OUT)
            low, high = np.minimum.reduceat(children[:, :2], first), np.maximum.reduceat(children[:, 2:], first)
            self._levels.append((np.concatenate([low, high], axis=1), np.maximum.reduceat(child_tops, first)))
        self.tested = 0

    def tiles_that_can_shadow(
        self,
        receivers: NDArray[np.float64],
        lowest: float,
        towards: NDArray[np.float64],
        curvature: Curvature,
        pad: float,
    ) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """(T,) ids, ascending, of the tiles that can shadow a receiver in the box (4,) from a sun of (M, 3); and (T,
        M), by sun. lowest: the least height of the receivers, after curvature."""
        nodes = np.arange(len(self._levels[-1][1]))
        for level in range(len(self._levels) - 1, -1, -1):
            boxes, tops = self._levels[level][0][nodes], self._levels[level][1][nodes]
            self.tested += len(nodes)
            hit = rises_above(
                boxes[:, None],
                (tops - curvature.least(boxes))[:, None],
                receivers,
                np.float64(lowest),  # type: ignore[arg-type]  # a scalar broadcasts
                towards[None],
                pad,
            )
            is_hit = hit.any(axis=1)
            nodes, hit = nodes[is_hit], hit[is_hit]
            if level > 0:
                children = (nodes[:, None] * FAN_OUT + np.arange(FAN_OUT)).reshape(-1)
                nodes = children[children < len(self._levels[level - 1][1])]
        ids = self.ids[nodes]
        order = np.argsort(ids)
        return ids[order], hit[order]


def _morton_order(boxes: NDArray[np.float64]) -> NDArray[np.int64]:
    """Morton's order of the boxes' centres: boxes that follow one another are near each other."""
    centre = (boxes[:, :2] + boxes[:, 2:]) / 2
    low = centre.min(axis=0, initial=np.inf)
    size = max(float((centre.max(axis=0, initial=-np.inf) - low).max()), 1e-300) if len(boxes) else 1.0
    cells = ((centre - low) / size * 65535).astype(np.uint64)
    key = np.zeros(len(boxes), np.uint64)
    for bit in range(16):
        for axis in (0, 1):
            key |= ((cells[:, axis] >> np.uint64(bit)) & np.uint64(1)) << np.uint64(2 * bit + axis)
    return np.argsort(key, kind="stable")


def leaves_below(
    extent: NDArray[np.float64], top: float, points: NDArray[np.float64], towards: NDArray[np.float64], pad: float
) -> NDArray[np.bool_]:
    """(N,): whether the ray of each point (N, 3) towards a sun (3,) leaves the extent (4,) no higher than `top`."""
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.full(len(points), np.inf)
        for axis in (0, 1):
            d = towards[axis]
            if d != 0:
                edge = extent[2 + axis] if d > 0 else extent[axis]
                t = np.minimum(t, np.maximum((edge - points[:, axis]) / d, 0))
        return points[:, 2] + t * towards[2] <= top + pad
