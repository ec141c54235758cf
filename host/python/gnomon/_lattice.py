# SPDX-License-Identifier: MIT
"""World coordinates: float64 in, snapped once, exact from there on."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _arrays, _gnomon

#: Triangles whose plane snapping tilts by more than this many degrees are named in Lattice.tilted.
TILT_LIMIT = 1.0


class Lattice:
    """The world lattice of a scene: Scene.lattice. Every coordinate is a whole number of steps.

    step: of the lattice, a power of two, in the unit of the coordinates.
    origin: (3,) the lattice point that the stored float32 coordinates count from.
    largest_move: the largest distance by which a coordinate of a vertex was rounded, at most half a step.
    zero_area, turned_over, tilted: ids of the triangles that snapping left without area, turned over, or tilted by
        more than 1 degree. Points on them should be lifted (Scene.lit(lift=True)): their facing is then decided by the
        triangle before snapping.
    """

    def __init__(self, native: _gnomon.WorldLattice, world: NDArray[np.float64]) -> None:
        self.native = native
        self.world = world
        snapped, self.largest_move = native.snap(world.reshape(-1, 3))
        self.triangles = snapped.reshape(-1, 3, 3)
        self.zero_area, self.turned_over, self.tilted = _changes(world, self.triangles)

    @property
    def step(self) -> float:
        return self.native.step

    @property
    def origin(self) -> NDArray[np.float64]:
        return np.array(self.native.world_of((0.0, 0.0, 0.0)))

    def snap(self, values: NDArray[Any], name: str, normals: NDArray[np.float64] | None = None) -> NDArray[np.float32]:
        """Rows of coordinates relative to the origin; first lifted along the normals, if they are given."""
        return _snapped(self.native, np.ascontiguousarray(values, dtype=np.float64), name, normals)

    def __repr__(self) -> str:
        changed = len(self.zero_area) + len(self.turned_over) + len(self.tilted)
        note = f", {changed:,} triangles changed" if changed else ""
        step = f"2^{self.native.exponent} = {self.step:g}"
        return f"<gnomon.Lattice of step {step}, moved by at most {self.largest_move:g}{note}>"


def _snapped(
    native: _gnomon.WorldLattice, world: NDArray[np.float64], name: str, normals: NDArray[np.float64] | None = None
) -> NDArray[np.float32]:
    try:
        return native.snap(world)[0] if normals is None else native.lift(world, normals)
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
    x, y, z = _snapped(native, world_triple(value, name), name)[0]
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
        return Lattice(_gnomon.WorldLattice.fit(flat), world)
    fraction, exponent = math.frexp(step) if step > 0 and math.isfinite(step) else (0.0, 0)
    if fraction != 0.5:
        raise ValueError(f"lattice: the step {step!r} is not a power of two, such as 2**-10")
    try:
        return Lattice(_gnomon.WorldLattice.around(flat, exponent - 1), world)
    except ValueError as error:
        raise ValueError(f"lattice: {error}") from None


def normals_of_triangles(triangles: NDArray[Any]) -> NDArray[np.float64]:
    """Along which corners run counter-clockwise, of the length of twice the area."""
    corners = triangles.astype(np.float64)
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _changes(world: NDArray[np.float64], snapped: NDArray[np.float32]) -> tuple[NDArray[np.intp], ...]:
    before, after = normals_of_triangles(world), normals_of_triangles(snapped)
    lengths = np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
    along = (before * after).sum(axis=1)
    has_area = (before != 0).any(axis=1)
    zero = has_area & (after == 0).all(axis=1)
    turned = has_area & (along < 0)
    tilted = has_area & ~zero & ~turned & (along < math.cos(math.radians(TILT_LIMIT)) * lengths)
    return np.flatnonzero(zero), np.flatnonzero(turned), np.flatnonzero(tilted)
