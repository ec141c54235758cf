# SPDX-License-Identifier: MIT
"""The folder of a study.

    study.json        the settings and the plan: the lattice, and hashes
    suns.npz          the table of suns; survey.npz the caster tiles; points.npy the receivers that are no raster
    results.zarr      lit, undecided, sun_hours, ...: the study's results
    partials.zarr     whole-number sums of each block of suns
    tasks/T-B.json    a task that is done: hashes of its chunks; tasks/T-sum.json: the sums of a tile
    record.json       versions, devices, hashes of all chunks

A task is a tile of receivers x a block of suns. It alone writes its chunks; the file of the task follows its chunks.
Files appear whole: each is written under another name and renamed.
"""

from __future__ import annotations

import datetime
import functools
import hashlib
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import zarr
from numpy.typing import NDArray

from .._files import write_whole
from .rasters import Mosaic
from .receivers import RasterReceivers, Receivers
from .settings import Settings
from .suns import Suns

RESULTS, PARTIALS = "results.zarr", "partials.zarr"


def sha256_of(data: bytes | memoryview) -> str:
    return hashlib.sha256(data).hexdigest()


def sha256_of_array(values: NDArray[Any]) -> str:
    """sha256 of the values in raster order, little-endian: it does not depend on chunks or on compression."""
    return sha256_of(np.ascontiguousarray(values, values.dtype.newbyteorder("<")).view(np.uint8).data)


@functools.lru_cache(maxsize=16)
def _sha256_of_zeros(size: int) -> str:
    return sha256_of(bytes(size))


