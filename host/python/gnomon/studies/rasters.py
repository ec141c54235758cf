# SPDX-License-Identifier: MIT
"""Rasters of heights: GeoTIFF files on one grid, read by windows through rasterio."""

from __future__ import annotations

import functools
import os
import shlex
import threading
import warnings
from typing import Any, NamedTuple

import numpy as np
import rasterio
from numpy.typing import NDArray
from rasterio.windows import Window

from .. import _arrays
from .settings import Settings
from .units import horizontal, metres_of, metres_of_height, require_metres, utm_at


class UnreadableError(OSError):
    """A part of the casters cannot be read."""


class UndeclaredNoDataError(ValueError):
    """A raster or a mesh has a value that no ground has, and does not declare that it stands for no data."""


class _File(NamedTuple):
    name: str
    row: int  # its first cell's in the mosaic
    column: int
    rows: int
    columns: int
    unit: float  # metres of its heights' unit


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
    notes: tuple[str, ...]  # what of the files is left out

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
            if file.unit != 1:
                part = part * file.unit
            window_part = result[r0 - row : r1 - row, c0 - column : c1 - column]
            window_part[...] = np.where(np.isnan(part), window_part, part)
        return result


def stamp_of(name: str) -> tuple[int, int] | None:
    """Size and time of a file: one that is written again is another file. None for what is no file here (a URL)."""
    try:
        stat = os.stat(name)
    except OSError:
        return None
    return stat.st_size, stat.st_mtime_ns


@functools.lru_cache(maxsize=64)
def _opened(name: str, thread: int, stamp: tuple[int, int] | None) -> Any:
    """An open file serves one thread."""
    return rasterio.open(name)


def _read(name: str, row: int, column: int, rows: int, columns: int) -> NDArray[np.float64]:
    try:
        data = _opened(name, threading.get_ident(), stamp_of(name))
        masked = data.read(1, window=Window(column, row, columns, rows), masked=True)
        heights = np.ma.filled(masked.astype(np.float64), np.nan)
        if data.scales[0] != 1 or data.offsets[0] != 0:
            heights = heights * data.scales[0] + data.offsets[0]
    except (rasterio.errors.RasterioError, OSError, ValueError) as error:
        _opened.cache_clear()  # the next read opens the file again
        raise UnreadableError(f"{name}: cannot be read: {error.__cause__ or error}") from error
    heights[~np.isfinite(heights)] = np.nan
    _require_declared(masked, name, row, column, data.nodata is not None)
    return heights


def _require_declared(masked: Any, name: str, row: int, column: int, says_no_data: bool) -> None:
    """Values as they lie in the file, without its scale."""
    values = np.ma.getdata(masked)
    found = _arrays.first_no_height(values, ~np.ma.getmaskarray(masked), says_no_data)
    if found is not None:
        value = values[found].item()
        other = f"; if the ground lies there, rio edit-info --nodata {_unused_value(values.dtype)} {name}"
        _opened.cache_clear()  # the next read sees what is declared then
        raise UndeclaredNoDataError(
            f"{name}: the cell in row {row + found[0]}, column {column + found[1]} is {value:.9g}, which is no "
            f"height, and the file does not declare that it stands for no data: rio edit-info --nodata {value!r} {name}"
            + (other if -9999 < value < 0 else "")
        )


