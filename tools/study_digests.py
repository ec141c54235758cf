#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs one made study and prints the digests of its results, to compare devices: the CPU of one machine, the GPUs of
another one without a network.

    python tools/study_digests.py --workers 2 --write digests.json      # here, on the CPU
    python tools/study_digests.py --workers gpus --expect digests.json  # there: exit code 1 if a digest differs

A made city of CELLS x CELLS in cells of 2 m without a CRS, in tiles of 512, 792 suns of a table in two blocks. It needs
numpy, rasterio, zarr, dask, distributed, xarray, trimesh and mapbox_earcut; neither pvlib nor pyproj.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import rasterio
from gnomon import studies


def write_city(path: Path, cells: int) -> str:
    """Whole numbers of 1/64 m by integer arithmetic alone, so that each machine makes the same file."""
    rng = np.random.Generator(np.random.PCG64(19))
    r, c = np.meshgrid(np.arange(cells), np.arange(cells), indexing="ij")
    heights = (np.abs(r % 360 - 180) + np.abs(c % 280 - 140)) * 5 // 2 * 4
    for _ in range(cells * cells // 900):
        i, j, h, w, up = rng.integers([0, 0, 6, 6, 5], [cells - 20, cells - 20, 18, 18, 25]).tolist()
        heights[i : i + h, j : j + w] += 64 * up
    heights[cells // 2 : cells // 2 + 5, cells // 3 : cells // 3 + 5] = 64 * 470
    heights[cells // 4 : cells // 4 + 9, cells // 5 : cells // 5 + 7] = -9999 * 64
    with rasterio.open(path, "w", driver="GTiff", height=cells, width=cells, count=1, dtype="float32", nodata=-9999,
                       transform=rasterio.Affine(2, 0, 512_000, 0, -2, 5_002_400)) as file:  # fmt: skip
        file.write((heights / 64).astype(np.float32), 1)
    return str(path)


def write_suns(path: Path) -> str:
    """24 days of 33 hours: directions of whole numbers, which every machine writes the same."""
    rows = []
    for hour in range(-16, 17):
        for day in range(24):
            rows.append((-60 * hour, 400 - 20 * day + 5 * abs(hour), -(60 + 25 * (16 - abs(hour)) + 10 * day)))
    np.savetxt(path, np.array(rows), delimiter=",", header="x,y,z", comments="", fmt="%d")
    return str(path)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cells", type=int, default=1024, help="on a side; the same on both machines")
    parser.add_argument("--workers", help="gpus, a number of processes, or devices as P:D,P:D; default: this process")
    parser.add_argument("--write", type=Path, help="writes the digests")
    parser.add_argument("--expect", type=Path, help="digests to compare with")
    options = parser.parse_args()
    workers: int | str | list[str] | None = options.workers
    if options.workers and options.workers.isdigit():
        workers = int(options.workers)
    elif options.workers and ":" in options.workers:
        workers = options.workers.split(",")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        raster, suns = write_city(folder / "dsm.tif", options.cells), write_suns(folder / "suns.csv")
        start = time.perf_counter()
        study = studies.study(folder / "study", workers=workers, raster=raster, directions=suns, block=396)
        took, record, digests = time.perf_counter() - start, study.record, study.digests()
    print(json.dumps({"digests": digests, "seconds": round(took, 2), "decisions": record["decisions"],
                      "decisions_per_second": round(record["decisions"] / took), "undecided": record["undecided"],
                      "tasks_of_devices": record["tasks_of_devices"]}, indent=1))  # fmt: skip
    if options.write:
        options.write.write_text(json.dumps({"cells": options.cells, "digests": digests}))
    if options.expect:
        expected = json.loads(options.expect.read_text())
        is_equal = expected == {"cells": options.cells, "digests": digests}
        print("the digests are those expected" if is_equal else f"the digests differ: expected {expected}")
        return 0 if is_equal else 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
