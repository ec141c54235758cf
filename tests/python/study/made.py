# SPDX-License-Identifier: MIT
"""Made rasters, tables of suns, and what they must answer."""

import contextlib
from pathlib import Path

import numpy as np
import oracle
import rasterio
from gnomon import studies

UTM = "EPSG:25832"
NODATA = -9999.0


def write_raster(path, heights, cell=25.0, west=512_000.0, north=5_002_400.0, crs=UTM, **more):
    """Heights, row 0 in the north; NaN is nodata."""
    values = np.where(np.isnan(heights), NODATA, heights).astype(np.float32)
    with rasterio.open(
        path, "w", driver="GTiff", height=values.shape[0], width=values.shape[1], count=1, dtype="float32", crs=crs,
        nodata=NODATA, transform=rasterio.Affine(cell, 0, west, 0, -cell, north), **more,
    ) as file:  # fmt: skip
        file.write(values, 1)
    return str(path)


def city(n=96, seed=19):
    """n x n cells: hills, houses, a hole without data, and a tower of 470 m."""
    rng = np.random.default_rng(seed)
    r, c = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    heights = np.round(30 * np.sin(r / 17) * np.cos(c / 23) * 256) / 256  # whole steps of 2^-10, also 64 m higher
    for _ in range(2 * n):
        i, j = rng.integers(0, n - 5, 2)
        heights[i : i + rng.integers(1, 5), j : j + rng.integers(1, 5)] += rng.integers(8, 90)
    heights[n // 3 : n // 3 + 2, 2 * n // 3 : 2 * n // 3 + 2] = 470
    heights[n // 2 : n // 2 + 3, n // 4 : n // 4 + 4] = np.nan
    return heights


def write_suns(path, suns):
    """A table of (azimuth, elevation) in degrees."""
    a, e = np.radians(np.array(suns, float)).T
    towards = np.stack([np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e)], axis=1)
    towards[np.abs(towards) < 1e-12] = 0  # due east is due east
    np.savetxt(path, -towards, delimiter=",", header="x,y,z", comments="", fmt="%.17g")
    return str(path)


def triangles_of(heights, cell, west, north):
    """World triangles of a raster, by the rule in Settings.raster, one square at a time; and vertices (R, C, 3)."""
    rows, columns = heights.shape
    vertices = np.empty((rows, columns, 3))
    vertices[..., 0] = west + (np.arange(columns) + 0.5) * cell
    vertices[..., 1] = (north - (np.arange(rows) + 0.5) * cell)[:, None]
    vertices[..., 2] = heights.astype(np.float32)
    triangles = []
    for r in range(rows - 1):
        for c in range(columns - 1):
            nw, ne, sw, se = vertices[r, c], vertices[r, c + 1], vertices[r + 1, c], vertices[r + 1, c + 1]
            triangles += [t for t in ([sw, se, ne], [sw, ne, nw]) if np.isfinite(t).all()]
    return np.array(triangles), vertices


def snapped(values, step=2.0**-10):
    return np.floor(values / step + 0.5) * step


def exactly_lit(triangles, vertex, towards):
    """By rational arithmetic. Only triangles that the ray passes over on the map are tested: others cannot meet it."""
    t = np.array(towards, np.float64)
    low, high = triangles[..., :2].min(axis=1) - vertex[:2], triangles[..., :2].max(axis=1) - vertex[:2]
    side = np.stack([-t[1], t[0]]) / np.hypot(t[0], t[1])  # the distance from the ray on the map
    middle, reach = (low + high) / 2 @ side, (high - low) / 2 @ np.abs(side)
    near = triangles[(np.abs(middle) <= reach + 1) & (high @ t[:2] >= -1)]
    around = triangles[(np.abs(triangles - vertex).max(axis=2) == 0).any(axis=1)]
    return bool(
        oracle.lit(near, [vertex], direction=-t.astype(np.float32))[0]
        and oracle.above_height_field(around, vertex, t.astype(np.float32))[0]
    )


def run(folder, **settings):
    return studies.study(folder, **settings)


def chunk_files(folder):
    """The bytes of all chunks of results."""
    root = Path(folder) / "results.zarr"
    return {str(p.relative_to(root)): p.read_bytes() for p in sorted(root.glob("*/c/**/*")) if p.is_file()
            and not p.name.endswith(".partial")}  # fmt: skip


def bits(study, name="lit"):
    """(M, R, C) bool by suns of a table."""
    data = study.plan.store.array(f"results.zarr/{name}")[:]
    suns = study.plan.suns
    return np.stack([(data[w] >> np.uint32(b)) & 1 for w, b in zip(suns.word, suns.bit, strict=True)]).astype(bool)


@contextlib.contextmanager
def replaced(owner, name, value):
    kept = getattr(owner, name)
    setattr(owner, name, value)
    try:
        yield kept
    finally:
        setattr(owner, name, kept)