def open_mosaic(names: tuple[str, ...], height_unit: str | None = None) -> Mosaic:
    """The mosaic of the files. Raises ValueError for files that share no grid, are rotated, have a CRS that is not in
    metres, or heights in a unit that is not known."""
    opened = [_checked(name) for name in names]
    notes = tuple(
        f"{name}: has {data.count} bands, and the first is taken for heights"
        for name, data in zip(names, opened, strict=True)
        if data.count > 1
    )
    first = opened[0]
    grid = first.transform
    placed = []
    for data, name in zip(opened, names, strict=True):
        if data.crs != first.crs and not _is_same_map(data.crs, first.crs):
            raise ValueError(
                f"{name}: its CRS ({_name_of(data.crs)}) is not that of {names[0]} ({_name_of(first.crs)}): warp it "
                f"onto that grid first (rio warp IN.tif OUT.tif --like {names[0]}{_option_of_warp(data)})"
            )
        other = data.transform
        column, row = (other.c - grid.c) / grid.a, (other.f - grid.f) / grid.e
        shift = max(abs(column - round(column)), abs(row - round(row)))
        drift = max(abs(other.a - grid.a) / grid.a * data.width, abs(other.e - grid.e) / -grid.e * data.height)
        if max(shift, drift) >= 1e-2:  # cells
            raise ValueError(
                f"{name}: its grid (cells of {other.a!r} x {-other.e!r}, from {other.c!r}, {other.f!r} on) is not that "
                f"of {names[0]} ({grid.a!r} x {-grid.e!r}, from {grid.c!r}, {grid.f!r} on): warp it onto that grid "
                f"first (rio warp IN.tif OUT.tif --like {names[0]}{_option_of_warp(data)} covers that file's extent; "
                "gdalwarp -tap -tr any)"
            )
        unit = _unit_of(data, name, height_unit)
        placed.append((name, round(row), round(column), data.height, data.width, unit))
        data.close()
    top, left = min(p[1] for p in placed), min(p[2] for p in placed)
    return Mosaic(
        files=tuple(_File(p[0], p[1] - top, p[2] - left, *p[3:]) for p in placed),
        west=grid.c + left * grid.a,
        north=grid.f + top * grid.e,
        dx=grid.a,
        dy=-grid.e,
        rows=max(p[1] + p[3] for p in placed) - top,
        columns=max(p[2] + p[4] for p in placed) - left,
        crs=first.crs.to_wkt() if first.crs else None,
        notes=notes,
    )


def crs_of(settings: Settings) -> str | None:
    """The CRS of a study: that of its settings, or of its first raster."""
    if settings.crs is not None or not settings.raster:
        return settings.crs
    return _crs_of_file(settings.raster[0], stamp_of(settings.raster[0]))


@functools.lru_cache(maxsize=4)
def _crs_of_file(name: str, stamp: tuple[int, int] | None) -> str | None:
    with rasterio.open(name) as data:
        return data.crs.to_wkt() if data.crs else None


def _checked(name: str) -> Any:
    """An open file of heights, north up, on a map in metres. Raises ValueError."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", rasterio.errors.NotGeoreferencedWarning)  # it becomes an error below
            data = rasterio.open(name)
    except rasterio.errors.RasterioError as error:
        raise ValueError(f"{name}: GDAL cannot read it ({error}): write it as a GeoTIFF, and give that") from None
    if not data.count and data.subdatasets:
        inside = data.subdatasets
        raise ValueError(f"{name}: has {len(inside)} rasters in it: give one of them, such as {inside[0]!r}")
    grid = data.transform
    if grid == rasterio.Affine.identity():
        raise ValueError(
            f"{name}: has no place on a map (no geotransform{', only ground control points' if data.gcps[0] else ''}): "
            "give it its corners first (rio edit-info --transform, gdal_translate -a_ullr)"
        )
    if grid.b or grid.d or grid.a <= 0 or grid.e >= 0:
        raise ValueError(
            f"{name}: the raster is rotated or not north up (its transform is {tuple(grid)[:6]}): warp it first "
            + _how_to_warp(data)
        )
    if data.crs is not None:
        x, y = grid @ (data.width / 2, data.height / 2)
        require_metres(name, data.crs, x, y, _option_of_warp(data))
    interpretation = data.colorinterp[0].name
    if interpretation not in ("gray", "undefined") or np.dtype(data.dtypes[0]).kind == "c":
        raise ValueError(
            f"{name}: its first band is no band of heights ({interpretation}, {data.dtypes[0]}; {data.count} in all)"
        )
    if not (np.isfinite([data.scales[0], data.offsets[0]]).all() and data.scales[0]):
        raise ValueError(
            f"{name}: its values times its scale of {data.scales[0]:g} plus its offset of {data.offsets[0]:g} are no "
            f"heights: give it others, as in: with rasterio.open({name!r}, 'r+') as file: "
            f"file.scales, file.offsets = {(1.0,) * data.count}, {(0.0,) * data.count}"
        )
    if data.crs is None:
        _require_no_degrees(name, data)
    return data


def _require_no_degrees(name: str, data: Any) -> None:
    """Raises ValueError for a file without a CRS whose coordinates must be degrees: its box fits longitudes and
    latitudes, and its cells are smaller than a centimetre would be; or its heights, but for the lowest and highest
    twentieth, rise by more than the box's diagonal."""
    box = data.bounds
    if max(-box.left, box.right) > 361 or max(-box.bottom, box.top) > 91:
        return
    try:
        heights = data.read(1, masked=True, out_shape=(min(data.height, 256), min(data.width, 256))).compressed()
    except rasterio.errors.RasterioError:
        return  # the survey says so
    heights = heights[np.isfinite(heights)].astype(np.float64)
    rise = np.ptp(np.percentile(heights, [5, 95])) if heights.size else 0
    if max(data.res) >= 0.01 and rise <= np.hypot(*(np.array(box[2:]) - box[:2])):
        return
    raise ValueError(
        f"{name}: has no CRS, and its coordinates look like degrees (cells of {data.res[0]:g}, from {box.left:g}, "
        f"{box.top:g} on): say so (rio edit-info --crs EPSG:4326 {name}), or that they are metres "
        f'(rio edit-info --crs \'LOCAL_CS["site",UNIT["metre",1]]\' {name})'
    )


