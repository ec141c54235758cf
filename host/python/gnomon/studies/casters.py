# SPDX-License-Identifier: MIT
"""Caster tiles: the squares of a raster and the files of meshes. They are surveyed once and loaded on demand."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .meshes import MeshFile, study_triangles
from .rasters import Mosaic, UnreadableError, crs_of, faces_of_grid
from .settings import Settings

#: The steps that receivers and casters of one lattice may span: its origin lies in the middle, and 2^24 steps fit on
#: each side.
LARGEST_SPAN = 2.0**25 - 64


def largest_tile(settings: Settings, cell: float) -> float:
    """The largest side of a tile in metres. It depends on the raster's cells, so that the lattice does not depend on
    the settings for tiles."""
    largest = max(4096.0, min(256 * cell, 32_768.0))
    return largest if settings.lattice is None else min(largest, LARGEST_SPAN * settings.lattice / 4)


def cells_of_tile(settings: Settings, mosaic: Mosaic, wanted: int) -> int:
    cell = max(mosaic.dx, mosaic.dy)
    return max(1, min(wanted, int(largest_tile(settings, cell) / cell)))


#: The box of a mesh that could not be read: it may stand anywhere.
ANYWHERE = [-1e30, -1e30, 1e30, 1e30]


class Survey(NamedTuple):
    """Boxes and heights of the K caster tiles, before any is used. Raster tiles come first, by rows from the north; the
    files of meshes follow.

    boxes: (K, 4) x0, y0, x1, y1. tops, bottoms: (K,) the greatest and the least height; -inf, inf for a tile without
        triangles; inf, -inf for an unread tile, and the box of an unread mesh is ANYWHERE. triangles: (K,) int64, an
        upper bound of the number of triangles.
    """

    boxes: NDArray[np.float64]
    tops: NDArray[np.float64]
    bottoms: NDArray[np.float64]
    triangles: NDArray[np.int64]

    @property
    def unread(self) -> NDArray[np.bool_]:
        return self.tops == np.inf

    @property
    def extent(self) -> NDArray[np.float64]:
        """(4,) the box around tiles with triangles and unread tiles of the raster."""
        boxes = self.boxes[(self.tops > -np.inf) & (self.boxes[:, 2] < ANYWHERE[2])]
        if not len(boxes):
            return np.array([0.0, 0.0, 0.0, 0.0])
        return np.concatenate([boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)])

    def save(self, path: Path) -> None:
        with path.open("wb") as file:
            np.savez_compressed(file, **self._asdict())

    @classmethod
    def load(cls, path: Path) -> Survey:
        with np.load(path) as data:
            return cls(**{name: data[name] for name in cls._fields})


class Casters:
    """The caster tiles of a study. Tile k of the raster holds the squares whose north-west corner lies in its cells;
    it shares the vertices on its border with its neighbours."""

    def __init__(self, settings: Settings, mosaic: Mosaic | None) -> None:
        self.settings = settings
        self.mosaic = mosaic
        size = self.size = 1 if mosaic is None else cells_of_tile(settings, mosaic, settings.caster_tile)
        self.rows = 0 if mosaic is None else -(-max(mosaic.rows - 1, 0) // size)
        self.columns = 0 if mosaic is None else -(-max(mosaic.columns - 1, 0) // size)

    def __len__(self) -> int:
        return self.rows * self.columns + len(self.settings.meshes)

    def name(self, tile: int) -> str:
        if tile >= self.rows * self.columns:
            return self.settings.meshes[tile - self.rows * self.columns]
        r0, r1, c0, c1 = self.window(tile)
        return f"cells {r0}:{r1}, {c0}:{c1} of the raster"

    def window(self, tile: int) -> tuple[int, int, int, int]:
        """Rows and columns of the vertices of a raster tile: first row, last row + 1, first column, last column + 1."""
        assert self.mosaic is not None
        size = self.size
        row, column = tile // self.columns * size, tile % self.columns * size
        return row, min(row + size + 1, self.mosaic.rows), column, min(column + size + 1, self.mosaic.columns)

    def rectangle_of(self, tiles: NDArray[np.int64]) -> tuple[tuple[int, int, int, int], NDArray[np.int64]] | None:
        """The window() of the smallest rectangle of raster tiles around these, and what else is in it; None where a
        tile is a mesh, or there is none."""
        if not len(tiles) or tiles.max() >= self.rows * self.columns:
            return None
        row, column = np.divmod(tiles, self.columns)
        rows, in_row = np.arange(row.min(), row.max() + 1), np.arange(column.min(), column.max() + 1)
        whole = (rows[:, None] * self.columns + in_row).reshape(-1)
        first, last = self.window(int(whole[0])), self.window(int(whole[-1]))
        return (first[0], last[1], first[2], last[3]), np.setdiff1d(whole, tiles)

    def tiles_of_window(self, row: int, last_row: int, column: int, last_column: int) -> NDArray[np.int64]:
        """The raster tiles that have a vertex in a window."""
        size = self.size
        rows = np.arange(max(row - 1, 0) // size, min((last_row - 1) // size, self.rows - 1) + 1)
        columns = np.arange(max(column - 1, 0) // size, min((last_column - 1) // size, self.columns - 1) + 1)
        return (rows[:, None] * self.columns + columns).reshape(-1)

    def surveyed(self, tile: int) -> tuple[list[float], float, float, int, str]:
        """Box, top, bottom and number of triangles of a tile; for an unread tile the reason, for others what is left
        out of a file."""
        box = ANYWHERE
        try:
            if tile >= self.rows * self.columns:
                mesh = mesh_of(self.settings, self.name(tile))
                note = f"{self.name(tile)}: {'; '.join(mesh.notes)}" if mesh.notes else ""
                corners = mesh.triangles.reshape(-1, 3)
                if not len(corners):
                    return [0.0, 0.0, 0.0, 0.0], -np.inf, np.inf, 0, note
                low, high = corners.min(axis=0), corners.max(axis=0)
                return [*low[:2].tolist(), *high[:2].tolist()], float(high[2]), float(low[2]), len(corners) // 3, note
            assert self.mosaic is not None
            r0, r1, c0, c1 = self.window(tile)
            x, y = self.mosaic.x(c0, c1), self.mosaic.y(r0, r1)
            box = [float(x[0]), float(y[-1]), float(x[-1]), float(y[0])]
            heights = self.mosaic.heights(r0, r1, c0, c1)
            if np.isnan(heights).all():
                return box, -np.inf, np.inf, 0, ""
            return box, float(np.nanmax(heights)), float(np.nanmin(heights)), 2 * (r1 - r0 - 1) * (c1 - c0 - 1), ""
        except UnreadableError as error:
            return box, np.inf, -np.inf, 0, str(error)

    def triangles(self, tile: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """World vertices (V, 3) and faces (F, 3) of a tile. Raises UnreadableError."""
        if tile >= self.rows * self.columns:
            corners = mesh_triangles(self.settings, self.name(tile)).reshape(-1, 3)
            return corners, np.arange(len(corners)).reshape(-1, 3)
        assert self.mosaic is not None
        r0, r1, c0, c1 = self.window(tile)
        heights = self.mosaic.heights(r0, r1, c0, c1)
        x, y = np.meshgrid(self.mosaic.x(c0, c1), self.mosaic.y(r0, r1))
        vertices = np.stack([x, y, heights], axis=-1).reshape(-1, 3)
        faces = _faces_of_tile(r1 - r0, c1 - c0)
        has_data = ~np.isnan(vertices[:, 2])
        if not has_data.all():
            faces = faces[has_data[faces].all(axis=1)]
            vertices[~has_data, 2] = 0
        return vertices, faces


@functools.lru_cache(maxsize=4)
def _faces_of_tile(rows: int, columns: int) -> NDArray[np.int64]:
    """faces_of_grid() of the few sizes that a raster's tiles have, not to be written."""
    faces = faces_of_grid(rows, columns)
    faces.flags.writeable = False
    return faces


