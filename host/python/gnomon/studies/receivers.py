# SPDX-License-Identifier: MIT
"""Tiles of receivers: the vertices of a raster, points of a file, or points on the faces of meshes."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .casters import Casters, cells_of_tile, mesh_triangles
from .rasters import UnreadableError
from .settings import Settings
from .suns import zone_of
from .tables import read_points


class Part(NamedTuple):
    """Receivers of a tile that lie in one sun zone.

    rows: (n,) their indices in the tile, flattened. xyz: (n, 3) world coordinates. normals: (n, 3) or None.
    window: for a raster: x (C + 2,), y (R + 2,), heights (R + 2, C + 2); and (R, C) bool, the n vertices inside.
    """

    rows: NDArray[np.int64]
    xyz: NDArray[np.float64]
    zone: tuple[int, int]
    normals: NDArray[np.float64] | None = None
    window: tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]] | None = None


class TileOfReceivers(NamedTuple):
    """is_valid: (n,) whether there is a receiver. is_unknown: (n,) whether its height or that of a neighbour could not
    be read; then all of its answers are undecided. unread: the caster tiles that could not be read. zones: (n, 2)."""

    is_valid: NDArray[np.bool_]
    is_unknown: NDArray[np.bool_]
    unread: list[int]
    zones: NDArray[np.int64]
    parts: list[Part]


class Receivers:
    """shape: rows and columns of all receivers, or their number. chunk: the shape of a tile."""

    shape: tuple[int, ...]
    chunk: tuple[int, ...]

    def __init__(self, settings: Settings) -> None:
        self.settings = settings

    @property
    def counts(self) -> tuple[int, ...]:
        """Tiles along each axis."""
        return tuple(-(-n // c) for n, c in zip(self.shape, self.chunk, strict=True))

    def __len__(self) -> int:
        return int(np.prod(self.counts))

    def slices(self, tile: int) -> tuple[slice, ...]:
        indices = np.unravel_index(tile, self.counts)
        return tuple(
            slice(int(i) * c, min((int(i) + 1) * c, n)) for i, c, n in zip(indices, self.chunk, self.shape, strict=True)
        )

    def key(self, tile: int) -> tuple[int, ...]:
        return tuple(int(i) for i in np.unravel_index(tile, self.counts))

    def tile(self, tile: int) -> TileOfReceivers:
        raise NotImplementedError

    @property
    def box(self) -> tuple[float, float, float, float]:
        raise NotImplementedError


class RasterReceivers(Receivers):
    def __init__(self, settings: Settings, casters: Casters) -> None:
        super().__init__(settings)
        assert casters.mosaic is not None
        self.casters = casters
        self.mosaic = casters.mosaic
        self.shape = (self.mosaic.rows, self.mosaic.columns)
        size = cells_of_tile(settings, self.mosaic, settings.tile)
        self.chunk = (size, size)

    @property
    def box(self) -> tuple[float, float, float, float]:
        x, y = self.mosaic.x(0, self.mosaic.columns), self.mosaic.y(0, self.mosaic.rows)
        return float(x[0]), float(y[-1]), float(x[-1]), float(y[0])

    def tile(self, tile: int) -> TileOfReceivers:
        rows, columns = self.slices(tile)
        window = (rows.start - 1, rows.stop + 1, columns.start - 1, columns.stop + 1)
        heights, is_read, unread = self._heights(*window)
        x, y = self.mosaic.x(*window[2:]), self.mosaic.y(*window[:2])
        inside = (slice(1, -1), slice(1, -1))
        is_unknown = ~is_read[inside]
        for r in range(3):
            for c in range(3):
                is_unknown |= ~is_read[r : r + is_unknown.shape[0], c : c + is_unknown.shape[1]]
        is_valid = ~np.isnan(heights[inside]) | is_unknown
        i, _ = zone_of(x[1:-1], 0.0, self.settings.zone)
        _, j = zone_of(0.0, y[1:-1], self.settings.zone)
        zones = np.stack(np.broadcast_arrays(i[None, :], j[:, None]), axis=-1).reshape(-1, 2)
        parts = []
        for zj in np.unique(j):
            for zi in np.unique(i):
                parts += self._part(x, y, heights, is_valid & ~is_unknown, (i == zi, j == zj), (int(zi), int(zj)))
        return TileOfReceivers(is_valid.reshape(-1), is_unknown.reshape(-1), unread, zones, parts)

    @staticmethod
    def _part(
        x: NDArray[np.float64],
        y: NDArray[np.float64],
        heights: NDArray[np.float64],
        is_receiver: NDArray[np.bool_],
        where: tuple[NDArray[np.bool_], NDArray[np.bool_]],
        zone: tuple[int, int],
    ) -> list[Part]:
        columns, rows = np.flatnonzero(where[0]), np.flatnonzero(where[1])
        r, c = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
        is_inside = is_receiver[r, c]
        if not is_inside.any():
            return []
        positions = np.stack(
            np.broadcast_arrays(x[1:-1][c][None, :], y[1:-1][r][:, None], heights[1:-1, 1:-1][r, c]), axis=-1
        )
        index = np.arange(is_receiver.size).reshape(is_receiver.shape)[r, c]
        r_padded, c_padded = slice(r.start, r.stop + 2), slice(c.start, c.stop + 2)
        window = (x[c_padded], y[r_padded], heights[r_padded, c_padded], is_inside)
        return [Part(index[is_inside], np.ascontiguousarray(positions[is_inside]), zone, None, window)]

    def _heights(
        self, row: int, last_row: int, column: int, last_column: int
    ) -> tuple[NDArray[np.float64], NDArray[np.bool_], list[int]]:
        """Heights of a window; whether each could be read; and the caster tiles of those that could not."""
        is_read = np.ones((last_row - row, last_column - column), bool)
        try:
            return self.mosaic.heights(row, last_row, column, last_column), is_read, []
        except UnreadableError:
            pass
        heights = np.full(is_read.shape, np.nan)
        unread = []
        tiles = self.casters.tiles_of_window(max(row, 0), last_row, max(column, 0), last_column)
        for tile in tiles.tolist():
            r0, r1, c0, c1 = self.casters.window(tile)
            r0, r1, c0, c1 = max(r0, row), min(r1, last_row), max(c0, column), min(c1, last_column)
            if r0 >= r1 or c0 >= c1:
                continue
            part = (slice(r0 - row, r1 - row), slice(c0 - column, c1 - column))
            try:
                heights[part] = self.mosaic.heights(r0, r1, c0, c1)
            except UnreadableError:
                is_read[part] = False
                unread.append(tile)
        return heights, is_read, unread


class PointReceivers(Receivers):
    """Points (N, 3) with or without normals (N, 3), kept in the study's folder."""

    #: Points of a tile are divided into squares of this side, so that lists in no order have small halos.
    SQUARE = 1000.0

    def __init__(self, settings: Settings, file: Path) -> None:
        super().__init__(settings)
        self.values = np.load(file, mmap_mode="r")
        self.shape = (len(self.values),)
        self.chunk = (settings.tile**2,)

    @property
    def box(self) -> tuple[float, float, float, float]:
        low, high = self.values[:, :2].min(axis=0), self.values[:, :2].max(axis=0)
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    def tile(self, tile: int) -> TileOfReceivers:
        values = np.array(self.values[self.slices(tile)[0]])
        zones = np.stack(zone_of(values[:, 0], values[:, 1], self.settings.zone), axis=1)
        squares = np.floor(values[:, :2] / self.SQUARE).astype(np.int64)
        _, group = np.unique(np.concatenate([zones, squares], axis=1), axis=0, return_inverse=True)
        order = np.argsort(group.reshape(-1), kind="stable")
        parts = []
        for rows in np.split(order, np.flatnonzero(np.diff(group.reshape(-1)[order])) + 1):
            normals = values[rows, 3:] if values.shape[1] == 6 else None
            zone = (int(zones[rows[0], 0]), int(zones[rows[0], 1]))
            parts.append(Part(rows, np.ascontiguousarray(values[rows, :3]), zone, normals))
        none = np.zeros(len(values), bool)
        return TileOfReceivers(~none, none, [], zones, parts)


