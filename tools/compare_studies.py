#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Shadows of a DSM by gnomon.study() beside those of SOLWEIG's package, on the same cells at the same suns.

    pip install '.[pocl,study]' solweig
    python tools/compare_studies.py [--cells 500] [--suns 40]

A made town in cells of 1 m with a tower, suns from 3 degrees up. Printed: seconds of each, cells that differ, and what
rational arithmetic (tests/python/oracle.py) says of some of these on the surface that gnomon states, triangles between
the cells' centres. SOLWEIG shifts the raster by whole cells along the sun's path, so its surface is one of steps.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

import gnomon
import numpy as np
import solweig.rustalgos

sys.path[:0] = [str(Path(__file__).parents[1] / "tests/python"), str(Path(__file__).parents[1] / "tests/python/study")]
from made import bits, exactly_lit, snapped, triangles_of, write_raster, write_suns  # noqa: E402

WEST, NORTH = 512_000.0, 5_002_400.0


def town(n: int) -> np.ndarray:
    rng = np.random.default_rng(7)
    r, c = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    heights = np.round((15 + 12 * np.sin(r / 90) * np.cos(c / 70)) * 64) / 64
    for _ in range(n * n // 900):
        i, j = rng.integers(0, n - 20, 2)
        heights[i : i + rng.integers(6, 18), j : j + rng.integers(6, 18)] += rng.integers(5, 25)
    heights[n // 2 : n // 2 + 8, n // 2 : n // 2 + 8] = 200
    return heights


def of_solweig(heights: np.ndarray, suns: list[tuple[float, float]]) -> np.ndarray:
    dsm, top = heights.astype(np.float32), float(heights.max())
    find = solweig.rustalgos.shadowing.calculate_shadows_wall_ht_25
    return np.stack([np.asarray(find(a, e, 1.0, top, dsm).bldg_sh) > 0.5 for a, e in suns])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cells", type=int, default=500, help="on a side")
    parser.add_argument("--suns", type=int, default=40)
    options = parser.parse_args()
    heights = town(options.cells)
    suns = [(95 + 170 * i / options.suns, 3 + 50 * np.sin(np.pi * i / options.suns)) for i in range(options.suns)]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        raster = write_raster(folder / "dsm.tif", heights, cell=1.0, west=WEST, north=NORTH)
        table = write_suns(folder / "suns.csv", suns)
        gnomon.study(folder / "warm", raster=raster, directions=table, outputs=["bits"], tile=64, tiles=slice(1))
        start = time.perf_counter()
        study = gnomon.study(folder / "study", raster=raster, directions=table, outputs=["bits"])
        ours_took = time.perf_counter() - start
        ours, towards = bits(study), study.plan.suns.towards[0]
    solweig.rustalgos.shadowing.disable_gpu()
    of_solweig(heights[:50, :50], suns[:1])
    start = time.perf_counter()
    theirs = of_solweig(heights, suns)
    took = time.perf_counter() - start
    differ = ours != theirs
    pairs = heights.size * len(suns)
    print(f"{heights.size:,} cells x {len(suns)} suns; {ours.mean():.1%} lit")
    for name, seconds in (("gnomon.study", ours_took), ("solweig", took)):
        print(f"{name}: {seconds:.2f} s, {pairs / seconds / 1e6:.2f} million answers per second")
    only = (differ & theirs).sum(), (differ & ours).sum()
    print(f"{differ.mean():.2%} of the answers differ: {only[0]:,} lit by solweig alone, {only[1]:,} by gnomon alone")
    low = np.array([e < 10 for _, e in suns])
    print(f"below 10 degrees {differ[low].mean():.2%}, above {differ[~low].mean():.2%}")
    triangles, vertices = triangles_of(heights, 1.0, WEST, NORTH)
    triangles, vertices = snapped(triangles), snapped(vertices)
    rng = np.random.default_rng(2)
    found = np.argwhere(differ)
    wrong = 0
    chosen = found[rng.choice(len(found), min(30, len(found)), replace=False)] if len(found) else found
    for s, r, c in chosen:
        wrong += exactly_lit(triangles, vertices[r, c], towards[s]) != ours[s, r, c]
    print(f"of {len(chosen)} differing answers rational arithmetic gives gnomon {len(chosen) - wrong}, solweig {wrong}")
    if len(chosen):
        s, r, c = chosen[0]
        said = f"gnomon {ours[s, r, c]}, solweig {theirs[s, r, c]}"
        print(f"for example: cell {r}, {c} at {heights[r, c]:.2f} m, sun {suns[s]}: {said}")


if __name__ == "__main__":
    main()
