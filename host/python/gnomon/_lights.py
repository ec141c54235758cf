# SPDX-License-Identifier: MIT
"""Tables of lights with weights, and the results of a run over many lights."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _arrays, _gnomon
from ._lattice import snapped_triple

NO_LIGHT = 0xFFFFFFFF


@dataclass(frozen=True, eq=False)
class Lights:
    """A table of M lights, each with a weight. Make it by directions() or positions().

    weights: (M,) float32, negative ones too, but not -9999 or 9999 and their like, far from all others, which stand
        for no data in files; 1 each if not given. A weight is rounded once to a whole number times a power of two that
        depends on the largest weight and M alone, so that sums do not depend on any order.
    """

    rows: Any
    are_positions: bool
    weights: Any = None

    @staticmethod
    def directions(directions: Any, weights: Any = None) -> Lights:
        """(M, 3) along which lights travel, each rounded once to float32; a table may have their weights, too."""
        return Lights(directions, False, weights)

    @staticmethod
    def positions(positions: Any, weights: Any = None) -> Lights:
        """(M, 3) of point lights, in the scene's unit; a table may have their weights, too."""
        return Lights(positions, True, weights)


class LightsResult(NamedTuple):
    """The result of Scene.lit_by() for M lights; each array has the points' shape.

    sums: float64, the weights of the lights that reach the point, added without rounding and then rounded once.
    counts: int64, the number of these lights.
    first, last: int64, the smallest and the largest row of these lights; -1 where none reaches the point.
    bits: uint32 (..., ceil(M / 32)), or None unless asked for: light l is bit l % 32 of word l // 32.
    light_count: M.
    """

    sums: NDArray[np.float64]
    counts: NDArray[np.int64]
    first: NDArray[np.int64]
    last: NDArray[np.int64]
    bits: NDArray[np.uint32] | None
    light_count: int

    def lit(self) -> NDArray[np.bool_]:
        """(..., M) bool: the bits, one per element."""
        if self.bits is None:
            raise ValueError("lit: call Scene.lit_by() with bits=True")
        return _arrays.unpacked(self.bits, self.light_count)


def table_of(native: _gnomon.WorldLattice | None, lights: Lights) -> _gnomon.Lights:
    if not isinstance(lights, Lights):
        raise TypeError(f"lights: must be gnomon.Lights.directions() or .positions(), not {type(lights).__name__}")
    name = "positions" if lights.are_positions else "directions"
    rows = _arrays.rows_of_triples(lights.rows, name)
    if rows.ndim != 2:
        raise ValueError(f"{name}: shape {rows.shape} is not (M, 3)")
    _arrays.require_places(rows, name)
    xyzw = np.zeros((len(rows), 4), np.float32)
    if not lights.are_positions:
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
    weights = _weights_among(lights.rows, name) if lights.weights is None else lights.weights
    return _gnomon.Lights(xyzw, weights_of(weights, len(rows)))


def _weights_among(rows: Any, name: str) -> Any:
    """A table's column weight, as in tables of suns; None without it. Warns of weights under other names."""
    given = [one for one in _arrays.names_of_columns(rows) if one and not one[0].isdigit()]
    headings = _gnomon.NumberTable(",".join(f'"{one}"' for one in given).encode(), name, [], False)
    if "weight" in headings.names:
        return rows[given[headings.names.index("weight")]]
    if note := headings.unread_weights():
        warnings.warn(note, stacklevel=4)
    return None


def weights_of(weights: Any, count: int) -> NDArray[np.float32]:
    """(count,) float32, each rounded once; 1 each for None."""
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
    row = _gnomon.first_absent_weight(rounded.astype(np.float64))
    if row is not None:
        raise ValueError(
            f"weights: row {row} {values[row]} stands for no data in files: make it 0, or leave the light out"
        )
    return rounded


def normals_for_cosines(normals: Any, shape: tuple[int, ...]) -> NDArray[np.float32]:
    """The normals, each coordinate rounded once: their lengths count."""
    values = _arrays.rows_of_triples(normals, "normals")
    with np.errstate(over="ignore"):
        rounded = np.ascontiguousarray(np.broadcast_to(values, shape), np.float32).reshape(-1, 3)
    _arrays.require_places(rounded, "normals")
    return rounded


def result_of(parts: list[tuple[Any, ...]], shape: tuple[int, ...], wants_bits: bool, light_count: int) -> LightsResult:
    sums, counts, first, last, bits = (np.concatenate([part[i] for part in parts]) for i in range(5))

    def rows(ids: NDArray[np.uint32]) -> NDArray[np.int64]:
        return np.where(ids == NO_LIGHT, -1, ids.astype(np.int64)).reshape(shape)

    return LightsResult(
        sums.reshape(shape),
        counts.astype(np.int64).reshape(shape),
        rows(first),
        rows(last),
        bits.reshape((*shape, bits.shape[-1])) if wants_bits else None,
        light_count,
    )