def _how_to_warp(data: Any) -> str:
    """North up: to its own CRS, from degrees to UTM."""
    if data.crs is None:
        return "(rio edit-info --crs says its CRS, then rio warp IN.tif OUT.tif --dst-crs with the same)"
    flat = horizontal(data.crs)
    to = f"EPSG:{utm_at(flat, *(data.transform @ (data.width / 2, data.height / 2)))}"
    if not flat.is_geographic:
        to = shlex.quote(data.crs.to_string())
        if data.transform.a < 0:  # rio would keep it
            (x0, x1), (y0, y1) = (sorted(data.bounds[i::2]) for i in (0, 1))
            to += f" --bounds {x0!r} {y0!r} {x1!r} {y1!r} --res {data.res[0]!r} --res {data.res[1]!r}"
    return f"(rio warp IN.tif OUT.tif --dst-crs {to}{_option_of_warp(data)})"


def _option_of_warp(data: Any) -> str:
    """What rio warp needs for a file that declares no nodata: without it, cells outside of the file have height 0."""
    return "" if data.nodata is not None else f" --src-nodata {_unused_value(np.dtype(data.dtypes[0]))}"


def _unused_value(dtype: np.dtype[Any]) -> Any:
    """A value of the type that is no height, for no data."""
    return {"i": lambda: np.iinfo(dtype).min, "u": lambda: np.iinfo(dtype).max}.get(dtype.kind, lambda: "nan")()


def _name_of(crs: Any) -> str:
    return "none" if crs is None else horizontal(crs).name


def _is_same_map(one: Any, other: Any) -> bool:
    return one is not None and other is not None and horizontal(one).equals(horizontal(other), ignore_axis_order=True)


def _unit_of(data: Any, name: str, height_unit: str | None) -> float:
    """The metres of the heights' unit: that of the settings, of the band, or of the CRS's heights."""
    declared = height_unit if height_unit is not None else data.units[0] or _unit_in_tags(data)
    if height_unit is None:
        tags = data.tags(1)
        what = tags.get("standard_name", "")
        is_rain = not what and declared == "mm" and "NETCDF_VARNAME" in tags
        if is_rain or not _arrays.is_of_heights(what):
            raise ValueError(
                f"{name}: its values are {f'{what!r} (standard_name)' if what else 'in mm, as rain is'}, and no "
                f"heights; if they are, give height_unit={declared or 'metre'!r}"
            )
    try:
        metres = metres_of_height(data.crs)
    except ValueError as error:
        remedy = "negate it (gdal_calc.py -A IN.tif --calc=-A), with a CRS of heights"
        raise ValueError(f"{name}: {error}: {remedy}") from None
    if declared is None:
        return 1.0 if metres is None else metres
    known = metres_of(declared)
    if known is None:
        raise ValueError(
            f'{name}: its heights are in "{declared}", a unit that is not known: give height_unit=, such as "metre", '
            '"foot", "US survey foot" or "centimetre"'
        )
    return known


def _unit_in_tags(data: Any) -> str | None:
    """The first band's unit as metadata have it that GDAL does not take for the band's own; None if none has a unit of
    length."""
    tags = {key.lower(): value for key, value in (data.tags() | data.tags(1)).items()}
    names = ("units", "unit", "unittype", "unit_type", "vertical_units", "z_units")
    return next((tags[key] for key in names if key in tags and metres_of(tags[key]) is not None), None)


def faces_of_grid(rows: int, columns: int) -> NDArray[np.int64]:
    """The triangles (F, 3) of a grid of vertices, row 0 in the north, counter-clockwise from above. The diagonal of
    each square runs from its south-west to its north-east corner."""
    north_west = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).reshape(-1)
    north_east, south_west, south_east = north_west + 1, north_west + columns, north_west + columns + 1
    return np.stack([south_west, south_east, north_east, south_west, north_east, north_west], axis=1).reshape(-1, 3)
