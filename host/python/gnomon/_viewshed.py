# SPDX-License-Identifier: MIT
"""Viewsheds of rasters: which cells are seen from observers above the ground, decided exactly on the device."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _arrays, _gnomon
from ._devices import Device, device_of
from ._earth import EARTH_RADIUS, per_square_of

#: The part of the Earth's curvature that rays along the ground follow, as GDAL has it.
REFRACTION = 1 / 7
#: The finest step of heights, in metres.
FINEST = -10

_NONE = _gnomon.NO_HEIGHT
_SUBCELLS = _gnomon.SUBCELLS
_LIMIT = _gnomon.MAX_GRID_HEIGHT


class Viewshed(NamedTuple):
    """What M observers see of a raster; arrays have its shape (R, C), or (words, R, C).

    counts: uint32, the number of observers that see the cell; 0 where the raster has no data.
    undecided: uint32, the number of observers that may see it, depending on what stands where there is no data; 0
        unless viewshed() was given outside=.
    is_absent: bool, where the raster has no data.
    bits, undecided_bits: uint32 (ceil(M / 32), R, C), or None unless asked for: observer i is bit i % 32 of plane
        i // 32.
    observer_count: M.
    record: what was computed: refraction, radius, the step of heights, and by how much observers and heights moved.
    """

    counts: NDArray[np.uint32]
    undecided: NDArray[np.uint32]
    is_absent: NDArray[np.bool_]
    bits: NDArray[np.uint32] | None
    undecided_bits: NDArray[np.uint32] | None
    observer_count: int
    record: dict[str, Any]

    def seen(self) -> NDArray[np.bool_]:
        """(M, R, C): the bits, one per element."""
        if self.bits is None:
            raise ValueError("seen: call viewshed() with bits=True")
        planes = self.bits[:, None] >> np.arange(32, dtype=np.uint32)[None, :, None, None] & np.uint32(1)
        return planes.reshape(-1, *self.counts.shape)[: self.observer_count].astype(bool)


class _Axis(NamedTuple):
    """Centres of columns or rows: place i is first + i * step. is_turned: the caller's order is the other way round."""

    first: float
    step: float  # above 0 for columns, below 0 for rows: row 0 is in the north
    size: int
    is_turned: bool

    def places(self) -> NDArray[np.float64]:
        return np.asarray(self.first + self.step * np.arange(self.size), np.float64)


def _axis_of(values: Any, count: int, name: str, step: float) -> _Axis:
    """step: of cells without coordinates; its sign is that of the axis."""
    if values is None:
        return _Axis(0.0 if step > 0 else -step * (count - 1), step, count, False)
    given = _arrays.on_host(values, name)
    places = np.asarray(given, np.float64)
    if given.dtype.kind not in "iuf" or places.shape != (count,) or not np.isfinite(places).all():
        raise ValueError(f"{name}: must be {count} finite numbers, the centres of the raster's cells along {name}")
    own = (places[-1] - places[0]) / (count - 1)
    if own == 0 or np.abs(places - (places[0] + own * np.arange(count))).max() > 1e-3 * abs(own):
        raise ValueError(f"{name}: the cells' centres are not equally spaced")
    is_turned = (own > 0) != (step > 0)
    return _Axis(float(places[-1]), -own, count, True) if is_turned else _Axis(float(places[0]), own, count, False)


def _turned(values: NDArray[Any], rows: _Axis, columns: _Axis) -> NDArray[Any]:
    """The raster north up, or from there back in the caller's order."""
    return values[..., :: -1 if rows.is_turned else 1, :: -1 if columns.is_turned else 1]


