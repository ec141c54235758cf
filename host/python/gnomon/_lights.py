# SPDX-License-Identifier: MIT
"""Tables of lights with weights, and what a run over many lights finds for each point."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _arrays, _gnomon
from ._lattice import snapped_triple

NO_LIGHT = 0xFFFFFFFF


class LightsResult(NamedTuple):
    """What Scene.many_lights() finds; each array has the points' shape.

    sums: float64, the weights of the lights that reach the point, added without rounding and then rounded once.
    counts: int64, the number of these lights.
    first, last: int64, the smallest and the largest row of these lights; -1 where none reaches the point.
    bits: uint32 (..., ceil(M / 32)), or None unless asked for: light l is bit l % 32 of word l // 32.
    """

    sums: NDArray[np.float64]
    counts: NDArray[np.int64]
    first: NDArray[np.int64]
    last: NDArray[np.int64]
    bits: NDArray[np.uint32] | None

    def lit(self) -> NDArray[np.bool_]:
        """(..., M') bool, M' the number of lights rounded up to a multiple of 32: the bits, one per element."""
        if self.bits is None:
            raise ValueError("lit: call Scene.many_lights() with bits=True")
        as_bytes = self.bits.astype("<u4").view(np.uint8)
        return np.unpackbits(as_bytes, axis=-1, bitorder="little").astype(bool)


def lights_of(native: _gnomon.WorldLattice | None, directions: Any, positions: Any, weights: Any) -> _gnomon.Lights:
    if (directions is None) == (positions is None):
        raise ValueError("give either directions= (that the lights travel along) or positions= (of point lights)")
    name = "directions" if positions is None else "positions"
    rows = _arrays.rows_of_triples(directions if positions is None else positions, name)
    if rows.ndim != 2:
        raise ValueError(f"{name}: shape {rows.shape} is not (M, 3)")
    _arrays.require_finite(rows, name)
    xyzw = np.zeros((len(rows), 4), np.float32)
    if positions is None:
        with np.errstate(over="ignore"):
            xyzw[:, :3] = -rows.astype(np.float32)
        zero = _arrays.first_row((xyzw == 0).all(axis=1))
        if zero is not None:
            raise ValueError(f"directions: row {zero} {rows[zero].tolist()} is zero in float32")
        _arrays.require_finite(xyzw[:, :3], "directions")
    else:
        xyzw[:, 3] = 1
        for row, position in enumerate(rows):
            xyzw[row, :3] = snapped_triple(native, position, f"positions: row {row}")
    return _gnomon.Lights(xyzw, weights_of(weights, len(rows)))


def weights_of(weights: Any, count: int) -> NDArray[np.float32]:
    """One float32 per light; rounded once."""
    if weights is None:
        return np.ones(count, np.float32)
    values = _arrays.on_host(weights, "weights")
    if values.shape != (count,):
        raise ValueError(f"weights: shape {values.shape} is not ({count},), one per light")
    _arrays.require_real(values, "weights")
    with np.errstate(over="ignore"):
        rounded = np.ascontiguousarray(values, np.float32)
    row = _arrays.first_row(~np.isfinite(rounded))
    if row is not None:
        raise ValueError(f"weights: row {row} {values[row]} is not a finite float32")
    return rounded


def normals_for_cosines(normals: Any, shape: tuple[int, ...]) -> NDArray[np.float32]:
    """The normals as they are, rounded once: their lengths count."""
    if normals is None:
        raise ValueError("cosines: needs normals=")
    values = _arrays.rows_of_triples(normals, "normals")
    with np.errstate(over="ignore"):
        rounded = np.ascontiguousarray(np.broadcast_to(values, shape), np.float32).reshape(-1, 3)
    _arrays.require_finite(rounded, "normals")
    return rounded


def result_of(parts: list[tuple[Any, ...]], shape: tuple[int, ...], wants_bits: bool) -> LightsResult:
    sums, counts, first, last, bits = (np.concatenate([part[i] for part in parts]) for i in range(5))

    def rows(ids: NDArray[np.uint32]) -> NDArray[np.int64]:
        return np.where(ids == NO_LIGHT, -1, ids.astype(np.int64)).reshape(shape)

    return LightsResult(
        sums.reshape(shape),
        counts.astype(np.int64).reshape(shape),
        rows(first),
        rows(last),
        bits.reshape((*shape, bits.shape[-1])) if wants_bits else None,
    )
