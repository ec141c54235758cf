# SPDX-License-Identifier: MIT
"""A viewshed as a study: tiles of rows x blocks of observers. Each task has the whole raster as its ground."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import json
import threading
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _gnomon
from .._earth import EARTH_RADIUS
from .._viewshed import REFRACTION, Viewshed, ViewshedGrid, rounded_ground
from .exact_lines import is_met, is_seen
from .meshes import study_triangles
from .obstacles import Obstacles
from .rasters import Mosaic, open_mosaic, stamp_of
from .receivers import Receivers
from .store import Array, Store, create_arrays, put_raster_coordinates, write_whole
from .tiled import TiledPlan

OUTPUTS = ("bits", "counts", "heights")
#: Cells of a tile: one takes some tenths of a second an observer.
CELLS = 1 << 24
NO_COUNT = np.iinfo(np.uint32).max
_NONE = _gnomon.NO_HEIGHT


@dataclasses.dataclass(frozen=True)
class ViewshedSettings:
    """What is asked of a raster: gnomon.viewshed() has the meanings. observers: x, y and the height of the eye of each.
    outputs: any of "bits", "counts" and, of one observer, "heights". tile: rows of a tile; None: as many as have 2^24
    cells. block: observers of a task, a multiple of 32. Neither changes an answer. meshes: files of what stands on the
    raster; mesh_up, mesh_offset: as in a study's Settings."""

    raster: tuple[str, ...]
    observers: tuple[tuple[float, float, float], ...]
    target_height: float = 0.0
    distance: float | None = None
    refraction: float | None = REFRACTION
    radius: float = EARTH_RADIUS
    outside: float | None = None
    height_unit: str | None = None
    outputs: tuple[str, ...] = ("bits",)
    tile: int | None = None
    block: int = 128
    meshes: tuple[str, ...] = ()
    mesh_up: str | None = None
    mesh_offset: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        if not self.observers:
            raise ValueError("observers: there is none")
        if not self.outputs or {*self.outputs} - {*OUTPUTS}:
            raise ValueError(f"outputs: {self.outputs}: must be any of {', '.join(OUTPUTS)}")
        if "heights" in self.outputs and len(self.observers) != 1:
            raise ValueError(f"outputs: 'heights' is for one observer, and there are {len(self.observers)}")
        if "heights" in self.outputs and self.outside is not None:
            raise ValueError("outside: is not for heights")
        if "heights" in self.outputs and self.meshes:
            raise ValueError("mesh: is not for heights: a cell may be seen from below a bridge, and not from above it")
        if self.tile is not None and self.tile < 1:
            raise ValueError(f"tile: {self.tile} rows: must be at least 1")
        if self.block < 1 or self.block % 32:
            raise ValueError(f"block: {self.block} observers: must be a multiple of 32")

    def as_json(self) -> str:
        return json.dumps(dataclasses.asdict(self))

    @classmethod
    def from_json(cls, values: dict[str, Any]) -> ViewshedSettings:
        fields: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in values.items()}
        fields["observers"] = tuple(tuple(row) for row in fields["observers"])
        return cls(**fields)


