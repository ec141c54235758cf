# SPDX-License-Identifier: MIT
"""Viewsheds of the same rasters by gnomon, gdal_viewshed (Debian's gdal-bin) and xarray-spatial: times by turns, and
the cells that differ, judged by rational arithmetic. usage: compare_viewsheds.py FOLDER [--sides 1000,4000]

A cell that differs is judged on three surfaces: both diagonals of each square, and bilinear squares. gnomon is called
right only where all three disagree with the peer; where they do not agree among themselves, models merely differ. The
first cells where gnomon is right are drawn: the line of sight over the ground. Needs matplotlib."""

from __future__ import annotations

import argparse
import subprocess
import sys
import time
from fractions import Fraction
from pathlib import Path

import gnomon
import numpy as np
import rasterio

CELL, HEIGHT, RADIUS = 10.0, 2.0, 6_378_137.0  # GDAL's radius is that of the ellipsoid's equator


def hills(side):
    """Heights of a power-law spectrum, 0 to 1,500 m."""
    rng = np.random.default_rng(1)
    k = np.fft.fftfreq(side)[:, None] ** 2 + np.fft.rfftfreq(side)[None] ** 2
    k[0, 0] = 1
    f = np.fft.irfft2(np.fft.rfft2(rng.standard_normal((side, side))) * k**-1.05, (side, side))
    return ((f - f.min()) / np.ptp(f) * 1500).astype(np.float32)


def jacksboro():
    """The Jacksboro fault (USGS), which matplotlib ships; taken as cells of 80 m."""
    import matplotlib.cbook

    return np.asarray(matplotlib.cbook.get_sample_data("jacksboro_fault_dem.npz")["elevation"], np.float32)


class Raster:
    def __init__(self, name, heights, cell, folder):
        self.name, self.heights, self.cell = name, heights, cell
        rows, columns = heights.shape
        self.x = 600_000 + cell * (np.arange(columns) + 0.5)
        self.y = 5_400_000 - cell * (np.arange(rows) + 0.5)
        self.path = folder / f"{name}.tif"
        with rasterio.open(
            self.path, "w", driver="GTiff", width=columns, height=rows, count=1, dtype="float32", crs="EPSG:25832",
            transform=rasterio.Affine(cell, 0, 600_000, 0, -cell, 5_400_000),
        ) as file:  # fmt: skip
            file.write(heights, 1)
        self.eye = rows // 2, columns // 2
        self.place = self.x[self.eye[1]], self.y[self.eye[0]]


def grid_of(raster):
    return gnomon.ViewshedGrid(raster.heights, x=raster.x, y=raster.y, radius=RADIUS)


def by_gnomon(raster):
    return grid_of(raster).viewshed(raster.place, height=HEIGHT).counts > 0


def by_gdal(raster):
    out = raster.path.with_suffix(".gdal.tif")
    subprocess.run(
        ["gdal_viewshed", "-q", "-ox", str(raster.place[0]), "-oy", str(raster.place[1]), "-oz", str(HEIGHT),
         "-cc", repr(6 / 7), str(raster.path), str(out)], check=True,
    )  # fmt: skip
    with rasterio.open(out) as file:
        return file.read(1) == 255


def by_xarray_spatial(raster):
    """It knows no curvature: it gets heights that are bent around the observer."""
    import xarray
    from xrspatial import viewshed

    data = xarray.DataArray(bent(raster), {"y": raster.y, "x": raster.x}, ("y", "x"))
    return viewshed(data, x=raster.place[0], y=raster.place[1], observer_elev=HEIGHT).values > -1


def bent(raster):
    d2 = (raster.x[None, :] - raster.place[0]) ** 2 + (raster.y[:, None] - raster.place[1]) ** 2
    return raster.heights - (6 / 7) / (2 * RADIUS) * d2


def is_seen(steps, eye, cell, surface):
    """By rational arithmetic, of heights in whole steps. surface: "south-west" or "north-west", where diagonals begin,
    or "bilinear". eye: row, column, height."""
    (r0, c0, z0), (r1, c1) = eye, cell
    z1 = int(steps[cell])
    dr, dc = r1 - r0, c1 - c0

    def ground(t):
        r, c = r0 + t * dr, c0 + t * dc
        i, j = min(int(r), steps.shape[0] - 2), min(int(c), steps.shape[1] - 2)
        f, g = r - i, c - j
        a, b, p, q = (int(steps[i, j]), int(steps[i, j + 1]), int(steps[i + 1, j]), int(steps[i + 1, j + 1]))
        if surface == "bilinear":
            return (1 - f) * ((1 - g) * a + g * b) + f * ((1 - g) * p + g * q)
        if surface == "south-west":
            return a + g * (b - a) + f * (p - a) if f + g <= 1 else q + (1 - g) * (p - q) + (1 - f) * (b - q)
        return a + g * (b - a) + f * (q - b) if g >= f else a + f * (p - a) + g * (q - p)

    def margin(t):
        return z0 + t * (z1 - z0) - ground(t)

    crossings = {Fraction(k, abs(d)) for d in (dr, dc) if d for k in range(1, abs(d))}
    sums = dr + dc if surface == "south-west" else dr - dc
    if surface != "bilinear" and sums:
        crossings |= {Fraction(k, abs(sums)) for k in range(1, abs(sums))}
    crossings = sorted(crossings)
    if any(margin(t) <= 0 for t in crossings):
        return False
    if surface == "bilinear":  # a parabola over each square: its least value lies at an end or at its vertex
        for a, b in zip([Fraction(0), *crossings], [*crossings, Fraction(1)], strict=True):
            low, middle, high = margin(a), margin((a + b) / 2), margin(b)
            bend, slope = 2 * (low + high - 2 * middle), 4 * middle - 3 * low - high
            if bend > 0 and 0 < -slope / (2 * bend) < 1 and low - slope * slope / (4 * bend) <= 0:
                return False
    return True


