# SPDX-License-Identifier: MIT
"""Lines of sight over a mesh: each is a shadow ray to a lamp at the observer's eye."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _arrays
from ._gnomon import Cancelled
from ._lights import Lights
from ._side import Side, VertexSide

if TYPE_CHECKING:
    from ._scene import Scene


class VisibleFrom(NamedTuple):
    """What Scene.visible_from() returns for M observers; arrays have the points' shape.

    counts: int64, the number of observers that see the point.
    bits: uint32 (..., ceil(M / 32)): observer i is bit i % 32 of word i // 32.
    observer_count: M.
    """

    counts: NDArray[np.int64]
    bits: NDArray[np.uint32]
    observer_count: int

    def seen(self) -> NDArray[np.bool_]:
        """(..., M): the bits, one per element."""
        return _arrays.unpacked(self.bits, self.observer_count)


def visible_from(
    scene: Scene,
    observers: Any,
    points: Any,
    height: Any,
    target_height: float,
    distance: Any,
    up: Any,
    side: Side | VertexSide | None,
    progress: Callable[[float], object] | None,
) -> VisibleFrom:
    """Scene.visible_from()."""
    upwards = np.array(_arrays.triple(up, "up"), np.float64)
    if not upwards.any():
        raise ValueError("up: must not be zero")
    upwards /= np.linalg.norm(upwards)
    places = _arrays.rows_of_triples(observers, "observers").reshape(-1, 3)
    _arrays.require_places(places, "observers")
    if not len(places):
        raise ValueError("observers: there is none")
    if points is None:
        points = scene.triangles if scene.lattice is None else scene.lattice.world
        side = Side.vertices() if side is None and target_height == 0 else side
    positions = _arrays.rows_of_triples(points, "points")
    _arrays.require_points(positions.reshape(-1, 3))
    if target_height != 0 and side is not None:
        raise ValueError("side: is for points on surfaces, with target_height=0")
    heights = _arrays.per_observer(height, len(places), "height")
    target_height = _arrays.number(target_height, "target_height")
    distances = _arrays.per_observer(np.inf if distance is None else distance, len(places), "distance")
    if (distances < 0).any():
        raise ValueError(f"distance: must not be below 0, and is {distance!r}")
    eyes = places + heights[:, None] * upwards if heights.any() else places
    targets = positions + target_height * upwards if target_height else positions
    if isinstance(side, VertexSide):
        bits = _at_vertices(scene, targets, eyes, side, progress)
    else:
        table = Lights.positions(eyes)
        found = scene.lit_by(targets, table, side=side, bits=True, progress=progress).bits
        assert found is not None
        bits = found.copy()
    if np.isfinite(distances).any():
        _clear_far(bits, positions, places, upwards, distances)
    counts = np.zeros(bits.shape[:-1], np.int64)
    for i in range(len(places)):
        counts += bits[..., i // 32] >> np.uint32(i % 32) & np.uint32(1)
    return VisibleFrom(counts, bits, len(places))


def _at_vertices(
    scene: Scene,
    points: NDArray[Any],
    eyes: NDArray[Any],
    side: VertexSide,
    progress: Callable[[float], object] | None,
) -> NDArray[np.uint32]:
    """Fans are decided one lamp at a time."""
    bits = np.zeros((*points.shape[:-1], (len(eyes) + 31) // 32), np.uint32)
    for i, eye in enumerate(eyes):
        is_seen = scene.lit(points, position=eye, side=side).values
        bits[..., i // 32] |= is_seen.astype(np.uint32) << np.uint32(i % 32)
        if progress is not None and progress((i + 1) / len(eyes)) is False:
            raise Cancelled("cancelled")
    return bits


def _clear_far(
    bits: NDArray[np.uint32],
    points: NDArray[Any],
    places: NDArray[Any],
    upwards: NDArray[np.float64],
    distances: NDArray[np.float64],
) -> None:
    """Clears the observers that are farther away than their distances, measured across `upwards`."""
    for i, (place, distance) in enumerate(zip(places, distances, strict=True)):
        apart = points.astype(np.float64) - place
        across = (apart**2).sum(axis=-1) - (apart @ upwards) ** 2
        bits[..., i // 32] &= ~((across > distance**2).astype(np.uint32) << np.uint32(i % 32))