def write_points(settings: Settings, file: Path) -> None:
    """Writes the points of a study into a file of its folder. Raises ValueError."""
    if settings.receivers == "points":
        assert settings.points is not None
        values = read_points(settings.points)
    else:
        values = np.concatenate(
            [points_on_faces(mesh_triangles(settings, name), settings.spacing) for name in settings.meshes]
        )
    if not len(values) and settings.receivers == "faces":
        raise ValueError(f"receivers: 'faces' gives none, for {', '.join(settings.meshes)}: no triangle has an area")
    if not len(values):
        raise ValueError(f"{settings.points}: has no points")
    np.save(file, values)


def points_on_faces(triangles: NDArray[np.float64], spacing: float) -> NDArray[np.float64]:
    """(N, 6) points and normals: each triangle (F, 3, 3) with an area is divided into n x n equal triangles, n the
    longest edge over the spacing, rounded up; the points are their centres. They depend on the triangle alone, not on
    tiles."""
    result = []
    edges = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=2).max(axis=1, initial=0)
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    for triangle, longest, normal in zip(triangles, edges, normals, strict=True):
        if not normal.any():
            continue
        n = max(1, int(np.ceil(longest / spacing)))
        i, j = (k.reshape(-1) for k in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
        up, down = i + j < n, i + j < n - 1
        a = np.concatenate([i[up] + 1 / 3, i[down] + 2 / 3]) / n
        b = np.concatenate([j[up] + 1 / 3, j[down] + 2 / 3]) / n
        positions = triangle[0] + a[:, None] * (triangle[1] - triangle[0]) + b[:, None] * (triangle[2] - triangle[0])
        result.append(np.concatenate([positions, np.broadcast_to(normal, positions.shape)], axis=1))
    return np.concatenate(result) if result else np.empty((0, 6))


def receivers_of(settings: Settings, casters: Casters, folder: Path) -> Receivers:
    if settings.receivers == "raster":
        return RasterReceivers(settings, casters)
    return PointReceivers(settings, folder / "points.npy")