def judge(raster, mine, theirs, count, rng):
    """Of `count` differing cells: the cells; how many surfaces of three agree with gnomon; the heights, rounded as
    gnomon rounds them, in steps of 2^-10 m."""
    steps = grid_of(raster)._ground.steps.astype(np.int64)
    r, c = raster.eye
    eye = r, c, int(steps[r, c]) + round(HEIGHT * 1024)
    cells = np.argwhere(mine != theirs)
    chosen = cells[rng.permutation(len(cells))[:count]]
    agree = [
        sum(is_seen(steps, eye, tuple(cell), s) == mine[tuple(cell)] for s in ("south-west", "north-west", "bilinear"))
        for cell in chosen.tolist()
    ]
    return chosen, np.array(agree), steps


def draw(raster, steps, cell, mine, peer, path):
    """The line of sight over the ground, relative to the line: above 0 it is hidden."""
    from matplotlib.figure import Figure

    (r0, c0), (r1, c1) = raster.eye, cell
    t = np.linspace(0, 1, 40 * int(max(abs(r1 - r0), abs(c1 - c0))) + 1)[1:-1]
    r, c = r0 + t * (r1 - r0), c0 + t * (c1 - c0)
    i, j = np.minimum(r.astype(int), steps.shape[0] - 2), np.minimum(c.astype(int), steps.shape[1] - 2)
    f, g = r - i, c - j
    a, b, p, q = (steps[i + m, j + n] / 1024 for m in (0, 1) for n in (0, 1))
    eye = steps[r0, c0] / 1024 + HEIGHT
    line = eye + t * (steps[r1, c1] / 1024 - eye)
    figure = Figure(figsize=(7, 4.4), dpi=90, layout="constrained")
    whole, near = figure.subplots(2, 1)
    length = raster.cell * np.hypot(r1 - r0, c1 - c0)
    bilinear = (1 - f) * ((1 - g) * a + g * b) + f * ((1 - g) * p + g * q)
    one = np.where(f + g <= 1, a + g * (b - a) + f * (p - a), q + (1 - g) * (p - q) + (1 - f) * (b - q))
    other = np.where(g >= f, a + g * (b - a) + f * (q - b), a + f * (p - a) + g * (q - p))
    margin = np.maximum(np.maximum(one, other), bilinear) - line
    closest = int(np.argmax(np.where((t > 2 / len(t) * 40) & (t < 1 - 40 / len(t)), margin, -np.inf)))
    for axes, part in ((whole, slice(None)), (near, slice(max(closest - 160, 0), closest + 160))):
        for values, name in ((one, "diagonals from south-west"), (other, "from north-west"), (bilinear, "bilinear")):
            axes.plot(t[part] * length, (values - line)[part], lw=1, label=name)
        axes.axhline(0, color="black", lw=0.8)
        axes.set_ylabel("ground less line, m")
    whole.legend(fontsize=7, loc="lower center", ncols=3)
    near.set_xlabel("distance from the eye, m; below: where the ground comes closest")
    answer = "seen" if mine else "hidden"
    title = f"{raster.name}, cell {tuple(cell)}: {answer} by gnomon and all three surfaces, not by {peer}"
    whole.set_title(title, fontsize=9)
    figure.savefig(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--sides", default="1000,4000")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--judged", type=int, default=60)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    rasters = [Raster("jacksboro", jacksboro(), 80.0, options.folder)]
    rasters += [Raster(f"hills{n}", hills(int(n)), CELL, options.folder) for n in options.sides.split(",")]
    by_gnomon(rasters[0])  # kernels are compiled
    peers = {"gnomon": by_gnomon, "gdal": by_gdal, "xarray-spatial": by_xarray_spatial}
    by_xarray_spatial(rasters[0])
    print(f"gnomon {gnomon.__version__} on {gnomon.use()!r}; {sys.version.split()[0]}")
    for raster in rasters:
        wall, cpu, answers = {n: [] for n in peers}, {n: [] for n in peers}, {}
        for _ in range(options.rounds):
            for name, run in peers.items():
                start, used = time.perf_counter(), time.process_time()
                answers[name] = run(raster)
                wall[name].append(time.perf_counter() - start)
                cpu[name].append(time.process_time() - used)
        for name in peers:
            print(f"{raster.name}: {name}: {np.median(wall[name]):.3f} s wall", end="")
            print("" if name == "gdal" else f", {np.median(cpu[name]):.3f} s of processors", end="")
            differ = int((answers[name] != answers["gnomon"]).sum())
            print(f"; {answers[name].mean():.3%} seen; {differ} cells differ ({differ / answers[name].size:.4%})")
        mine = answers["gnomon"]
        for peer in ("gdal", "xarray-spatial"):
            cells, agree, steps = judge(raster, mine, answers[peer], options.judged, np.random.default_rng(3))
            right = cells[agree == 3]
            print(f"  {peer}: of {len(cells)} cells judged, all surfaces agree with gnomon in {len(right)}, "
                  f"some in {((agree > 0) & (agree < 3)).sum()}, none in {(agree == 0).sum()}")  # fmt: skip
            if len(right):
                cell = tuple(right[0].tolist())
                draw(raster, steps, cell, mine[cell], peer, options.folder / f"{raster.name}_{peer}.png")


if __name__ == "__main__":
    main()