class _Ground:
    """A raster, north up, in whole steps of heights below a common bending; and the same where nodata is filled."""

    def __init__(
        self, heights: NDArray[Any], rows: _Axis, columns: _Axis, per_square: float, lattice: float | None
    ) -> None:
        self.rows, self.columns = rows, columns
        x, y = columns.places(), rows.places()
        self._centre = (x[0] + x[-1]) / 2, (y[0] + y[-1]) / 2
        self._per_square = per_square
        low, high = _gnomon.range_of_heights(heights)
        if low > high:
            raise ValueError("heights: there is none")
        low -= float(self.drop(x[0], y[0]))  # the deepest
        self.exponent = _exponent_of(lattice, high - low)
        self.base = math.floor((low + high) / 2)
        self.steps = np.empty(heights.shape, np.int32)
        self.is_absent = np.empty(heights.shape, bool)
        across, along = (x - self._centre[0]) ** 2, (y - self._centre[1]) ** 2
        self.largest_move = _gnomon.round_heights(
            heights, self.base, per_square, across, along, self.exponent, self.steps, self.is_absent
        )

    def drop(self, x: Any, y: Any) -> Any:
        """The depth of the bending: the Earth's curvature less refraction around the raster's centre."""
        return self._per_square * ((x - self._centre[0]) ** 2 + (y - self._centre[1]) ** 2)

    def filled(self, outside: float) -> NDArray[np.int32]:
        """The steps, with `outside` where there is no data."""
        bent = outside - self.base - self.drop(self.columns.places()[None, :], self.rows.places()[:, None])
        steps = np.clip(np.ceil(np.ldexp(bent, -self.exponent)), 1 - _LIMIT, _LIMIT - 1)
        return np.where(self.is_absent, steps, self.steps).astype(np.int32)

    def eyes(self, observers: NDArray[np.float64], height: Any, target_height: Any) -> tuple[NDArray[np.int32], float]:
        """(M, 4) columns, rows, heights and targets' heights as the device takes them; and the largest distance, in
        cells, by which an observer moved."""
        above = _arrays.per_observer(height, len(observers), "height")
        below = _arrays.per_observer(target_height, len(observers), "target_height")
        rise, targets = (np.floor(np.ldexp(metres, -self.exponent) + 0.5) for metres in (above, below))
        for name, steps, least in (("height", rise, 1), ("target_height", targets, 0)):
            row = _arrays.first_row(np.asarray(~((steps >= least) & (steps < _LIMIT))))
            if row is not None:
                step = math.ldexp(1.0, self.exponent)
                lowest = f"at least a step of heights, {step:g}," if least else "at least 0"
                raise ValueError(f"{name}: must be {lowest} and below {_LIMIT * step:g}, and that of row {row} is not")
        places = np.stack([(observers[:, 0] - self.columns.first) / self.columns.step,
                           (observers[:, 1] - self.rows.first) / self.rows.step], axis=1)  # fmt: skip
        cells = np.floor(places * _SUBCELLS + 0.5)
        ends = np.array([self.columns.size - 1, self.rows.size - 1]) * _SUBCELLS
        is_over = np.asarray(((cells >= 0) & (cells <= ends)).all(axis=1))
        row = _arrays.first_row(~is_over)
        if row is not None:
            raise ValueError(f"observers: row {row} {observers[row].tolist()} does not stand on the raster, whose "
                             f"cells' centres reach from {self._corner(0)} to {self._corner(-1)}")  # fmt: skip
        moved = float(np.abs(cells / _SUBCELLS - places).max(initial=0))
        whole = cells.astype(np.int64)
        eye = self._ground_at(whole, observers) + rise.astype(np.int64)
        row = _arrays.first_row(eye >= _LIMIT)
        if row is not None:
            raise ValueError(f"height: an observer of row {row} is too high above the raster for this step of heights")
        return np.stack([*whole.T, eye, targets], axis=1).astype(np.int32), moved

    def _corner(self, at: int) -> list[float]:
        return [float(self.columns.places()[at]), float(self.rows.places()[at])]

    def _ground_at(self, cells: NDArray[np.int64], observers: NDArray[np.float64]) -> NDArray[np.int64]:
        """The height of the ground below places in sub-cells, on the triangle there, rounded up."""
        last = np.array([self.columns.size - 2, self.rows.size - 2])
        corner = np.minimum(cells // _SUBCELLS, last)
        f, g = (cells - corner * _SUBCELLS).T
        column, row = corner.T
        is_south = f + g > _SUBCELLS  # of the diagonal
        weights = np.where(
            is_south,
            np.stack([0 * f, _SUBCELLS - g, _SUBCELLS - f, f + g - _SUBCELLS]),
            np.stack([_SUBCELLS - f - g, f, g, 0 * f]),
        )
        corners = np.stack([self.steps[row + j, column + i] for j in (0, 1) for i in (0, 1)]).astype(np.int64)
        bad = _arrays.first_row(((corners == _NONE) & (weights != 0)).any(axis=0))
        if bad is not None:
            raise ValueError(f"observers: row {bad} {observers[bad].tolist()} stands where the raster has no data")
        result: NDArray[np.int64] = -(-(corners * weights).sum(axis=0) // _SUBCELLS)
        return result

    def spans(self, observers: NDArray[np.float64], distance: Any, band: tuple[int, int]) -> NDArray[np.int32]:
        """(M, R, 2): the first column of each row of a band within each observer's distance, and the one after the
        last."""
        count, rows = len(observers), band[1] - band[0]
        if distance is None:
            return np.broadcast_to(np.array([0, self.columns.size], np.int32), (count, rows, 2)).copy()
        reach = _arrays.per_observer(distance, count, "distance")[:, None]
        if (reach < 0).any():
            raise ValueError(f"distance: must be at least 0, not {reach.min():g}")
        across = self.rows.places()[None, slice(*band)] - observers[:, 1:2]
        half = np.sqrt(np.maximum(reach**2 - across**2, 0))
        x = self.columns.places()
        first = np.searchsorted(x, observers[:, :1] - half, "left")
        last = np.searchsorted(x, observers[:, :1] + half, "right")
        return np.stack([first, np.where(np.abs(across) <= reach, last, first)], axis=2).astype(np.int32)


def _exponent_of(lattice: float | None, extent: float) -> int:
    """The exponent of the step of heights: of a power of two, or the finest from 2^-10 m on that holds the extent."""
    if lattice is None:
        exponent = FINEST
        while extent / 2 + 1 > math.ldexp(_LIMIT / 2, exponent):
            exponent += 1
        return exponent
    exponent = _arrays.exponent_of_step(lattice)
    if extent / 2 + 1 > math.ldexp(_LIMIT / 2, exponent):
        raise ValueError(f"lattice: steps of {lattice:g} hold no heights that differ by {extent:g}: take larger ones")
    return exponent


def _checked(values: NDArray[Any], nodata: float | None) -> NDArray[Any]:
    """The heights as float32 or float64, NaN where they are `nodata`. Raises ValueError for a height that stands for no
    data."""
    if nodata is not None:
        is_there = values != nodata
        real = values.dtype if values.dtype.kind == "f" else np.dtype(np.float64)
        _arrays.require_heights(values, is_there, "nodata={}", True)
        return np.where(is_there, values, np.array(np.nan, real)).astype(_real_of(real), copy=False)
    if values.dtype in (np.float32, np.float64):
        low, high = _gnomon.range_of_heights(np.ascontiguousarray(values))
        if low > -99 and high < 9999:
            return values  # no height is one that stands for no data
    _arrays.require_heights(values, np.ones(values.shape, bool), "nodata={}")
    return values.astype(_real_of(values.dtype), copy=False)


def _real_of(dtype: np.dtype[Any]) -> type[np.float32] | type[np.float64]:
    """The type of floats that holds all values."""
    return np.float32 if dtype.kind == "f" and dtype.itemsize <= 4 else np.float64


def rounded_ground(
    heights: Any,
    *,
    x: Any = None,
    y: Any = None,
    cell: Any = None,
    nodata: float | None = None,
    refraction: float | None = REFRACTION,
    radius: float = EARTH_RADIUS,
    lattice: float | None = None,
    are_metres: bool = False,
) -> _Ground:
    """The raster of a ViewshedGrid, on the host. Raises ValueError with the argument's name."""
    if hasattr(heights, "dims") and hasattr(heights, "coords"):
        _require_plain(heights, cell)
    values = np.asarray(_arrays.on_host(heights, "heights"))
    side = _gnomon.MAX_GRID_SIDE
    if values.ndim != 2 or min(values.shape) < 2 or max(values.shape) > side:
        raise ValueError(f"heights: shape {values.shape} is not (R, C) of 2 to {side} each")
    _arrays.require_real(values, "heights")
    if (x is None) != (y is None) or (x is None) == (cell is None):
        raise ValueError("give either x= and y=, the centres of the cells, or cell=, their size")
    radius = _arrays.number(radius, "radius")
    refraction = None if refraction is None else _arrays.number(refraction, "refraction")
    nodata = nodata if nodata is None or nodata != nodata else _arrays.number(nodata, "nodata")
    if 6000 < radius < 7000:
        raise ValueError(f"radius: is in metres, and {radius:g} is the Earth's in km: give {1000 * radius:.0f}")
    if not radius > 0 or refraction is not None and not refraction < 1:
        raise ValueError(
            "radius, refraction: radius must be above 0 and refraction below 1, or None ('plane') for a plane"
        )
    width, depth = np.broadcast_to(np.asarray(1.0 if cell is None else cell, np.float64), (2,))
    if not (width > 0 and depth > 0):
        raise ValueError("cell: must be above 0")
    columns = _axis_of(x, values.shape[1], "x", float(width))
    rows = _axis_of(y, values.shape[0], "y", -float(depth))
    heights = np.ascontiguousarray(_turned(_checked(values, nodata), rows, columns))
    per_square = 0.0 if refraction is None else per_square_of(refraction, radius)
    ground = _Ground(heights, rows, columns, per_square, lattice)
    if not are_metres:
        _require_no_degrees(ground, heights)
    return ground


def _require_plain(dem: Any, cell: Any) -> None:
    """Of a DataArray: raises ValueError where it is no heights in metres, or has places that are not asked about."""
    _arrays.require_attributes_of_heights(dem)
    axes = [name for name in dem.dims if name in dem.coords]
    if cell is not None and axes:
        raise ValueError(
            f"heights: has coordinates of its own: give x=dem.{dem.dims[-1]}, y=dem.{dem.dims[0]} in place of cell=, "
            "or import gnomon.xarray, and take dem.gnomon.viewshed()"
        )


def _require_no_degrees(ground: _Ground, heights: NDArray[Any]) -> None:
    """Raises ValueError if the cells fit longitudes and latitudes, and must be degrees: they are below a centimetre, or
    at more than half of them the ground would rise by 100 times the way to the next cell."""
    x, y = ground.columns.places(), ground.rows.places()
    width, depth = ground.columns.step, -ground.rows.step
    if np.abs(x).max() > 361 or np.abs(y).max() > 91:
        return
    some = heights[:: 1 + heights.shape[0] // 512]
    rises = np.abs(np.diff(some, axis=1))
    rises = rises[np.isfinite(rises)]
    if min(width, depth) >= 0.01 and not (rises.size and (rises > 100 * width).mean() > 0.5):
        return
    raise ValueError(
        f"heights: the cells, {width:g} wide, look like degrees: warp the raster to a map in metres first, UTM or a "
        "national grid; if they are metres, say are_metres=True"
    )


class ViewshedGrid:
    """A raster on the device that is asked for several viewsheds: viewshed() has the arguments, and the rules.

    heights: (R, C), metres; NaN, infinite and masked cells have no data. x, y: (C,), (R,): the cells' centres, equally
    spaced, in either direction; or cell: the cells' size, a number or (width, depth), with row 0 in the north and the
    centre of the south-westernmost cell at 0, 0. are_metres: the cells are metres, however much they look like degrees.
    """

    def __init__(
        self,
        heights: Any,
        *,
        x: Any = None,
        y: Any = None,
        cell: Any = None,
        nodata: float | None = None,
        refraction: float | None = REFRACTION,
        radius: float = EARTH_RADIUS,
        lattice: float | None = None,
        are_metres: bool = False,
        device: str | Device | None = None,
    ) -> None:
        self._ground = rounded_ground(
            heights, x=x, y=y, cell=cell, nodata=nodata, refraction=refraction, radius=radius, lattice=lattice,
            are_metres=are_metres,
        )  # fmt: skip
        self._device = device_of(device)
        self._native = self._uploaded(self._ground.steps)
        self._filled = functools.lru_cache(maxsize=1)(lambda outside: self._uploaded(self._ground.filled(outside)))
        self.record: dict[str, Any] = {
            "refraction": refraction,
            "radius": None if refraction is None else radius,
            "step": math.ldexp(1.0, self._ground.exponent),
            "heights_moved_by": self._ground.largest_move,
        }

    def __reduce__(self) -> Any:
        raise TypeError("a gnomon.ViewshedGrid lies on its device and cannot be copied or pickled: make it from its "
                        "heights in the other process")  # fmt: skip

    @property
    def device(self) -> Device:
        """Where it lies."""
        return self._device

    @property
    def ground(self) -> _Ground:
        """The rounded raster, on the host."""
        return self._ground

    def _uploaded(self, steps: NDArray[np.int32]) -> Any:
        make = _gnomon.HeightGrid
        return self._device.call(make, self._device.native, np.ascontiguousarray(steps))

    def viewshed(
        self,
        observers: Any,
        *,
        height: Any = 2.0,
        target_height: Any = 0.0,
        distance: Any = None,
        outside: float | None = None,
        bits: bool = False,
        progress: Callable[[float], object] | None = None,
    ) -> Viewshed:
        """viewshed() of this raster."""
        places = _observers_of(observers)
        outside = None if outside is None else _arrays.number(outside, "outside")
        ground = self._ground
        rows = (0, ground.rows.size)
        found = self.band(rows, places, height, target_height, distance, outside=outside, bits=bits, progress=progress)
        arrays: list[Any] = [None if a is None else _turned(a, ground.rows, ground.columns) for a in found[:5]]
        return Viewshed._make([*arrays, found.observer_count, found.record])

    def band(
        self,
        rows: tuple[int, int],
        places: NDArray[np.float64],
        height: Any,
        target_height: Any,
        distance: Any,
        *,
        outside: float | None = None,
        bits: bool = False,
        progress: Callable[[float], object] | None = None,
    ) -> Viewshed:
        """viewshed() of some rows alone, counted from the north and in this order, the end exclusive: what it answers
        does not depend on them."""
        ground = self._ground
        eyes, moved = ground.eyes(places, height, target_height)
        spans = ground.spans(places, distance, rows)
        shape = (rows[1] - rows[0], ground.columns.size)

        def look(native: Any) -> tuple[NDArray[np.uint32], NDArray[np.uint32]]:
            if len(eyes) == 1 and progress is None:  # a byte a cell is read
                seen = self._device.call(native.look, eyes, rows, spans, True).reshape(shape)
                counts = seen.astype(np.uint32)  # 1: seen, 0: not
                return counts, counts[None].copy() if bits else np.empty((0, *shape), np.uint32)
            counts, words = self._device.call_reporting(native.look_from, progress, eyes, rows, spans, bits)
            return counts.reshape(shape), words.reshape(-1, *shape)

        counts, words = look(self._native)
        undecided, open_words = np.zeros(counts.shape, np.uint32), np.zeros(words.shape, np.uint32)
        absent = ground.is_absent[slice(*rows)]
        if outside is not None and ground.is_absent.any():
            certain, certain_words = look(self._filled(float(outside)))
            is_there = (~absent).astype(np.uint32)
            certain, certain_words = certain * is_there, certain_words * is_there
            undecided, open_words = counts - certain, words & ~certain_words
            counts, words = certain, certain_words
        record = {**self.record, "observers_moved_by_cells": moved, "outside": outside}
        return Viewshed(
            counts, undecided, absent, words if bits else None, open_words if bits else None, len(places), record
        )

    def least_heights(
        self, observer: Any, *, height: float = 2.0, target_height: float = 0.0, distance: float | None = None
    ) -> NDArray[np.float64]:
        """(R, C): the height above the ground from which each cell is seen by one observer, from target_height on: the
        least whole number of steps at which the cell is seen, by exact decisions. NaN where there is no data or beyond
        the distance; infinite above 2^31 steps."""
        places = _observers_of(observer)
        if len(places) != 1:
            raise ValueError(f"observer: shape {places.shape} is not (2,): least heights are those of one observer")
        ground = self._ground
        metres = self.band_of_least_heights((0, ground.rows.size), places, height, target_height, distance)
        return _turned(metres, ground.rows, ground.columns)

    def band_of_least_heights(
        self,
        rows: tuple[int, int],
        places: NDArray[np.float64],
        height: float,
        target_height: float,
        distance: float | None,
    ) -> NDArray[np.float64]:
        """least_heights() of some rows alone."""
        ground = self._ground
        eyes, _ = ground.eyes(places, height, target_height)
        spans = ground.spans(places, distance, rows)
        steps = self._device.call(self._native.least_heights, eyes, rows, spans).reshape(-1, ground.columns.size)
        metres = np.ldexp(steps.astype(np.float64), ground.exponent)
        metres[steps == _NONE] = np.nan
        metres[steps == np.iinfo(np.int32).max] = np.inf
        return metres


def _x_and_y_of(observers: Any) -> Any:
    """Of a table, a mapping or a Series the columns x and y, wherever they stand; other objects stay as they are."""
    is_one = isinstance(observers, dict) or hasattr(observers, "iloc") and not hasattr(observers, "columns")
    names = list(observers.keys()) if is_one else _arrays.names_of_columns(observers)
    if not names or not all(isinstance(one, str) for one in names):
        return observers
    heights = [one for one in names if one.strip().lower() in ("z", "height")]
    if heights:
        remedy = f"give observers=it[['x', 'y']], and height=it[{heights[0]!r}] if those are metres above the ground"
        raise ValueError(f"observers: the column {heights[0]!r} is not read: {remedy}")
    two = [one for axis in "xy" for one in names if one.strip().lower() == axis]
    if [one.strip().lower() for one in two] != ["x", "y"]:
        given = ", ".join(names)
        raise ValueError(f"observers: of the columns {given} two must be x, y, each once; or give an array (M, 2)")
    return np.stack([_arrays.on_host(observers[one], "observers") for one in two], axis=-1)


def _observers_of(observers: Any) -> NDArray[np.float64]:
    places = np.asarray(_arrays.on_host(_x_and_y_of(observers), "observers"))
    if places.ndim == 1:
        places = places[None]
    if not places.size:
        raise ValueError("observers: there is none")
    if places.ndim != 2 or places.shape[1] != 2:
        raise ValueError(f"observers: shape {places.shape} is not (M, 2), x and y of each observer")
    _arrays.require_real(places, "observers")
    _arrays.require_places(places, "observers")
    return places.astype(np.float64)


def viewshed(
    heights: Any,
    observers: Any,
    *,
    x: Any = None,
    y: Any = None,
    cell: Any = None,
    height: Any = 2.0,
    target_height: Any = 0.0,
    distance: Any = None,
    nodata: float | None = None,
    outside: float | None = None,
    refraction: float | None = REFRACTION,
    radius: float = EARTH_RADIUS,
    lattice: float | None = None,
    are_metres: bool = False,
    bits: bool = False,
    progress: Callable[[float], object] | None = None,
    device: str | Device | None = None,
) -> Viewshed:
    """Which cells of a raster each observer sees: what following each line of sight would answer in exact arithmetic.

    A raster's cells are vertices at their centres, four of them two triangles with the diagonal from south-west to
    north-east, as in gnomon.study(). A cell is seen if all of the open line between it and the observer's eye that lies
    over the ground is strictly above it.

    heights, x, y, cell, are_metres: the raster, in metres (ViewshedGrid). observers: (M, 2), x and y, rounded to 1/256
        of a cell. height: of eyes above the ground below them, which is rounded up; above 0. target_height: of what is
        looked at above the cells. distance: cells farther away (on the map) are not seen. Each a number, or one for
        each observer.
    nodata: a value of cells without data, beside NaN, masks and what a DataArray declares. Nothing stands there, unless
    outside: the greatest height of what may stand there. What is seen past it alone is then undecided.
    refraction: k: the ground sinks with the squared distance d by d^2 (1 - k) / 2 radius, 1/7 as GDAL has it; None: the
        ground is a plane. Bending around another place adds an affine function of x and y to all heights, which changes
        no answer: all observers share one raster.
    lattice: the step of heights, a power of two; None: 2^-10 m, or the finest that holds the raster. Heights are
        rounded to it once, after bending.
    bits: return each answer, too. progress: called with the part that is done; if it returns False, gnomon.Cancelled is
        raised.

    Returns a Viewshed. Raises ValueError with the argument's name and the first bad row, MemoryError,
    DeviceNotFoundError, Cancelled.
    """
    grid = ViewshedGrid(
        heights, x=x, y=y, cell=cell, nodata=nodata, refraction=refraction, radius=radius, lattice=lattice,
        are_metres=are_metres, device=device,
    )  # fmt: skip
    return grid.viewshed(
        observers, height=height, target_height=target_height, distance=distance, outside=outside, bits=bits,
        progress=progress,
    )  # fmt: skip
