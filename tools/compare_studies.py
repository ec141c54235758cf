#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Shadows of a DSM by gnomon.study() beside those of other packages, on the same cells at the same suns.

    pip install '.[pocl,study]' solweig horayzon-extpar numpy cython 'setuptools<80'
    pip install --no-build-isolation topocalc
    python tools/compare_studies.py [--cells 500] [--suns 40] [--only gnomon,horayzon,topocalc,solweig] [--share]

Two DSMs: a made town in cells of 1 m with a tower, and a real one, the Jacksboro fault in Tennessee (USGS, public
domain), which matplotlib ships: its heights, in whole metres, on square cells of 80 m. Suns from 3 degrees up. Printed:
seconds and processor seconds of each, cells that differ from gnomon's, and what rational arithmetic
(tests/python/oracle.py) says of some of these and of cells drawn at random, on the surface that gnomon states,
triangles between the cells' centres; not of DSMs of more than a million cells. A package that is not installed is left
out. --share: how many of the study's processor seconds are those of the library's calls, in a run with one thread.

HORAYZON (horayzon-extpar) gets these very triangles, on a sphere so large that it is a plane; it finds the horizon by
rays of Embree. topocalc's horizon turns the raster by whole columns to the sun's azimuth and compares heights along
rows. SOLWEIG shifts the raster by whole cells along the sun's path, so its surface is one of steps.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import gnomon
import gnomon.studies
import numpy as np
from gnomon.studies import decide, runner

sys.path[:0] = [str(Path(__file__).parents[1] / "tests/python"), str(Path(__file__).parents[1] / "tests/python/study")]
from gnomon.studies.rasters import faces_of_grid  # noqa: E402
from made import bits, exactly_lit, replaced, snapped, triangles_of, write_raster, write_suns  # noqa: E402

WEST, NORTH = 512_000.0, 5_002_400.0
DRAWN = 30
ACCURACY = 0.05  # degrees, of HORAYZON
MOST_CHECKED = 1_000_000  # cells


class Dsm(NamedTuple):
    name: str
    heights: np.ndarray
    cell: float


Suns = list[tuple[float, float]]


