# SPDX-License-Identifier: MIT
"""gnomon-study viewshed: which cells of a raster of heights observers see, as a GeoTIFF."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import rasterio
from numpy.typing import NDArray

from .. import _gnomon
from .._earth import EARTH_RADIUS
from .._viewshed import REFRACTION, Viewshed, ViewshedGrid
from .rasters import Mosaic, open_mosaic
from .tables import read_observers

#: Bytes: what one observer sees, 255 and 0 as gdal_viewshed has them.
SEEN, UNDECIDED, HIDDEN, ABSENT = 255, 127, 0, 128
#: Heights: no data.
NO_HEIGHT = -9999.0
WHAT = ("seen", "counts", "heights")


class Request(NamedTuple):
    """What is asked of a raster: gnomon.viewshed() has the meanings. heights, distances: of each observer."""

    raster: tuple[str, ...]
    observers: NDArray[np.float64]
    heights: Any = 2.0
    target_height: float = 0.0
    distance: float | None = None
    refraction: float | None = REFRACTION
    radius: float = EARTH_RADIUS
    outside: float | None = None
    height_unit: str | None = None
    device: str | None = None


def observers_of(text: str) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    """(M, 2) places, and (M,) heights of eyes if the table has them. text: "x,y", or a .csv file with the columns x, y
    and perhaps height. Raises ValueError."""
    parts = text.split(",")
    if len(parts) == 2:
        try:
            return np.array([[float(part) for part in parts]]), None
        except ValueError:
            pass
    if not Path(text).exists():
        raise ValueError(f"observers: {text!r} is neither x,y, such as 691000,5334000, nor a file")
    return read_observers(text)


def _read(names: tuple[str, ...], height_unit: str | None) -> tuple[Mosaic, NDArray[np.float64]]:
    mosaic = open_mosaic(names, height_unit)
    side = _gnomon.MAX_GRID_SIDE
    if max(mosaic.rows, mosaic.columns) > side:
        raise ValueError(f"{names[0]}: {mosaic.columns} x {mosaic.rows} cells are more than {side} on a side: cut it "
                         "(rio clip), or take larger cells")  # fmt: skip
    return mosaic, mosaic.heights(0, mosaic.rows, 0, mosaic.columns)


def write_viewshed(
    path: Path, request: Request, what: str | None = None, progress: Callable[[float], object] | None = None
) -> dict[str, Any]:
    """Writes a GeoTIFF, and returns the record, which stands in its tag `gnomon`, too.

    what: "seen", of one observer: 255 seen, 0 hidden or beyond the distance, 127 undecided, 128 no data. "counts": the
    number of observers that see each cell, and in band 2 the number of those that may. "heights", of one observer: the
    height above the ground from which each cell is seen, in metres. None: "seen" for one observer, else "counts".
    """
    what = what or ("seen" if len(request.observers) == 1 else "counts")
    if what not in WHAT:
        raise ValueError(f"what: {what!r} is not {', '.join(WHAT)}")
    if what != "counts" and len(request.observers) != 1:
        raise ValueError(f"what: {what!r} is for one observer, and there are {len(request.observers)}")
    if what == "heights" and request.outside is not None:
        raise ValueError("outside: is not for heights")
    mosaic, heights = _read(request.raster, request.height_unit)
    grid = ViewshedGrid(
        heights, x=mosaic.x(0, mosaic.columns), y=mosaic.y(0, mosaic.rows), refraction=request.refraction,
        radius=request.radius, device=request.device,
    )  # fmt: skip
    bands, nodata, record = _answers(grid, request, what, progress)
    record |= {
        "what": what,
        "raster": list(request.raster),
        "observers": len(request.observers),
        "target_height": request.target_height,
        "distance": request.distance,
        "gnomon": _gnomon.__version__,  # type: ignore[attr-defined]
    }
    _write(path, mosaic, bands, nodata, record)
    return record


def _answers(
    grid: ViewshedGrid, request: Request, what: str, progress: Callable[[float], object] | None
) -> tuple[list[NDArray[Any]], float, dict[str, Any]]:
    """The bands, their value for no data, and the record."""
    if what == "heights":
        height = float(np.broadcast_to(request.heights, (1,))[0])
        least = grid.least_heights(
            request.observers[0], height=height, target_height=request.target_height, distance=request.distance
        )
        return [np.where(np.isnan(least), NO_HEIGHT, least).astype(np.float32)], NO_HEIGHT, dict(grid.record)
    found = grid.viewshed(
        request.observers, height=request.heights, target_height=request.target_height, distance=request.distance,
        outside=request.outside, progress=progress,
    )  # fmt: skip
    record = {
        **found.record,
        "cells": int((~found.is_absent).sum()),
        "seen": int(found.counts.sum()),
        "undecided": int(found.undecided.sum()),
    }
    if what == "seen":
        return [as_bytes(found)], ABSENT, record
    nodata = np.iinfo(np.uint32).max
    bands = [np.where(found.is_absent, nodata, b).astype(np.uint32) for b in (found.counts, found.undecided)]
    return bands, float(nodata), record


def as_bytes(found: Viewshed) -> NDArray[np.uint8]:
    """What one observer sees, as the bytes of a file."""
    answers = np.select([found.is_absent, found.undecided > 0, found.counts > 0], [ABSENT, UNDECIDED, SEEN], HIDDEN)
    return answers.astype(np.uint8)


def _write(path: Path, mosaic: Mosaic, bands: list[NDArray[Any]], nodata: float, record: dict[str, Any]) -> None:
    """The file appears whole."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=".gnomon-") as folder:
        new = Path(folder) / "viewshed.tif"
        with rasterio.open(
            new, "w", driver="GTiff", tiled=True, compress="DEFLATE", width=mosaic.columns, height=mosaic.rows,
            count=len(bands), dtype=bands[0].dtype, nodata=nodata, crs=mosaic.crs, BIGTIFF="IF_SAFER",
            transform=rasterio.Affine(mosaic.dx, 0, mosaic.west, 0, -mosaic.dy, mosaic.north),
        ) as file:  # fmt: skip
            for i, band in enumerate(bands):
                file.write(band, i + 1)
            file.update_tags(gnomon=json.dumps(record))
        os.replace(new, path)
