# SPDX-License-Identifier: MIT
"""Meshes that stand on the ground of a viewshed: a line of sight past the ground is a shadow ray to a lamp there."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _gnomon
from .._devices import Device
from .._lights import Lights
from .._scene import Scene
from .._viewshed import Viewshed, _Ground

#: Whole numbers that float32 holds.
REACH = 1 << 24
#: The finest parts of a cell that vertices are rounded to: 2^-16.
FINEST_PARTS = 16


class Obstacles:
    """Triangles in whole numbers, in which eyes and targets are exact: columns and rows in parts of a cell (a power of
    two, at least 256), heights in the ground's steps below its bending.

    triangles: (F, 3, 3) of these numbers. moved: the largest distance by which a vertex moved, in cells along the map
    and in metres along heights.
    """

    def __init__(self, ground: _Ground, triangles: NDArray[np.float64]) -> None:
        """triangles: (F, 3, 3) on the map, in metres, z up. Raises ValueError for one that lies too far away."""
        self._ground = ground
        side = max(ground.columns.size, ground.rows.size)
        self._parts = 1 << min(FINEST_PARTS, int(math.log2(REACH / 2 / side)))  # 2: a mesh may stand beside it
        x, y, z = np.moveaxis(triangles, 2, 0)
        rise = np.ldexp(z - ground.base - ground.drop(x, y), -ground.exponent)
        exact = np.stack([(x - ground.columns.first) / ground.columns.step * self._parts,
                          (y - ground.rows.first) / ground.rows.step * self._parts, rise], axis=2)  # fmt: skip
        whole = np.floor(exact + 0.5)
        bad = np.flatnonzero((np.abs(whole) >= REACH).any(axis=(1, 2)))
        if bad.size:
            raise ValueError(
                f"mesh: triangle {bad[0]} reaches {triangles[bad[0]].reshape(-1, 3)[0].tolist()}, too far from the "
                "raster for exact whole numbers: cut the mesh to the raster"
            )
        off = np.abs(whole - exact).reshape(-1, 3).max(axis=0, initial=0)
        self.moved = float(off[:2].max()) / self._parts, math.ldexp(float(off[2]), ground.exponent)
        self.triangles = whole.astype(np.int64)
        self._scene: Scene | None = None

    def eye(self, eye: NDArray[np.int32]) -> NDArray[np.int64]:
        """(..., 3) of eyes (..., 4) as the ground has them."""
        scale = self._parts // _gnomon.SUBCELLS
        return np.stack([eye[..., 0] * scale, eye[..., 1] * scale, eye[..., 2]], axis=-1).astype(np.int64)

    def target(self, row: Any, column: Any, above: int) -> NDArray[np.int64]:
        """(..., 3) of cells that have heights."""
        height = self._ground.steps[row, column].astype(np.int64) + above
        return np.stack([column * self._parts, row * self._parts, height], axis=-1).astype(np.int64)

    def past(self, found: Viewshed, eyes: NDArray[np.int32], first_row: int, device: Device) -> Viewshed:
        """What these eyes see past the ground, with bits, less what the triangles hide."""
        assert found.bits is not None and found.undecided_bits is not None
        rows, columns = np.nonzero((found.bits | found.undecided_bits).any(axis=0) & ~found.is_absent)
        free = np.zeros_like(found.bits)
        if len(rows):
            points = self._as_floats(self.target(rows + first_row, columns, int(eyes[0, 3])))
            lamps = Lights.positions(self._as_floats(self.eye(eyes)))
            bits = self._on(device).lit_by(points, lamps, bits=True).bits
            assert bits is not None
            free[:, rows, columns] = bits.T
        bits, undecided_bits = found.bits & free, found.undecided_bits & free
        counts, undecided = (np.bitwise_count(b).sum(axis=0, dtype=np.uint32) for b in (bits, undecided_bits))
        return found._replace(counts=counts, undecided=undecided, bits=bits, undecided_bits=undecided_bits)

    @staticmethod
    def _as_floats(values: NDArray[np.int64]) -> NDArray[np.float32]:
        if np.abs(values).max() >= REACH:
            raise ValueError("height, target_height: too high for exact whole numbers beside a mesh")
        return values.astype(np.float32)

    def _on(self, device: Device) -> Scene:
        if self._scene is None:
            self._scene = Scene(self.triangles.astype(np.float32), device=device)
        return self._scene
