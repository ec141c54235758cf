# SPDX-License-Identifier: MIT
"""gnomon-study viewshed: which cells of a raster of heights observers see, by tiles, as a GeoTIFF."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import rasterio
from numpy.typing import NDArray

from .. import _gnomon
from .._files import require_other
from .record import digests, record_of
from .runner import Execution, executor_of, run_plan
from .tables import read_observers
from .viewshed_plan import NO_COUNT, ViewshedPlan, ViewshedSettings, viewshed_plan

#: Bytes: what one observer sees, 255 and 0 as gdal_viewshed has them.
SEEN, UNDECIDED, HIDDEN, ABSENT = 255, 127, 0, 128
#: Heights: no data.
NO_HEIGHT = -9999.0
#: The outputs of a study from which each file is made.
WHAT = {"seen": "bits", "counts": "counts", "heights": "heights"}


def given_place(text: str, axes: str, example: str) -> list[float] | None:
    """The numbers of "x,y" or "x,y,z", as `axes` has them; None for a file's name. Raises ValueError for neither."""
    parts = text.split(",")
    if len(parts) == len(axes.split(",")):
        with contextlib.suppress(ValueError):
            return [float(part) for part in parts]
    if not Path(text).exists():
        raise ValueError(f"observers: {text!r} is neither {axes}, such as {example}, nor a file")
    return None


def observers_of(text: str, height: float) -> tuple[tuple[float, float, float], ...]:
    """x, y and the height of the eye of each observer. text: "x,y", or a .csv file with the columns x, y and perhaps
    height. Raises ValueError."""
    if (place := given_place(text, "x,y", "691000,5334000")) is not None:
        return ((place[0], place[1], height),)
    places, heights = read_observers(text)
    of_each = np.broadcast_to(height if heights is None else heights, len(places))
    return tuple((float(x), float(y), float(h)) for (x, y), h in zip(places, of_each, strict=True))


def write_viewshed(
    path: Path, settings: ViewshedSettings, folder: Path | None = None, execution: Execution | None = None
) -> dict[str, Any]:
    """Runs a viewshed, or goes on with the one in the folder, writes its GeoTIFF, and returns the record, which stands
    in the file's tag `gnomon`, too. folder: the study's, which is kept; None: one beside the file, which is removed
    when the file is there."""
    require_other(path, (*settings.raster, *settings.meshes))
    execution = execution or Execution()
    with _folder_of(path, settings, folder, execution.restart) as (where, restart):
        plan = viewshed_plan(where, settings, restart)
        with executor_of(execution) as executor:
            run_plan(plan, execution, executor)
        return export_viewshed(plan, path)


@contextlib.contextmanager
def _folder_of(
    path: Path, settings: ViewshedSettings, folder: Path | None, restart: bool
) -> Iterator[tuple[Path, bool]]:
    """The study's folder, and whether to begin again."""
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        yield folder.absolute(), restart
        return
    own = path.absolute().parent / f".{path.name}.study"
    own.mkdir(parents=True, exist_ok=True)
    try:
        try:
            viewshed_plan(own, settings, restart)
        except ValueError:
            viewshed_plan(own, settings, restart=True)  # what was left there is of another viewshed
        yield own, False
    except BaseException:
        if not any((own / "tasks").glob("*.json")):
            shutil.rmtree(own, ignore_errors=True)  # nothing to go on with
        raise
    shutil.rmtree(own)


def export_viewshed(plan: ViewshedPlan, path: Path, what: str | None = None) -> dict[str, Any]:
    """Writes a GeoTIFF of what the study has, and returns the record in it.

    what: "seen", of one observer: 255 seen, 0 hidden or beyond the distance, 127 undecided, 128 no data. "counts": the
    number of observers that see each cell, and in band 2 the number of those that may. "heights", of one observer: the
    height above the ground from which each cell is seen, in metres. None: the first that the study has.
    """
    has = [name for name, output in WHAT.items() if output in plan.settings.outputs]
    has = [name for name in has if name != "seen" or len(plan.places) == 1]
    if not has or (what or has[0]) not in has:
        raise ValueError(f"what: {what!r} is not in this viewshed, which has {', '.join(has) or 'packed bits alone'}")
    what = what or has[0]
    of_tasks = record_of(plan)
    if of_tasks["tasks_done"] < of_tasks["tasks"]:
        raise ValueError(f"{plan.folder}: {of_tasks['tasks_done']} of {of_tasks['tasks']} tasks are done: run it again")
    record = {
        **plan.own_record([]),
        "what": what,
        "raster": list(plan.settings.raster),
        **{key: of_tasks[key] for key in ("tasks", "decisions", "undecided")},
        "seen": _sum_of(plan, "seen"),
        "digest": hashlib.sha256(json.dumps(digests(plan)).encode()).hexdigest(),
        "gnomon": _gnomon.__version__,  # type: ignore[attr-defined]
    }
    _write(path, plan, what, record)
    return record


def _sum_of(plan: ViewshedPlan, key: str) -> int:
    """The sum of a fact over all tasks."""
    return sum((plan.store.done(*task, plan.hash) or {})[key] for task in plan.tasks)


def _bands(plan: ViewshedPlan, what: str, tile: int) -> list[NDArray[Any]]:
    """The bands of a tile, as the file has them."""
    slices = plan.receivers.slices(tile)

    def stored(name: str, *leading: int) -> NDArray[Any]:
        return np.asarray(plan.store.array(f"results.zarr/{name}")[(*leading, *slices)])

    if what == "counts":
        return [stored("counts"), stored("undecided_counts")]
    if what == "heights":
        least = stored("least_heights", 0)
        return [np.where(np.isnan(least), NO_HEIGHT, least).astype(np.float32)]
    chosen = [plan.is_absent(tile), stored("undecided", 0) > 0, stored("seen", 0) > 0]
    return [np.select(chosen, [ABSENT, UNDECIDED, SEEN], HIDDEN).astype(np.uint8)]


def _write(path: Path, plan: ViewshedPlan, what: str, record: dict[str, Any]) -> None:
    """The file appears whole."""
    mosaic = plan.mosaic
    nodata = {"seen": ABSENT, "counts": int(NO_COUNT), "heights": NO_HEIGHT}[what]
    dtype = {"seen": "uint8", "counts": "uint32", "heights": "float32"}[what]
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=".gnomon-") as folder:
        new = Path(folder) / "viewshed.tif"
        with rasterio.open(
            new, "w", driver="GTiff", tiled=True, compress="DEFLATE", width=mosaic.columns, height=mosaic.rows,
            count=2 if what == "counts" else 1, dtype=dtype, nodata=nodata, crs=mosaic.crs, BIGTIFF="IF_SAFER",
            transform=rasterio.Affine(mosaic.dx, 0, mosaic.west, 0, -mosaic.dy, mosaic.north),
        ) as file:  # fmt: skip
            for tile in range(len(plan.receivers)):
                window = rasterio.windows.Window.from_slices(*plan.receivers.slices(tile))
                for i, band in enumerate(_bands(plan, what, tile)):
                    file.write(band, i + 1, window=window)
            file.update_tags(gnomon=json.dumps(record))
        os.replace(new, path)