def mesh_of(settings: Settings, name: str) -> MeshFile:
    """A file in the study's coordinates. Raises UnreadableError, or ValueError for another CRS than the study's."""
    return study_triangles(name, settings.mesh_up, settings.mesh_offset, crs_of(settings))


def mesh_triangles(settings: Settings, name: str) -> NDArray[np.float64]:
    """World triangles (F, 3, 3) of a file. Raises as mesh_of() does."""
    return mesh_of(settings, name).triangles


def far_from_all(casters: Casters, survey: Survey, box: tuple[float, float, float, float], points: Path) -> list[str]:
    """A sentence on each mesh that stands ten times its and the receivers' size away from these, whose box (x0, y0, x1,
    y1) is given; else one on the points of the study, in their file, that lie so far from all casters. They have other
    coordinates than the rest, most likely."""
    first_mesh = casters.rows * casters.columns
    boxes = survey.boxes[first_mesh:]
    is_known = np.isfinite(survey.tops[first_mesh:])
    gaps = _gaps(np.maximum(box[:2] - boxes[:, 2:], boxes[:, :2] - box[2:]))
    is_far = is_known & (gaps > _far(_sizes(boxes) + _sizes(np.array([box]))))
    notes = [
        f"{casters.name(first_mesh + i)}: stands {gaps[i] / 1000:.0f} km away from all receivers, from "
        f"({boxes[i, 0]:.0f}, {boxes[i, 1]:.0f}) to ({boxes[i, 2]:.0f}, {boxes[i, 3]:.0f}), and shadows none of them: "
        "mesh_offset= moves it"
        for i in np.flatnonzero(is_far).tolist()
    ]
    if notes or casters.settings.receivers != "points" or not (survey.tops > -np.inf).any():
        return notes
    extent = survey.extent
    places = np.load(points, mmap_mode="r")[:, :2]
    rows = np.flatnonzero(_gaps(np.maximum(extent[:2] - places, places - extent[2:])) > _far(_sizes(extent[None])))
    if not len(rows):
        return []
    x, y = places[rows[0]].tolist()
    return [
        f"{casters.settings.points}: {len(rows)} of {len(places)} points lie far from all casters, where nothing "
        f"shadows them, the first at ({x:.10g}, {y:.10g}); casters stand from ({extent[0]:.0f}, {extent[1]:.0f}) to "
        f"({extent[2]:.0f}, {extent[3]:.0f}): give x and y on the study's map"
    ]


def _gaps(beyond: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.hypot(*np.maximum(beyond, 0).T)


def _sizes(boxes: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.hypot(*(boxes[:, 2:] - boxes[:, :2]).T)


def _far(sizes: NDArray[np.float64]) -> NDArray[np.float64]:
    return 10 * np.maximum(sizes, 1000.0)
