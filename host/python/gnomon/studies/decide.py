# SPDX-License-Identifier: MIT
"""Decides parts of receivers x suns: lit, in shadow, or undecided."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import _gnomon
from .._arrays import scaled
from .._devices import Device, default_device, open_device
from .._lattice import Lattice
from .._scene import Scene
from .casters import LARGEST_SPAN, Casters, Survey
from .facing import GridFacing
from .halo import Curvature, Pyramid, leaves_below, per_square_of, rises_above
from .rasters import UnreadableError
from .receivers import Part
from .settings import Settings

#: Receivers that are unpacked at once stay in the cache.
ROWS_AT_ONCE = 4096
#: Bytes that a caster's triangle takes at most: its corners on both sides, its share of the tree, and the loading.
BYTES_PER_TRIANGLE = 400


class Answer(NamedTuple):
    """lit, undecided: (n, M) bool; never both. unread: caster tiles that could not be read and might have mattered."""

    lit: NDArray[np.bool_]
    undecided: NDArray[np.bool_]
    unread: list[int]


class _Batch(NamedTuple):
    """Caster tiles that are one scene: triangles (F, 3) of vertices (V, 3), after curvature, before snapping."""

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    suns: NDArray[np.bool_]  # (M,) for which suns one of the tiles matters


def steps_of(values: NDArray[np.float64], exponent: int) -> NDArray[np.float64]:
    """The nearest whole numbers of steps, half-way cases upwards, as docs/numerics.md, 13 defines them."""
    scaled = np.ldexp(values, -exponent)
    down: NDArray[np.float64] = np.floor(scaled)
    return down + (scaled - down >= 0.5)


@functools.lru_cache(maxsize=4)
def device_of(name: str | None) -> Device:
    return default_device() if name is None else open_device(name)


class Decider:
    """What all tasks of a study share. exponent: of the lattice's step, a power of two."""

    def __init__(
        self, settings: Settings, casters: Casters, survey: Survey, exponent: int, device: str | None = None
    ) -> None:
        self.settings = settings
        self.casters = casters
        self.survey = survey
        self.exponent = exponent
        self.step = 2.0**exponent
        self.pad = 8 * self.step
        self.device_name = device
        self.pyramid = Pyramid(survey.boxes, survey.tops)

    @property
    def device(self) -> Device:
        return device_of(self.device_name)

    def curvature(self, centre: tuple[float, float]) -> Curvature:
        per_square = per_square_of(self.settings.refraction_of_ground) if self.settings.curvature else 0.0
        return Curvature(*centre, per_square)

    def decide(self, part: Part, towards: NDArray[np.float32], centre: tuple[float, float]) -> Answer:
        """The answers of a part's receivers for suns (M, 3) that are all above the horizon."""
        bend = self.curvature(centre)
        at = part.xyz.copy()
        at[:, 2] = bend.lowered(at[:, 0], at[:, 1], at[:, 2])
        lit = self._faced(part, towards, bend)
        if part.normals is not None:
            _face_by_normals(scaled(part.normals).astype(np.float32), towards, lit)
        low, high = at.min(axis=0), at.max(axis=0)
        box = np.array([low[0], low[1], high[0], high[1]])
        directions = towards.astype(np.float64)
        tiles, hit = self.pyramid.that_matter(box, float(low[2]), directions, bend, self.pad)
        absent = self._beyond(tiles, box)
        unread: list[int] = tiles[self.survey.unread[tiles]].tolist()
        along = self._along(part, at, tiles[~absent], bend)
        for i, batch in enumerate(self._batches(tiles, hit, absent, box, bend, unread)):
            self._shadow(batch, along, at, towards, lit, is_first=i == 0)
        absent |= np.isin(tiles, np.array(unread, np.int64))
        undecided = self._undecided(tiles[absent], hit[absent], at, directions, bend, lit)
        return Answer(lit & ~undecided, undecided, sorted(unread))

    def _faced(self, part: Part, towards: NDArray[np.float32], bend: Curvature) -> NDArray[np.bool_]:
        if part.window is None:
            return np.ones((len(part.rows), len(towards)), bool)
        x, y, z, inside = part.window
        z = bend.lowered(x[None, :], y[:, None], z)
        x, y, z = (steps_of(v, self.exponent) for v in (x, y, z))
        return GridFacing(x, y, z, inside).faces(towards)

    def _beyond(self, tiles: NDArray[np.int64], box: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Which tiles are not tested: unread ones, those beyond the stated limit, and those that the lattice does not
        hold together with the receivers."""
        boxes = self.survey.boxes[tiles]
        absent = self.survey.unread[tiles].copy()
        if self.settings.halo_limit is not None:
            away = np.maximum(np.maximum(boxes[:, :2] - box[2:], box[:2] - boxes[:, 2:]), 0)
            absent |= np.hypot(away[:, 0], away[:, 1]) > self.settings.halo_limit
        span = np.maximum(boxes[:, 2:], box[2:]) - np.minimum(boxes[:, :2], box[:2])
        return absent | (span > LARGEST_SPAN * self.step).any(axis=1)

    def _batches(
        self,
        tiles: NDArray[np.int64],
        hit: NDArray[np.bool_],
        absent: NDArray[np.bool_],
        box: NDArray[np.float64],
        bend: Curvature,
        unread: list[int],
    ) -> Iterator[_Batch]:
        """The casters, near ones first, as many at once as the memory limit and the lattice hold. Tiles that cannot be
        read are appended to `unread`."""
        boxes = self.survey.boxes[tiles]
        away = np.maximum(np.maximum(boxes[:, :2] - box[2:], box[:2] - boxes[:, 2:]), 0)
        order = np.lexsort((tiles, np.hypot(away[:, 0], away[:, 1])))
        most = max(self.settings.memory_limit // BYTES_PER_TRIANGLE, 1)
        group: list[int] = []
        low, high, count = box[:2], box[2:], 0
        for i in order[~absent[order]].tolist():
            more = int(self.survey.triangles[tiles[i]])
            wider_low, wider_high = np.minimum(low, boxes[i, :2]), np.maximum(high, boxes[i, 2:])
            if group and (count + more > most or (wider_high - wider_low > LARGEST_SPAN * self.step).any()):
                yield self._loaded(tiles, group, hit, bend, unread)
                group, count = [], 0
                wider_low, wider_high = np.minimum(box[:2], boxes[i, :2]), np.maximum(box[2:], boxes[i, 2:])
            low, high = wider_low, wider_high
            group.append(i)
            count += more
        if group:
            yield self._loaded(tiles, group, hit, bend, unread)

    def _loaded(
        self, tiles: NDArray[np.int64], group: list[int], hit: NDArray[np.bool_], bend: Curvature, unread: list[int]
    ) -> _Batch:
        vertices, faces, first = [np.empty((0, 3))], [np.empty((0, 3), np.int64)], 0
        for tile in tiles[group].tolist():
            try:
                v, f = self.casters.triangles(tile)
            except UnreadableError:
                unread.append(tile)
                continue
            v = v.copy()
            v[:, 2] = bend.lowered(v[:, 0], v[:, 1], v[:, 2])
            vertices.append(v)
            faces.append(f + first)
            first += len(v)
        return _Batch(np.concatenate(vertices), np.concatenate(faces), np.asarray(hit[group].any(axis=0)))

    def _along(
        self, part: Part, at: NDArray[np.float64], tiles: NDArray[np.int64], bend: Curvature
    ) -> NDArray[np.float64] | None:
        """(n, 3) normals to lift receivers along, NaN for those that are not lifted; None: no receiver is. Points on
        surfaces are lifted along their normals. A raster's vertex is lifted where a mesh passes within a step of it,
        as by Scene.lit(receivers="vertices")."""
        if part.normals is not None:
            return scaled(part.normals)
        low, high = at.min(axis=0) - self.pad, at.max(axis=0) + self.pad
        first_mesh = len(self.casters) - len(self.settings.meshes)
        near = [np.empty((0, 3, 3))]
        for tile in tiles[tiles >= first_mesh].tolist():
            try:
                vertices, faces = self.casters.triangles(tile)
            except UnreadableError:
                continue  # the batches find it, too
            vertices = vertices.copy()
            vertices[:, 2] = bend.lowered(vertices[:, 0], vertices[:, 1], vertices[:, 2])
            corners = vertices[faces]
            meets = (corners.max(axis=1) >= low).all(axis=1) & (corners.min(axis=1) <= high).all(axis=1)
            near.append(corners[meets])
        meshes = np.concatenate(near)
        if part.window is None or not len(meshes):
            return None
        low, high = meshes.min(axis=(0, 1)) - self.pad, meshes.max(axis=(0, 1)) + self.pad
        rows = np.flatnonzero(((at >= low) & (at <= high)).all(axis=1))
        if not len(rows):
            return None
        here = np.ascontiguousarray(at[rows])
        triangles = np.concatenate([meshes, np.repeat(here[:, None], 3, axis=1)])  # a vertex is a corner of something
        corners = triangles.reshape(-1, 3)
        lattice = _gnomon.WorldLattice.around(np.stack([corners.min(axis=0), corners.max(axis=0)]), self.exponent)
        found, normals = Lattice(lattice, triangles).normals_where_touching(lattice.snap(here)[0], (0.0, 0.0, 1.0))
        along = np.full(at.shape, np.nan)
        along[rows[found]] = normals
        return along if len(found) else None

    def _shadow(
        self,
        batch: _Batch,
        along: NDArray[np.float64] | None,
        at: NDArray[np.float64],
        towards: NDArray[np.float32],
        lit: NDArray[np.bool_],
        is_first: bool,
    ) -> None:
        """Clears `lit` where a triangle of the batch is in the way. All suns are strictly above the horizon, so for a
        receiver that is not lifted the normal straight up is no restriction; it makes the shafts tighter."""
        suns, rows = np.flatnonzero(batch.suns), np.arange(len(lit))
        if not is_first:  # later ones only where something is left
            suns, rows = np.flatnonzero(batch.suns & lit.any(axis=0)), np.flatnonzero(lit.any(axis=1))
        if not (len(suns) and len(rows) and len(batch.faces)):
            return
        both = np.concatenate([batch.vertices, at])
        lattice = _gnomon.WorldLattice.around(np.stack([both.min(axis=0), both.max(axis=0)]), self.exponent)
        triangles = lattice.snap(batch.vertices)[0][batch.faces]
        world = np.ascontiguousarray(at[rows])
        here = lattice.snap(world)[0]
        normals = np.broadcast_to(np.array([0.0, 0.0, 1.0]), here.shape)
        if along is not None:
            lifted = np.flatnonzero(np.isfinite(along[rows, 0]))
            normals = normals.copy()
            normals[lifted] = along[rows[lifted]]
            here[lifted] = lattice.lift(np.ascontiguousarray(world[lifted]), np.ascontiguousarray(normals[lifted]))
        with Scene(triangles, device=self.device) as scene:
            answer = scene.many_lights(
                here, directions=-towards[suns], normals=normals, bits=True, settings={"many-lights": "shafts"}
            )
        assert answer.bits is not None
        as_bytes = answer.bits.astype("<u4", copy=False).view(np.uint8)
        is_whole = len(suns) == lit.shape[1] and len(rows) == lit.shape[0]
        for first in range(0, len(rows), ROWS_AT_ONCE):
            part = slice(first, first + ROWS_AT_ONCE)
            bits = np.unpackbits(as_bytes[part], axis=-1, bitorder="little", count=len(suns)).view(bool)
            if is_whole:
                lit[part] &= bits
            else:
                lit[np.ix_(rows[part], suns)] &= bits

    def _undecided(
        self,
        tiles: NDArray[np.int64],
        hit: NDArray[np.bool_],
        at: NDArray[np.float64],
        towards: NDArray[np.float64],
        bend: Curvature,
        lit: NDArray[np.bool_],
    ) -> NDArray[np.bool_]:
        """Which lit answers lack the certificate: their ray may meet a tile that was not tested, or leaves the extent
        below the stated height of what stands outside."""
        result = np.zeros(lit.shape, bool)
        if not len(tiles) and self.settings.outside is None:
            return result
        boxes = self.survey.boxes[tiles]
        tops = self.survey.tops[tiles] - bend.least(boxes)
        point = at[:, [0, 1, 0, 1]]
        for sun in range(lit.shape[1]):
            open_rows = np.flatnonzero(lit[:, sun])
            if self.settings.outside is not None and len(open_rows):
                leaves = leaves_below(self.survey.extent, self.settings.outside, at[open_rows], towards[sun], self.pad)
                result[open_rows[leaves], sun] = True
                open_rows = open_rows[~leaves]
            for tile in np.flatnonzero(hit[:, sun]):
                if not len(open_rows):
                    break
                may = rises_above(boxes[tile], tops[tile], point[open_rows], at[open_rows, 2], towards[sun], self.pad)
                result[open_rows[may], sun] = True
                open_rows = open_rows[~may]
        return result


def _face_by_normals(normals: NDArray[np.float32], towards: NDArray[np.float32], lit: NDArray[np.bool_]) -> None:
    """Clears `lit` where a sun is not strictly on the normal's side: as gnomon decides it, of float32 normals."""
    n, d = normals.astype(np.float64), towards.astype(np.float64)
    for sun in range(len(d)):
        s = n @ d[sun]
        above = s > 0
        for row in np.flatnonzero(np.abs(s) <= 2e-15 * np.abs(n).max(axis=1) * np.abs(d[sun]).max()):
            above[row] = math.fsum((n[row] * d[sun]).tolist()) > 0  # products of float32 values are exact
        lit[:, sun] &= above