class BandsOfRows(Receivers):
    """The cells of a raster, by tiles of whole rows."""

    def __init__(self, mosaic: Mosaic, rows: int | None) -> None:
        self.mosaic = mosaic
        self.shape = (mosaic.rows, mosaic.columns)
        self.chunk = (min(rows or max(CELLS // mosaic.columns, 16), mosaic.rows), mosaic.columns)


class ViewshedPlan(TiledPlan):
    """The settings, tiles and blocks of a viewshed; its raster lies on the device from the first task on."""

    def __init__(self, folder: Path, facts: dict[str, Any], device: str | None = None) -> None:
        self.folder = folder
        self.facts = facts
        self.settings = ViewshedSettings.from_json(facts["settings"])
        self.hash = str(facts["hash"])
        self.mosaic = open_mosaic(self.settings.raster, self.settings.height_unit)
        self.receivers = BandsOfRows(self.mosaic, self.settings.tile)
        rows = np.array(self.settings.observers)
        self.places, self.heights = rows[:, :2], rows[:, 2]
        self.blocks = [slice(i, i + self.settings.block) for i in range(0, len(rows), self.settings.block)]
        self.store = Store(folder)
        names = {"bits": ["seen", "undecided"], "counts": ["counts", "undecided_counts"], "heights": ["least_heights"]}
        self.results = [name for output in self.settings.outputs for name in names[output]]
        self.has_sums = "counts" in self.settings.outputs
        self._device = device
        self._lock, self._lock_of_meshes = threading.Lock(), threading.Lock()

    @functools.cached_property
    def _grid(self) -> ViewshedGrid:
        s, m = self.settings, self.mosaic
        return ViewshedGrid(
            m.heights(0, m.rows, 0, m.columns), x=m.x(0, m.columns), y=m.y(0, m.rows), refraction=s.refraction,
            radius=s.radius, are_metres=True, device=self._device,
        )  # fmt: skip

    @property
    def grid(self) -> ViewshedGrid:
        with self._lock:  # the threads of a process share it
            return self._grid

    @functools.cached_property
    def _obstacles(self) -> Obstacles | None:
        return _obstacles_of(self.settings, self.mosaic, self.grid.ground)

    def look(self, band: tuple[int, int], of: slice, bits: bool = False) -> Viewshed:
        """What some observers see of some rows."""
        s, places, heights = self.settings, self.places[of], self.heights[of]
        with self._lock_of_meshes:
            obstacles = self._obstacles
        found = self.grid.band(
            band, places, heights, s.target_height, s.distance, outside=s.outside,
            bits=bits or obstacles is not None,
        )  # fmt: skip
        if obstacles is None:
            return found
        eyes, _ = self.grid.ground.eyes(places, heights, s.target_height)
        return obstacles.past(found, eyes, band[0], self.grid.device)

    @property
    def device_name(self) -> str:
        return repr(self.grid.device)

    def size_of_block(self, block: int) -> int:
        return len(self.places[self.blocks[block]])

    def own_record(self, unread: list[int]) -> dict[str, Any]:
        s = self.settings
        return self.facts["ground"] | {
            "refraction": s.refraction,
            "radius": None if s.refraction is None else s.radius,
            "target_height": s.target_height,
            "distance": s.distance,
            "outside": s.outside,
            "observers": len(s.observers),
            "diagonal_of_cells": "from south-west to north-east",
            "where_there_is_no_data": "nothing stands" if s.outside is None else f"at most {s.outside} m",
        }

    def compute(self, tile: int, block: int) -> tuple[dict[str, tuple[int, NDArray[Any]]], dict[str, Any]]:
        """The values that a task writes, by name (`array@leading index`), with the leading index; and facts for its
        file."""
        s, of = self.settings, self.blocks[block]
        rows = self.receivers.slices(tile)[0]
        band, places, heights = (rows.start, rows.stop), self.places[of], self.heights[of]
        values: dict[str, tuple[int, NDArray[Any]]] = {}
        facts = {"decisions": 0, "seen": 0, "undecided": 0, "unread": []}
        if "heights" in s.outputs:
            least = self.grid.band_of_least_heights(band, places, heights, s.target_height, s.distance)
            values["results.zarr/least_heights@0"] = (0, least)
            facts["decisions"] = int(np.isfinite(least).sum())
        if s.outputs == ("heights",):
            return values, facts
        found = self.look(band, of, bits="bits" in s.outputs)
        facts |= {"decisions": int((~found.is_absent).sum()) * len(places), "seen": int(found.counts.sum()),
                  "undecided": int(found.undecided.sum())}  # fmt: skip
        if "bits" in s.outputs and found.bits is not None and found.undecided_bits is not None:
            for i, planes in enumerate(zip(found.bits, found.undecided_bits, strict=True)):
                word = of.start // 32 + i
                for name, plane in zip(("seen", "undecided"), planes, strict=True):
                    values[f"results.zarr/{name}@{word}"] = (word, plane)
        if "counts" in s.outputs:
            for name, counts in (("counts", found.counts), ("undecided_counts", found.undecided)):
                values[f"partials.zarr/{name}@{block}"] = (block, counts.astype(np.uint16))
        return values, facts

    def wrong_lines(self, tiles: list[int], count: int, random: np.random.Generator) -> tuple[int, list[str]]:
        """Follows a sample of lines of sight to cells of these tiles, each second one to a cell that is seen, in
        rational arithmetic: how many, and those whose answers differ."""
        ground, s, followed = self.grid.ground, self.settings, 0
        wrong: list[str] = []
        steps = ground.steps if s.outside is None else ground.filled(s.outside)
        for _ in range(20 * count):  # many an observer sees nothing of a row, for the distance
            if followed == count:
                break
            rows, observer = self.receivers.slices(int(random.choice(tiles)))[0], int(random.integers(len(self.places)))
            row, place = int(random.integers(rows.start, rows.stop)), self.places[observer : observer + 1]
            height, band = self.heights[observer : observer + 1], (row, row + 1)
            eyes, _ = ground.eyes(place, height, s.target_height)
            first, last = ground.spans(place, s.distance, band)[0, 0]
            columns = np.arange(first, last)[~ground.is_absent[row, first:last]]
            answers = self._row(row, observer)[columns]
            chosen = columns[answers > 0] if followed % 2 and (answers > 0).any() else columns
            if not len(chosen):
                continue
            column = int(random.choice(chosen))
            x, y, top, above = (int(v) for v in eyes[0])
            stated = float(answers[np.flatnonzero(columns == column)[0]])
            if "heights" in s.outputs:
                above = round(stated / 2.0**ground.exponent)
                lower = above > int(eyes[0, 3]) and is_seen(steps, _NONE, (x, y, top, above - 1), (row, column))
                is_right = not lower and is_seen(steps, _NONE, (x, y, top, above), (row, column))
            else:
                truth = is_seen(steps, _NONE, (x, y, top, above), (row, column))
                if truth and self._obstacles is not None:
                    ends = self._obstacles.eye(eyes[0]), self._obstacles.target(row, column, above)
                    truth = not is_met(self._obstacles.triangles, *ends)
                is_right = truth == (stated > 0)
            followed += 1
            if not is_right:
                wrong.append(f"observer {observer}, row {row}, column {column}")
        return followed, wrong

    def _row(self, row: int, observer: int) -> NDArray[Any]:
        """What one observer sees of a row, or the heights from which it is seen, as they are stored; where counts alone
        are, as they are decided now."""
        if "heights" in self.settings.outputs:
            stored: NDArray[Any] = self.store.array("results.zarr/least_heights")[0, row]
            return stored
        if "bits" in self.settings.outputs:
            word: NDArray[Any] = self.store.array("results.zarr/seen")[observer // 32, row]
            return word >> np.uint32(observer % 32) & np.uint32(1)
        return self.look((row, row + 1), slice(observer, observer + 1)).counts[0]

    def is_absent(self, tile: int) -> NDArray[np.bool_]:
        rows = self.receivers.slices(tile)[0]
        return np.isnan(self.mosaic.heights(rows.start, rows.stop, 0, self.mosaic.columns))

    def sums(self, tile: int) -> dict[str, NDArray[np.uint32]]:
        """The numbers of observers that see each cell of a tile, and of those that may."""
        slices, is_absent = self.receivers.slices(tile), self.is_absent(tile)
        result = {}
        for name in ("counts", "undecided_counts"):
            partial = self.store.array(f"partials.zarr/{name}")
            total = np.zeros(is_absent.shape, np.uint32)
            for block in range(len(self.blocks)):
                total += partial[(block, *slices)]
            total[is_absent] = NO_COUNT
            result[name] = total
        return result


def viewshed_plan(folder: Path, settings: ViewshedSettings, restart: bool = False) -> ViewshedPlan:
    """The plan of these settings in the folder, which is made if the folder has none. Raises ValueError if the folder
    holds another one, or a raster has changed since."""
    known = folder / "study.json"
    stamps = {name: list(stamp_of(name) or ()) for name in (*settings.raster, *settings.meshes)}
    if known.exists() and not restart:
        facts = json.loads(known.read_text())
        if ViewshedSettings.from_json(facts["settings"]) != settings:
            raise ValueError(f"{folder}: holds a study with other settings: choose another folder, or give restart")
        if facts["stamps"] != stamps:
            raise ValueError(
                f"{folder}: a raster or mesh has changed since it began: choose another folder, or give restart"
            )
        return ViewshedPlan(folder, facts)
    facts = {"kind": "viewshed", "settings": json.loads(settings.as_json()), "stamps": stamps,
             "ground": _ground_of(settings)}  # fmt: skip
    facts["hash"] = hashlib.sha256(json.dumps(facts, sort_keys=True).encode()).hexdigest()
    (folder / "tasks").mkdir(parents=True, exist_ok=True)
    known.unlink(missing_ok=True)
    for old in (folder / "tasks").iterdir():
        old.unlink()
    plan = ViewshedPlan(folder, facts)
    _create_arrays(plan)
    write_whole(known, json.dumps(facts))
    return plan


def _ground_of(s: ViewshedSettings) -> dict[str, Any]:
    """How raster and observers are rounded, which no task changes. Raises ValueError."""
    mosaic = open_mosaic(s.raster, s.height_unit)
    side = _gnomon.MAX_GRID_SIDE
    if max(mosaic.rows, mosaic.columns) > side:
        raise ValueError(f"{s.raster[0]}: {mosaic.columns} x {mosaic.rows} cells are more than {side} on a side: cut "
                         "it (rio clip), or take larger cells")  # fmt: skip
    ground = rounded_ground(
        mosaic.heights(0, mosaic.rows, 0, mosaic.columns), x=mosaic.x(0, mosaic.columns), y=mosaic.y(0, mosaic.rows),
        refraction=s.refraction, radius=s.radius, are_metres=True,
    )  # fmt: skip
    rows = np.array(s.observers)
    _, moved = ground.eyes(rows[:, :2], rows[:, 2], s.target_height)
    ground.spans(rows[:1, :2], s.distance, (0, 1))
    facts = {"step": 2.0**ground.exponent, "heights_moved_by": ground.largest_move, "observers_moved_by_cells": moved,
             "cells": int((~ground.is_absent).sum())}  # fmt: skip
    obstacles = _obstacles_of(s, mosaic, ground)
    if obstacles is not None:
        facts |= {"mesh_triangles": len(obstacles.triangles), "meshes_moved_by_cells": obstacles.moved[0],
                  "meshes_moved_by": obstacles.moved[1]}  # fmt: skip
    return facts


def _obstacles_of(s: ViewshedSettings, mosaic: Mosaic, ground: Any) -> Obstacles | None:
    if not s.meshes:
        return None
    files = [study_triangles(name, s.mesh_up, s.mesh_offset, mosaic.crs) for name in s.meshes]
    for name, file in zip(s.meshes, files, strict=True):
        for note in file.notes:
            warnings.warn(f"{name}: {note}", stacklevel=2)
    return Obstacles(ground, np.concatenate([file.triangles for file in files]))


def _create_arrays(plan: ViewshedPlan) -> None:
    words, blocks = ("word", -(-len(plan.places) // 32)), ("block", len(plan.blocks))
    arrays = []
    if "bits" in plan.settings.outputs:
        arrays += [Array(f"results.zarr/{name}", (words,), "uint32", 0, {"long_name": f"packed bits, {text}"})
                   for name, text in (("seen", "1: the observer sees the cell"),
                                      ("undecided", "1: it is not decided whether the observer sees it"))]  # fmt: skip
    if "counts" in plan.settings.outputs:
        for name, text in (("counts", "observers that see it"), ("undecided_counts", "observers that may see it")):
            arrays.append(Array(f"results.zarr/{name}", (), "uint32", int(NO_COUNT), {"long_name": text}))
            arrays.append(Array(f"partials.zarr/{name}", (blocks,), "uint16", 0, {}))
    if "heights" in plan.settings.outputs:
        attributes = {"long_name": "height above the ground from which the cell is seen", "gnomon_units": "m"}
        arrays.append(Array("results.zarr/least_heights", (("observer", 1),), "float64", float("nan"), attributes))
    results = create_arrays(plan.folder, "Viewshed by gnomon", plan.receivers, ("y", "x"), arrays)
    put_raster_coordinates(results, plan.mosaic, plan.mosaic.crs)