class Store:
    """The arrays and files of a study's folder. Arrays are opened at their first use."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._arrays: dict[str, Any] = {}

    # ---- Arrays ------------------------------------------------------------------------------------------------------

    def array(self, name: str) -> Any:
        """`results.zarr/lit` and the like."""
        if name not in self._arrays:
            path, array = name.split("/")
            self._arrays[name] = zarr.open_array(str(self.folder / path / array), mode="r+")
        return self._arrays[name]

    def write(
        self, name: str, indices: tuple[Any, ...], values: NDArray[Any], chunk: tuple[int, ...]
    ) -> dict[str, Any]:
        """Writes one chunk; returns its entry for the task's file: hashes of the values and of the file, None for a
        chunk of zeros, which has no file."""
        array = self.array(name)
        if array.fill_value == 0 and not values.any():
            if self._file(name, chunk).exists():
                array[indices] = values  # zarr removes the file
            return {"data": _sha256_of_zeros(values.nbytes), "file": self.file_hash(name, chunk)}
        array[indices] = values
        return {"data": sha256_of_array(values), "file": self.file_hash(name, chunk)}

    def _file(self, name: str, chunk: tuple[int, ...]) -> Path:
        return self.folder / name / "c" / "/".join(map(str, chunk))

    def file_hash(self, name: str, chunk: tuple[int, ...]) -> str | None:
        try:
            return sha256_of(self._file(name, chunk).read_bytes())
        except FileNotFoundError:
            return None

    # ---- Tasks -------------------------------------------------------------------------------------------------------

    def done_path(self, tile: int, block: int | None) -> Path:
        return self.folder / "tasks" / f"{tile}-{'sum' if block is None else block}.json"

    def mark_done(self, tile: int, block: int | None, facts: Mapping[str, Any]) -> None:
        write_whole(self.done_path(tile, block), json.dumps(facts))

    def done(self, tile: int, block: int | None, plan: str) -> dict[str, Any] | None:
        """The facts of a task that is done under this plan; None if it is not."""
        try:
            facts = json.loads(self.done_path(tile, block).read_text())
        except (FileNotFoundError, json.JSONDecodeError):
            return None
        return facts if facts.get("plan") == plan else None

    def changed_chunks(self, facts: Mapping[str, Any]) -> list[str]:
        """The chunks of a done task whose files are not the ones that it wrote."""
        changed = []
        for key, entry in facts["chunks"].items():
            name, chunk = key.split("/c/")
            if self.file_hash(name, tuple(map(int, chunk.split("/")))) != entry["file"]:
                changed.append(key)
        return changed


def _dimensions(receivers: Receivers) -> tuple[str, ...]:
    return ("y", "x") if isinstance(receivers, RasterReceivers) else ("point",)


class Array(NamedTuple):
    """An empty array of a study. name: `results.zarr/lit` and the like. leading: names and sizes of the dimensions
    before those of the receivers."""

    name: str
    leading: tuple[tuple[str, int], ...]
    dtype: str
    fill: float
    attributes: dict[str, Any]


def create_arrays(
    folder: Path, title: str, receivers: Receivers, dims: tuple[str, ...], arrays: Iterable[Array]
) -> Any:
    """Makes the empty arrays, and replaces old ones; returns the group of results."""
    shape = receivers.shape
    chunk = tuple(min(c, n) for c, n in zip(receivers.chunk, shape, strict=True))
    groups = {name: zarr.open_group(str(folder / name), mode="w") for name in (RESULTS, PARTIALS)}
    groups[RESULTS].attrs["title"] = title
    for array in arrays:
        group, name = array.name.split("/")
        made = groups[group].create_array(
            name,
            shape=(*(n for _, n in array.leading), *shape),
            chunks=(*(1 for _ in array.leading), *chunk),
            dtype=array.dtype,
            fill_value=array.fill,
            dimension_names=[*(d for d, _ in array.leading), *dims],
        )
        made.attrs.update({"grid_mapping": "spatial_ref", **array.attributes})
    return groups[RESULTS]


def create_arrays_of_suns(
    folder: Path, settings: Settings, suns: Suns, receivers: Receivers, block_count: int, crs: str | None
) -> None:
    arrays = []
    if "bits" in settings.outputs:
        for name, text in (
            ("lit", "1: the sun is seen"),
            ("undecided", "1: it is not decided whether the sun is seen"),
        ):
            words = (("word", suns.word_count),)
            arrays.append(Array(f"{RESULTS}/{name}", words, "uint32", 0, {"long_name": f"packed bits, {text}"}))
    for output, name, long_name, units in (
        ("hours", "sun_hours", "hours of sun", "hours"),
        ("weights", "sum_of_weights", "sum of the weights of the suns that are seen", "1"),
        ("irradiation", "irradiation", "irradiation from the Sun and the sky", "kWh/m2"),
        ("direct", "direct", "irradiation from the Sun", "kWh/m2"),
        ("diffuse", "diffuse", "irradiation from the sky", "kWh/m2"),
    ):
        if output in settings.outputs:
            kind = "float32" if output == "hours" else "float64"
            text = "to add at most" if output == "hours" else "of the suns that are undecided"
            for array, words_of in ((name, long_name), (f"undecided_{output}", f"{long_name}, {text}")):
                attributes = {"long_name": words_of, "gnomon_units": units}
                arrays.append(Array(f"{RESULTS}/{array}", (), kind, np.nan, attributes))
            for part in ("lit", "undecided"):
                arrays.append(Array(f"{PARTIALS}/{part}_{output}", (("block", block_count),), "int64", 0, {}))
    results = create_arrays(folder, "Sun visibility by gnomon", receivers, _dimensions(receivers), arrays)
    _write_coordinates(results, settings, suns, receivers, crs)


def _put(results: Any, name: str, values: Any, dims: Iterable[str], **attributes: Any) -> None:
    array = results.create_array(name, data=np.asarray(values), dimension_names=list(dims))
    array.attrs.update(attributes)


def put_raster_coordinates(results: Any, mosaic: Mosaic, wkt: str | None) -> None:
    _put(results, "x", mosaic.x(0, mosaic.columns), ["x"], standard_name="projection_x_coordinate", units="m")
    _put(results, "y", mosaic.y(0, mosaic.rows), ["y"], standard_name="projection_y_coordinate", units="m")
    transform = f"{mosaic.west!r} {mosaic.dx!r} 0.0 {mosaic.north!r} 0.0 {-mosaic.dy!r}"
    attributes = {"GeoTransform": transform}
    if wkt:
        import pyproj

        wkt = pyproj.CRS.from_user_input(wkt).to_wkt()
        attributes |= {"crs_wkt": wkt, "spatial_ref": wkt}
    _put(results, "spatial_ref", np.int64(0), [], **attributes)


def _write_coordinates(results: Any, settings: Settings, suns: Suns, receivers: Receivers, crs: str | None) -> None:
    if isinstance(receivers, RasterReceivers):
        put_raster_coordinates(results, receivers.mosaic, settings.crs or crs)
    else:
        values = np.asarray(getattr(receivers, "values"))  # noqa: B009  # PointReceivers have it
        for axis, name in enumerate("xyz"):
            _put(results, name, values[:, axis], ["point"])
    if suns.is_hourly:
        _put(results, "month", np.arange(suns.word_count) // 24 + 1, ["word"])
        note = "local time; bit d - 1 of a word is day d"
        _put(results, "hour", np.arange(suns.word_count) % 24, ["word"], note=note)
    if suns.samples == 1:
        _put(results, "word_of_sun", suns.word, ["sun"])
        _put(results, "bit_of_sun", suns.bit, ["sun"])
    if suns.times:
        seconds = [round(datetime.datetime.fromisoformat(t).timestamp()) for t in suns.times]
        _put(results, "time", np.array(seconds, np.int64), ["time"], units="seconds since 1970-01-01",
             calendar="standard", note="the middle of each step, in UTC")  # fmt: skip
