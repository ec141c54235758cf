#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What a study takes of each cell of a country: the law behind "A country" in docs/studies.md.

    pip install '.[pocl,study]'
    python tools/measure_country.py [--reliefs flat,hills,alps,town] [--halo 20000] [--tiles 1,4] [--year-tiles 1,2]

A made ground in cells of 2 m, of a seed: value noise, each octave half as wide as the one before. Its middle has a row
of receiver tiles; around them lies a halo of casters, which is read as far as the suns need it. Of each relief a study
of a day (20 March, 40 suns) and one of a year by the hour decide the given numbers of tiles, each in a process of its
own. Printed of each: suns, blocks of suns, decisions, undecided ones, seconds by the clock and of the processor,
decisions per second of the processor, peak memory (with GDAL's cache, up to a twentieth of the machine's), bytes read
and bytes of the results. "plan" is what comes before the first tile: it reads all cells once.

Reliefs: flat, 2 m high; hills of 90 m over 1.5 km; alps, 1,500 m over 6 km; town, hills of 60 m with 10 houses to a
hectare, whose walls are one cell wide and whose roofs follow the ground.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import resource
import shutil
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import gnomon
import gnomon.studies
import numpy as np
import rasterio
from numpy.typing import NDArray

CELL = 2.0
WEST, NORTH, CRS = 600_000.0, 5_250_000.0, "EPSG:25832"  # 47 degrees north
PERIOD = 1024  # after as many places an octave's noise comes again
PATTERN = 2048  # cells after which the houses come again
STRIP = 256


class Relief(NamedTuple):
    """widest: the first octave's width in metres; highest: its height; gain: each octave's over that of the last."""

    widest: float
    highest: float
    gain: float
    octaves: int
    has_houses: bool = False


RELIEFS = {
    "flat": Relief(700, 2, 0.6, 9),
    "hills": Relief(1500, 90, 0.42, 10),
    "alps": Relief(6000, 1500, 0.46, 12),
    "town": Relief(1500, 60, 0.35, 6, True),
}
SUNS = {
    "day": {"start": "2026-03-20", "end": "2026-03-21", "step": "17min"},
    "year": {"start": "2026-01-01", "end": "2027-01-01", "step": "1h"},
}


# ---- The ground ------------------------------------------------------------------------------------------------------


def places(first: int, last: int, width: float) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
    """Of each cell first..last - 1 the place of an octave's noise before it, and how far it is on the way to the
    next, smoothed."""
    at = np.arange(first, last) * (CELL / width)
    before = np.floor(at).astype(np.int64)
    t = (at - before).astype(np.float32)
    return before, t * t * t * (t * (t * 6 - 15) + 10)


def ground(relief: Relief, noise: list[NDArray[np.float32]], first: int, last: int, side: int) -> NDArray[np.float32]:
    """Heights of the rows first..last - 1 of `side` columns."""
    heights = np.zeros((last - first, side), np.float32)
    for octave, values in enumerate(noise):
        width, height = relief.widest / 2**octave, np.float32(relief.highest * relief.gain**octave)
        (row, v), (column, u) = places(first, last, width), places(0, side, width)
        lines = values[np.arange(row[0], row[-1] + 2) % PERIOD] * height
        west, east = lines[:, column % PERIOD], lines[:, (column + 1) % PERIOD]
        lines = west + u * (east - west)
        north, south = lines[row - row[0]], lines[row - row[0] + 1]
        heights += north + v[:, None] * (south - north)
    return heights