def town(n: int) -> Dsm:
    rng = np.random.default_rng(7)
    r, c = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    heights = np.round((15 + 12 * np.sin(r / 90) * np.cos(c / 70)) * 64) / 64
    for _ in range(n * n // 900):
        i, j = rng.integers(0, n - 20, 2)
        heights[i : i + rng.integers(6, 18), j : j + rng.integers(6, 18)] += rng.integers(5, 25)
    heights[n // 2 : n // 2 + 8, n // 2 : n // 2 + 8] = 200
    return Dsm("a made town", heights, 1.0)


def jacksboro() -> Dsm:
    from matplotlib import cbook

    return Dsm("the Jacksboro fault", cbook.get_sample_data("jacksboro_fault_dem.npz")["elevation"].astype(float), 80.0)


# ---- Contestants: answers (M, R, C) ----------------------------------------------------------------------------------


def run_study(folder: Path, dsm: Dsm, suns: Suns) -> tuple[gnomon.studies.Study, float]:
    """A study, and its processor seconds."""
    raster = write_raster(folder / "dsm.tif", dsm.heights, cell=dsm.cell, west=WEST, north=NORTH)
    table = write_suns(folder / "suns.csv", suns)
    start = time.process_time()
    study = gnomon.study(folder / "study", raster=raster, directions=table, outputs=["bits"])
    return study, time.process_time() - start


def of_gnomon(dsm: Dsm, suns: Suns) -> np.ndarray:
    with tempfile.TemporaryDirectory() as folder:
        return bits(run_study(Path(folder), dsm, suns)[0])


def of_solweig(dsm: Dsm, suns: Suns) -> np.ndarray:
    import solweig.rustalgos

    solweig.rustalgos.shadowing.disable_gpu()
    heights, top = dsm.heights.astype(np.float32), float(dsm.heights.max())
    find = solweig.rustalgos.shadowing.calculate_shadows_wall_ht_25
    return np.stack([np.asarray(find(a, e, dsm.cell, top, heights).bldg_sh) > 0.5 for a, e in suns])


def of_topocalc(dsm: Dsm, suns: Suns) -> np.ndarray:
    from topocalc.horizon import horizon

    # The cosine of the angle from the zenith to the horizon; azimuths from the south, the east is 90.
    return np.stack([np.sin(np.radians(e)) > horizon(180 - a, dsm.heights, dsm.cell) for a, e in suns])


def of_horayzon(dsm: Dsm, suns: Suns) -> np.ndarray:
    from horayzon_extpar.horizon import Terrain

    rows, columns = dsm.heights.shape
    x, y = np.meshgrid(np.arange(columns) * dsm.cell, -np.arange(rows) * dsm.cell)
    vertices = np.stack([x, y, dsm.heights], axis=-1).reshape(-1, 3).astype(np.float32)
    radius = 1e10
    terrain = Terrain()
    terrain.initialise(vertices, faces_of_grid(rows, columns).astype(np.uint32),
                       np.array([0, 0, -radius], np.float32), np.array([0, radius, -radius], np.float32))  # fmt: skip
    every = np.array([0, len(vertices)], np.uint32)
    far = max(float(np.hypot(*dsm.heights.shape)) * dsm.cell, 1000.0)
    around = 2 * len(suns)  # evenly spaced azimuths from the north on, of which the suns take those in the south
    found = np.asarray(terrain.horizon_vertex(around, suns[0][0] % (360 / around), every, far, 1.0, ACCURACY, -80.0))
    return np.stack([e > found[:, round(a * around // 360)].reshape(rows, columns) for a, e in suns])


CONTESTANTS: dict[str, Callable[[Dsm, Suns], np.ndarray]] = {
    "gnomon": of_gnomon, "horayzon": of_horayzon, "topocalc": of_topocalc, "solweig": of_solweig,
}  # fmt: skip


# ---- The comparison --------------------------------------------------------------------------------------------------


def timed(find: Callable[[Dsm, Suns], np.ndarray], dsm: Dsm, suns: Suns) -> tuple[np.ndarray, float, float]:
    find(Dsm(dsm.name, dsm.heights[:64, :64], dsm.cell), suns)  # compiling and loading
    start, busy = time.perf_counter(), time.process_time()
    answers = find(dsm, suns)
    return answers, time.perf_counter() - start, time.process_time() - busy


class WatchedScene(gnomon.Scene):
    """Adds up the processor seconds of a study's calls of the library."""

    seconds = 0.0

    def __init__(self, *arguments: Any, **more: Any) -> None:
        start = time.process_time()
        super().__init__(*arguments, **more)
        WatchedScene.seconds += time.process_time() - start

    def lit_by(self, *arguments: Any, **more: Any) -> gnomon.LightsResult:
        start = time.process_time()
        result = super().lit_by(*arguments, **more)
        WatchedScene.seconds += time.process_time() - start
        return result


def print_share(dsm: Dsm, suns: Suns) -> None:
    with replaced(runner, "THREADS", 1), replaced(decide, "Scene", WatchedScene):
        of_gnomon(Dsm(dsm.name, dsm.heights[:64, :64], dsm.cell), suns)
        WatchedScene.seconds = 0.0
        with tempfile.TemporaryDirectory() as folder:
            busy, calls = run_study(Path(folder), dsm, suns)[1], WatchedScene.seconds
    print(f"gnomon: {busy:.2f} processor seconds are {busy / calls:.3f} times the {calls:.2f} of the library's calls")


def compare(dsm: Dsm, suns: Suns, names: list[str]) -> None:
    print(f"== {dsm.name}: {dsm.heights.size:,} cells of {dsm.cell:g} m x {len(suns)} suns", flush=True)
    answers = {}
    for name in names:
        try:
            answers[name], took, busy = timed(CONTESTANTS[name], dsm, suns)
        except ImportError as error:
            print(f"{name}: left out ({error})")
            continue
        print(f"{name}: {took:.2f} s, {busy:.2f} processor seconds, {answers[name].mean():.2%} lit", flush=True)
    ours = answers.pop("gnomon")
    if dsm.heights.size > MOST_CHECKED:
        for name, theirs in answers.items():
            print(f"{name}: {(ours != theirs).mean():.4%} differ")
        return
    triangles, vertices = triangles_of(dsm.heights, dsm.cell, WEST, NORTH)
    triangles, vertices = snapped(triangles), snapped(vertices)
    a, e = np.radians(np.array(suns)).T
    towards = np.stack([np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e)], axis=1).astype(np.float32)
    rng = np.random.default_rng(2)

    def right(found: np.ndarray) -> tuple[int, np.ndarray]:
        chosen = found[rng.choice(len(found), min(DRAWN, len(found)), replace=False)] if len(found) else found
        return sum(exactly_lit(triangles, vertices[r, c], towards[s]) == ours[s, r, c] for s, r, c in chosen), chosen

    good, chosen = right(np.argwhere(np.ones_like(ours)))
    print(f"of {len(chosen)} answers drawn at random rational arithmetic gives gnomon {good}")
    for name, theirs in answers.items():
        differ = ours != theirs
        only = (differ & theirs).sum(), (differ & ours).sum()
        print(f"{name}: {differ.mean():.4%} differ: {only[0]:,} lit by it alone, {only[1]:,} by gnomon alone")
        good, chosen = right(np.argwhere(differ))
        print(f"  of {len(chosen)} of these drawn at random rational arithmetic gives gnomon {good}")
        if len(chosen):
            s, r, c = chosen[0]
            at = f"cell {r}, {c} at {dsm.heights[r, c]:.2f} m, azimuth {suns[s][0]:.2f}, elevation {suns[s][1]:.3f}"
            print(f"  for example {at}: gnomon {ours[s, r, c]}, {name} {theirs[s, r, c]}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cells", type=int, default=500, help="of the town, on a side")
    parser.add_argument("--suns", type=int, default=40)
    parser.add_argument("--scenes", default="town,jacksboro")
    parser.add_argument("--share", action="store_true", help="measure the share of the library's calls alone")
    parser.add_argument("--only", default=",".join(CONTESTANTS), help="contestants, gnomon among them")
    options = parser.parse_args()
    n = max(options.suns // 2, 1) * 2  # on evenly spaced azimuths from the east to the west
    suns = [(90 + 180 * (i + 0.5) / n, 3 + 50 * np.sin(np.pi * (i + 0.5) / n)) for i in range(n)]
    for scene in options.scenes.split(","):
        dsm = town(options.cells) if scene == "town" else jacksboro()
        if options.share:
            print_share(dsm, suns)
        else:
            compare(dsm, suns, options.only.split(","))


if __name__ == "__main__":
    main()
