# SPDX-License-Identifier: MIT
"""Rasters of heights: GeoTIFF files on one grid, read by windows through rasterio."""

from __future__ import annotations

import functools
import threading
from typing import Any, NamedTuple

import numpy as np
import rasterio
from numpy.typing import NDArray
from rasterio.windows import Window


class UnreadableError(OSError):
    """A part of the casters cannot be read."""


class UndeclaredNoDataError(ValueError):
    """A raster has a value that no ground has, and does not declare that it stands for no data."""


class _File(NamedTuple):
    name: str
    row: int  # its first cell's in the mosaic
    column: int
    rows: int
    columns: int


class Mosaic(NamedTuple):
    """Files of heights on one grid. Row 0 is the northernmost, column 0 the westernmost. x and y of a cell are those of
    its centre; they depend on its index in the mosaic alone, so no tile sees other coordinates than its neighbour.

    west, north: the outer corner of the mosaic. dx, dy: the size of a cell, both above 0.
    """

    files: tuple[_File, ...]
    west: float
    north: float
    dx: float
    dy: float
    rows: int
    columns: int
    crs: str | None

    def x(self, first: int, last: int) -> NDArray[np.float64]:
        return self.west + (np.arange(first, last, dtype=np.float64) + 0.5) * self.dx

    def y(self, first: int, last: int) -> NDArray[np.float64]:
        return self.north - (np.arange(first, last, dtype=np.float64) + 0.5) * self.dy

    def heights(self, row: int, last_row: int, column: int, last_column: int) -> NDArray[np.float64]:
        """(last_row - row, last_column - column) heights; NaN where there is no data. The window may leave the mosaic.
        Raises UnreadableError."""
        result = np.full((last_row - row, last_column - column), np.nan)
        for file in reversed(self.files):  # where files overlap the first one counts
            r0, r1 = max(row, file.row), min(last_row, file.row + file.rows)
            c0, c1 = max(column, file.column), min(last_column, file.column + file.columns)
            if r0 >= r1 or c0 >= c1:
                continue
            part = _read(file.name, r0 - file.row, c0 - file.column, r1 - r0, c1 - c0)
            window_part = result[r0 - row : r1 - row, c0 - column : c1 - column]
            window_part[...] = np.where(np.isnan(part), window_part, part)
        return result


@functools.lru_cache(maxsize=64)
def _opened(name: str, thread: int) -> Any:
    """An open file serves one thread."""
    return rasterio.open(name)


def _read(name: str, row: int, column: int, rows: int, columns: int) -> NDArray[np.float64]:
    try:
        data = _opened(name, threading.get_ident())
        masked = data.read(1, window=Window(column, row, columns, rows), masked=True)
        heights = np.ma.filled(masked.astype(np.float64), np.nan)
        if data.scales[0] != 1 or data.offsets[0] != 0:
            heights = heights * data.scales[0] + data.offsets[0]
    except (rasterio.errors.RasterioError, OSError, ValueError) as error:
        _opened.cache_clear()  # the next read opens the file again
        raise UnreadableError(f"{name}: cannot be read: {error}") from error
    heights[~np.isfinite(heights)] = np.nan
    _require_declared(masked, name, row, column)
    return heights


#: Heights that stand for no data wherever they occur.
NO_HEIGHTS = (-9999.0, -99999.0, -999999.0, -32768.0, -32767.0, 1e20, -1e20)


def _require_declared(masked: Any, name: str, row: int, column: int) -> None:
    """Values as they lie in the file, without its scale. The extremes of a type of 16 bits or more are no heights, nor
    is anything of 1e30 or more."""
    values, dtype = np.ma.getdata(masked), masked.dtype
    is_there = ~np.ma.getmaskarray(masked) & np.isfinite(values)
    if not is_there.any():
        return
    low, high = values[is_there].min(), values[is_there].max()
    if low > -9999 and high < 32767:
        return
    if dtype.kind in "iu":
        limits = np.iinfo(dtype)
        extremes = [n for n in (limits.min, limits.max) if n != 0 and dtype.itemsize > 1]
        is_wrong = np.isin(values, np.array([*extremes, *(n for n in NO_HEIGHTS if limits.min <= n <= limits.max)]))
    else:
        is_wrong = (np.abs(values) >= 1e30) | np.isin(values, np.array(NO_HEIGHTS, dtype))
    found = np.argwhere(is_wrong & is_there)
    if len(found):
        value = values[tuple(found[0])].item()
        _opened.cache_clear()  # the next read sees what is declared then
        raise UndeclaredNoDataError(
            f"{name}: the cell in row {row + found[0][0]}, column {column + found[0][1]} is {value:.9g}, which is no "
            f"height, and the file does not declare that it stands for no data: rio edit-info --nodata {value!r} {name}"
        )


def open_mosaic(names: tuple[str, ...]) -> Mosaic:
    """The mosaic of the files. Raises ValueError for files that share no grid, are rotated, or have a CRS that is not
    in metres."""
    opened = []
    for name in names:
        try:
            opened.append(rasterio.open(name))
        except rasterio.errors.RasterioError as error:
            raise ValueError(f"{name}: {error}") from None
    first = opened[0]
    grid = first.transform
    if grid.b or grid.d or grid.a <= 0 or grid.e >= 0:
        raise ValueError(f"{names[0]}: the raster is rotated or not north up: warp it first (rio warp, gdalwarp)")
    _require_metres(first.crs, names[0])
    placed = []
    for data, name in zip(opened, names, strict=True):
        other = data.transform
        column, row = (other.c - grid.c) / grid.a, (other.f - grid.f) / grid.e
        tolerance = 1e-3
        is_aligned = abs(column - round(column)) < tolerance and abs(row - round(row)) < tolerance
        if (
            (other.a, other.b, other.d, other.e) != (grid.a, 0.0, 0.0, grid.e)
            or not is_aligned
            or data.crs != first.crs
        ):
            raise ValueError(f"{name}: its grid or CRS is not that of {names[0]}: warp it onto that grid first")
        placed.append((name, round(row), round(column), data.height, data.width))
        data.close()
    top, left = min(p[1] for p in placed), min(p[2] for p in placed)
    return Mosaic(
        files=tuple(_File(p[0], p[1] - top, p[2] - left, p[3], p[4]) for p in placed),
        west=grid.c + left * grid.a,
        north=grid.f + top * grid.e,
        dx=grid.a,
        dy=-grid.e,
        rows=max(p[1] + p[3] for p in placed) - top,
        columns=max(p[2] + p[4] for p in placed) - left,
        crs=first.crs.to_wkt() if first.crs else None,
    )


def _require_metres(crs: Any, name: str) -> None:
    if crs is None:
        return
    if not crs.is_projected or abs(crs.linear_units_factor[1] - 1) > 1e-12:
        raise ValueError(
            f"{name}: its coordinates ({crs.to_string()[:40]}) are not metres on a map: warp it to a projected CRS, "
            "UTM or a national grid, first (rio warp --dst-crs EPSG:32632 ...)"
        )


def faces_of_grid(rows: int, columns: int) -> NDArray[np.int64]:
    """The triangles (F, 3) of a grid of vertices, row 0 in the north, counter-clockwise from above. The diagonal of
    each square runs from its south-west to its north-east corner."""
    north_west = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).reshape(-1)
    north_east, south_west, south_east = north_west + 1, north_west + columns, north_west + columns + 1
    return np.stack([south_west, south_east, north_east, south_west, north_east, north_west], axis=1).reshape(-1, 3)