def houses(rng: np.random.Generator) -> NDArray[np.float32]:
    """(PATTERN, PATTERN) metres above the ground: turned boxes with flat or gabled roofs."""
    heights = np.zeros((PATTERN, PATTERN), np.float32)
    for _ in range(PATTERN**2 // 250):
        i, j = rng.integers(20, PATTERN - 20, 2)
        turn, wide, long = rng.uniform(0, np.pi), rng.integers(3, 9), rng.integers(4, 16)
        top, slope = rng.integers(5, 23), rng.choice([0, 1.2])
        y, x = np.mgrid[-10:11, -10:11]
        along, across = x * np.cos(turn) + y * np.sin(turn), np.abs(y * np.cos(turn) - x * np.sin(turn))
        part = heights[i - 10 : i + 11, j - 10 : j + 11]
        is_in = (np.abs(along) < long / 2) & (across < wide / 2)
        part[is_in] = np.maximum(part, top - slope * across)[is_in]
    return heights


def write_ground(path: Path, name: str, side: int, seed: int = 1) -> None:
    relief, rng = RELIEFS[name], np.random.Generator(np.random.PCG64(seed))
    noise = [rng.uniform(-1, 1, (PERIOD, PERIOD)).astype(np.float32) for _ in range(relief.octaves)]
    above = np.tile(houses(rng), (1, -(-side // PATTERN)))[:, :side] if relief.has_houses else None
    place = rasterio.Affine(CELL, 0, WEST, 0, -CELL, NORTH)
    with rasterio.open(
        path, "w", driver="GTiff", height=side, width=side, count=1, dtype="float32", crs=CRS, transform=place,
        tiled=True,
    ) as file:  # fmt: skip
        for first in range(0, side, STRIP):
            last = min(first + STRIP, side)
            heights = 1000 + ground(relief, noise, first, last, side)
            if above is not None:
                heights += above[np.arange(first, last) % PATTERN]
            file.write(heights, 1, window=rasterio.windows.Window(0, first, side, last - first))


# ---- A study of some of its tiles ------------------------------------------------------------------------------------


def bytes_read() -> int:
    file = Path("/proc/self/io")
    return int(file.read_text().split()[1]) if file.exists() else 0


def decided(folder: Path, raster: Path, suns: str, tile: int, tiles: slice) -> dict[str, Any]:
    """Runs a study's tiles, and says what they took. No tiles: the plan alone."""

    def run(chosen: slice) -> gnomon.studies.Study:
        return gnomon.study(folder, raster=str(raster), tile=tile, tiles=chosen, **SUNS[suns])

    if tiles.stop > tiles.start:
        run(slice(0, 0))  # loads modules
    start, busy, read = time.perf_counter(), time.process_time(), bytes_read()
    study = run(tiles)
    took, busy = time.perf_counter() - start, time.process_time() - busy
    record, plan = study.record, study.plan
    chunks = sum(file.stat().st_size for file in folder.glob("*.zarr/*/c/**/*") if file.is_file())
    return {"suns": sum(plan.size_of_block(block) for block in range(len(plan.blocks))), "blocks": len(plan.blocks),
            "decisions": record["decisions"], "undecided": record["undecided"], "seconds": round(took, 1),
            "processor": round(busy, 2), "decisions_a_second": round(record["decisions"] / busy),
            "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss >> 10,
            "read_mb": (bytes_read() - read) >> 20, "results_mb": round(chunks / 2**20, 2)}  # fmt: skip


def in_a_process(*arguments: Any) -> dict[str, Any]:
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        return pool.submit(decided, *arguments).result()


def measure(name: str, options: argparse.Namespace) -> None:
    per_row = 2 * -(-int(options.halo / CELL) // options.tile) + max([*options.tiles, *options.year_tiles])
    side = per_row * options.tile
    middle = per_row // 2 * per_row + int(options.halo / CELL) // options.tile
    with tempfile.TemporaryDirectory(dir=options.folder) as temporary:
        raster = Path(temporary) / "ground.tif"
        write_ground(raster, name, side)
        print(f"== {name}: {side:,} x {side:,} cells, receivers in the middle", flush=True)
        for suns, counts in (("day", options.tiles), ("year", options.year_tiles)):
            planned = Path(temporary) / suns
            for count in (0, *counts):
                folder = Path(shutil.copytree(planned, f"{planned}-{count}")) if count else planned
                row = in_a_process(folder, raster, suns, options.tile, slice(middle, middle + count))
                print(json.dumps({"relief": name, "study": suns, "tiles": count or "plan", **row}), flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--reliefs", default=",".join(RELIEFS))
    parser.add_argument("--halo", type=float, default=20_000, help="metres of casters on each side")
    parser.add_argument("--tile", type=int, default=512, help="cells on a side of a receiver tile")
    whole: dict[str, Any] = {"type": lambda text: [int(n) for n in text.split(",")]}
    parser.add_argument("--tiles", **whole, default=[1, 4], help="receiver tiles of the day's studies")
    parser.add_argument("--year-tiles", **whole, default=[1, 2], help="of the year's")
    parser.add_argument("--folder", help="where the ground and the studies lie, which are removed at the end")
    options = parser.parse_args()
    for name in options.reliefs.split(","):
        measure(name, options)


if __name__ == "__main__":
    sys.exit(main())
