# SPDX-License-Identifier: MIT
"""World coordinates: float64 coordinates are snapped once to a lattice, and are exact from there on."""

from __future__ import annotations

import functools
import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _arrays, _gnomon

#: Steps from the origin to each side that float32 holds.
REACH = 2.0**24
#: A lattice that a scene chose by itself is warned of if it moves vertices by more than this part of its triangles'
#: median size; so are eyes and lamps that float32 moves by more than VISIBLE x the scene's extent put on a lattice.
COARSE, VISIBLE = 2.0**-10, 2.0**-16
#: Triangles whose plane snapping tilts by more than this many degrees are named in Lattice.tilted.
TILT_LIMIT = 1.0


class Lattice:
    """The world lattice of a scene: Scene.lattice. Every coordinate is a whole number of steps.

    step: a power of two, in the unit of the coordinates.
    origin: (3,) the lattice point that the stored float32 coordinates count from.
    largest_move: the largest distance by which a coordinate of a vertex was rounded, at most half a step.
    largest_move_of_points: the same for the points of the last call, before any lift.
    zero_area, turned_over, tilted: ids of the triangles that snapping left without area, turned over, or tilted by
        more than 1 degree. Facing of points on them (Scene.lit with Side.front(), Side.eye() or lift=True) is decided
        by the triangle before snapping.
    touched: (F, 3) for each corner the nearest triangle that it touches without being its corner, -1 for none: a
        triangle within a step of the corner (a T-junction, a wall that stands on terrain, tiles of two triangulations).
        Found at the first use of the property, in some seconds for a million triangles.
    """

    def __init__(self, native: _gnomon.WorldLattice, world: NDArray[np.float64]) -> None:
        self.native = native
        self.world = world
        snapped, self.largest_move = native.snap(world.reshape(-1, 3))
        self.largest_move_of_points = 0.0
        self.triangles = snapped.reshape(-1, 3, 3)
        change = native.changes(world.reshape(-1, 9), TILT_LIMIT)
        self.is_changed: NDArray[np.bool_] = change != 0
        self.zero_area, self.turned_over, self.tilted = (np.flatnonzero(change == kind) for kind in (1, 2, 3))

    @property
    def step(self) -> float:
        return self.native.step

    @property
    def origin(self) -> NDArray[np.float64]:
        return np.array(self.native.world_of((0.0, 0.0, 0.0)))

    def snap(self, values: NDArray[Any], name: str, normals: NDArray[np.float64] | None = None) -> NDArray[np.float32]:
        """Rows of coordinates relative to the origin; first lifted along the normals, if they are given."""
        world = np.ascontiguousarray(values, dtype=np.float64)
        snapped, self.largest_move_of_points = _snapped(self.native, world, name)
        return snapped if normals is None else lifted(self.native, world, name, normals)

    @functools.cached_property
    def touched(self) -> NDArray[np.int64]:
        ids = self.native.touched_triangles(self.world.reshape(-1, 9))
        return np.where(ids == _arrays.NO_RECEIVER, -1, ids.astype(np.int64))

    def normals_where_touching(
        self, snapped: NDArray[np.float32], up: tuple[float, float, float] | None
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """The rows of snapped vertices that touch a triangle of which they are not a corner; and the normal of the
        triangle before snapping, on its front, or upwards."""
        triangle, corner = np.nonzero(self.touched >= 0)
        if triangle.size == 0:
            return np.empty(0, np.int64), np.empty((0, 3))
        normals = _arrays.scaled(normals_of_triangles(self.world[self.touched[triangle, corner]]))
        if up is not None:
            normals[normals @ np.array(up, np.float64) < 0] *= -1
        # Corners that become one may touch triangles of unlike normals: the choice does not depend on any order of ids.
        order = np.lexsort(normals.T)
        corners = self.triangles[triangle[order], corner[order]]
        _, found = np.unique(np.concatenate([corners, snapped]) + np.float32(0), axis=0, return_inverse=True)
        found = found.reshape(-1)
        normal_of = np.full(found.max() + 1, -1)
        normal_of[found[: len(corners)]] = order
        chosen = normal_of[found[len(corners) :]]
        rows = np.flatnonzero(chosen >= 0)
        return rows, normals[chosen[rows]]

    def __repr__(self) -> str:
        changed = len(self.zero_area) + len(self.turned_over) + len(self.tilted)
        note = f", {changed:,} triangles changed" if changed else ""
        step = f"2^{self.native.exponent} = {self.step:g}"
        return f"<gnomon.Lattice of step {step}, moved by at most {self.largest_move:g}{note}>"


class Reaching:
    """A lattice that a scene chose by itself, for which no point, lamp or eye is too far away: coordinates beyond its
    reach are rounded to float32, whose values there are multiples of a step. No surface of the scene is there."""

    def __init__(self, native: _gnomon.WorldLattice) -> None:
        self._native = native

    def __getattr__(self, name: str) -> Any:
        return getattr(self._native, name)

    def snap(self, world: NDArray[np.float64]) -> tuple[NDArray[np.float32], float]:
        relative = world - np.array(self._native.world_of((0.0, 0.0, 0.0)))
        is_far = (np.abs(relative) >= (REACH - 1) * self._native.step).any(axis=1)
        if not is_far.any():
            return self._native.snap(world)
        with np.errstate(over="ignore"):
            rounded = relative.astype(np.float32)
        if not np.isfinite(rounded[is_far]).all():
            return self._native.snap(world)  # which says what is wrong
        near, largest = self._native.snap(np.ascontiguousarray(world[~is_far]))
        rounded[~is_far] = near
        moved = np.abs(rounded[is_far].astype(np.float64) - relative[is_far])
        return rounded, max(largest, float(moved.max()))


def _snapped(native: _gnomon.WorldLattice, world: NDArray[np.float64], name: str) -> tuple[NDArray[np.float32], float]:
    try:
        snapped, largest_move = native.snap(world)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
    return snapped, largest_move


def lifted(
    native: _gnomon.WorldLattice, world: NDArray[np.float64], name: str, normals: NDArray[np.float64]
) -> NDArray[np.float32]:
    try:
        return native.lift(world, normals)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


def world_triple(value: Any, name: str) -> NDArray[np.float64]:
    """Three finite numbers as a row (1, 3)."""
    values = _arrays.on_host(value, name)
    _arrays.require_real(values, name)
    if values.shape != (3,) or not np.isfinite(values).all():
        raise ValueError(f"{name}: must be three finite numbers, not {value!r}")
    return values.astype(np.float64).reshape(1, 3)


def snapped_triple(native: _gnomon.WorldLattice | None, value: Any, name: str) -> tuple[float, float, float]:
    """Three numbers relative to the lattice's origin; without a lattice rounded once to float32."""
    if native is None:
        return _arrays.triple(value, name)
    x, y, z = _snapped(native, world_triple(value, name), name)[0][0]
    return float(x), float(y), float(z)


def light_of(native: _gnomon.WorldLattice | None, direction: Any, position: Any) -> tuple[float, float, float, float]:
    """The homogeneous light: minus the direction of travel with w = 0, or the snapped position with w = 1."""
    if (direction is None) == (position is None):
        raise ValueError("give either direction= (that the light travels along) or position= (of a point light)")
    if position is not None:
        return (*snapped_triple(native, position, "position"), 1.0)
    x, y, z = _arrays.triple(direction, "direction")
    if x == y == z == 0:
        raise ValueError("direction: must not be zero")
    return (-x, -y, -z, 0.0)


def lattice_of(world: NDArray[np.float64], step: float | None) -> Lattice:
    """The lattice with this step, a power of two; None: the finest that fits."""
    flat = world.reshape(-1, 3)
    if step is None:
        lattice = Lattice(_gnomon.WorldLattice.fit(flat), world)
        lattice.native = Reaching(lattice.native)  # type: ignore[assignment]
        return lattice
    exponent = _arrays.exponent_of_step(step)
    try:
        return Lattice(_gnomon.WorldLattice.around(flat, exponent), world)
    except ValueError as error:
        raise ValueError(f"lattice: {error}") from None


def warn_if_coarse(lattice: Lattice) -> None:
    """One triangle far away makes the step of all others coarse."""
    world = lattice.world
    if not len(world):
        return
    size = float(np.median((world.max(axis=1) - world.min(axis=1)).max(axis=1)))
    if lattice.largest_move <= COARSE * size:
        return
    away = np.abs(world - np.median(world.reshape(-1, 3), axis=0)).max(axis=(1, 2))
    row = int(away.argmax())
    warnings.warn(
        f"the scene's coordinates are rounded to steps of {lattice.step:g}, which moves vertices by up to "
        f"{lattice.largest_move:g}, while its triangles measure {size:g}: triangle {row}, {away[row]:g} away from the "
        "others, needs this step (leave it out, or give lattice=)",
        stacklevel=3,
    )


def moves_visibly(value: Any, extent: float) -> bool:
    """Whether float32 moves three coordinates by more than a scene of this extent can hide."""
    numbers = np.asarray(value)
    if numbers.shape != (3,) or numbers.dtype.kind not in "iuf" or not np.isfinite(numbers).all():
        return False  # the check that follows says it
    with np.errstate(over="ignore"):
        moved = np.abs(numbers.astype(np.float32).astype(np.float64) - numbers).max()
    return bool(VISIBLE * extent < moved < np.inf)


def normals_of_triangles(triangles: NDArray[Any]) -> NDArray[np.float64]:
    """Normals about which the corners run counter-clockwise; their length is twice the area."""
    corners = triangles.astype(np.float64)
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
