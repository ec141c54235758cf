# SPDX-License-Identifier: MIT
"""Decides parts of receivers x suns: lit, in shadow, or undecided."""

from __future__ import annotations

import functools
import math
import threading
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import _gnomon
from .._arrays import scaled
from .._devices import Device, default_device, open_device
from .._lattice import Lattice
from .._lights import Lights
from .._scene import Scene
from .._side import Side
from . import planes
from .casters import LARGEST_SPAN, Casters, Survey
from .facing import GridFacing
from .halo import Curvature, Pyramid, leaves_below, per_square_of, rises_above
from .planes import Planes
from .rasters import UnreadableError
from .receivers import Part
from .settings import Settings

#: Bytes that a caster's triangle takes at most: its corners on both sides, its share of the tree, and the loading.
BYTES_PER_TRIANGLE = 400


class Answer(NamedTuple):
    """lit, undecided: planes of the receivers' answers; never both. undecided is None where nothing is. unread: caster
    tiles that could not be read and might have mattered."""

    lit: Planes
    undecided: Planes | None
    unread: list[int]


class _Casters(NamedTuple):
    """Caster tiles that are one scene. here: (n, 3) the receivers' coordinates in its lattice, before any lift."""

    part: Part
    tiles: NDArray[np.int64]
    lattice: _gnomon.WorldLattice
    scene: Scene | None  # None: no tile has a triangle
    here: NDArray[np.float32]


def steps_of(values: NDArray[np.float64], exponent: int) -> NDArray[np.float64]:
    """The nearest whole numbers of steps, half-way cases upwards, as docs/numerics.md, 13 defines them."""
    scaled = np.ldexp(values, -exponent)
    down: NDArray[np.float64] = np.floor(scaled)
    return down + (scaled - down >= 0.5)


def distances(boxes: NDArray[np.float64], box: NDArray[np.float64]) -> NDArray[np.float64]:
    """Horizontal distances of boxes (n, 4), least and greatest x, y, from another one."""
    away = np.maximum(np.maximum(boxes[:, :2] - box[2:], box[:2] - boxes[:, 2:]), 0)
    return np.asarray(np.hypot(away[:, 0], away[:, 1]))


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
        # Threads share a decider, so that one prepares a task while the device works for another one.
        self._facing: tuple[Part, GridFacing] | None = None  # of the last part
        self._facing_lock = threading.Lock()
        self._kept: _Casters | None = None  # of the last part
        self._scene_lock = threading.Lock()  # who has it uses or replaces the only scene

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
        groups = self._groups(tiles, absent, box)
        for i, group in enumerate(groups):
            suns, rows = np.flatnonzero(hit[group].any(axis=0)), None
            if i > 0:  # later ones only where something is left
                is_open = planes.unpacked(np.bitwise_or.reduce(lit, axis=1)[:, None], len(towards))[0]
                suns, rows = suns[is_open[suns]], np.flatnonzero(np.bitwise_or.reduce(lit, axis=0))
            with self._scene_lock:
                casters = self._scene_of(part, at, tiles[group], bend, unread)
                self._shadow(casters, along, at, towards, suns, rows, lit)
                self._kept = casters if len(groups) == 1 and not unread else None
                del casters
        absent |= np.isin(tiles, np.array(unread, np.int64))
        undecided = self._undecided(tiles[absent], hit[absent], at, directions, bend, lit)
        if undecided is not None:
            lit &= ~undecided
        return Answer(lit, undecided, sorted(unread))

    def _faced(self, part: Part, towards: NDArray[np.float32], bend: Curvature) -> Planes:
        if part.window is None:
            return planes.ones(len(towards), len(part.rows))
        with self._facing_lock:
            kept = self._facing
            if kept is None or kept[0] is not part:
                x, y, z, inside = part.window
                z = bend.lowered(x[None, :], y[:, None], z)
                x, y, z = (steps_of(v, self.exponent) for v in (x, y, z))
                self._facing = kept = part, GridFacing(x, y, z, inside)
        return kept[1].faces(towards)

    def _beyond(self, tiles: NDArray[np.int64], box: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Which tiles are not tested: unread ones, those beyond the stated limit, and those that the lattice does not
        hold together with the receivers."""
        boxes = self.survey.boxes[tiles]
        absent = self.survey.unread[tiles].copy()
        if self.settings.halo_limit is not None:
            absent |= distances(boxes, box) > self.settings.halo_limit
        span = np.maximum(boxes[:, 2:], box[2:]) - np.minimum(boxes[:, :2], box[:2])
        return absent | (span > LARGEST_SPAN * self.step).any(axis=1)

    def _groups(self, tiles: NDArray[np.int64], absent: NDArray[np.bool_], box: NDArray[np.float64]) -> list[list[int]]:
        """Indices of the casters, near ones first, as many in a group as the memory limit and the lattice hold."""
        boxes = self.survey.boxes[tiles]
        order = np.lexsort((tiles, distances(boxes, box)))
        most = max(self.settings.memory_limit // BYTES_PER_TRIANGLE, 1)
        groups: list[list[int]] = []
        low, high, count = box[:2], box[2:], 0
        for i in order[~absent[order]].tolist():
            more = int(self.survey.triangles[tiles[i]])
            wider_low, wider_high = np.minimum(low, boxes[i, :2]), np.maximum(high, boxes[i, 2:])
            is_full = count + more > most or (wider_high - wider_low > LARGEST_SPAN * self.step).any()
            if is_full or not groups:
                groups.append([])
                count = 0
                wider_low, wider_high = np.minimum(box[:2], boxes[i, :2]), np.maximum(box[2:], boxes[i, 2:])
            low, high = wider_low, wider_high
            groups[-1].append(i)
            count += more
        return groups

    def _scene_of(
        self, part: Part, at: NDArray[np.float64], tiles: NDArray[np.int64], bend: Curvature, unread: list[int]
    ) -> _Casters:
        """A scene of caster tiles: the last one, with its tree, if it holds them and not more than twice as much. Tiles
        that cannot be read are appended to `unread`."""
        kept, count = self._kept, self.survey.triangles
        holds = kept is not None and kept.part is part and np.isin(tiles, kept.tiles).all()
        if kept is not None and holds and count[kept.tiles].sum() <= 2 * count[tiles].sum():
            return kept
        del kept
        self._kept = None  # its memory is free before more is taken
        vertices, faces, first = [np.empty((0, 3))], [np.empty((0, 3), np.int64)], 0
        for tile in tiles.tolist():
            try:
                v, f = self._mesh(tile, bend)
            except UnreadableError:
                unread.append(tile)
                continue
            vertices.append(v)
            faces.append(f + first)
            first += len(v)
        world, corners = np.concatenate(vertices), np.concatenate(faces)
        low = np.minimum(world.min(axis=0, initial=np.inf), at.min(axis=0))
        high = np.maximum(world.max(axis=0, initial=-np.inf), at.max(axis=0))
        lattice = _gnomon.WorldLattice.around(np.stack([low, high]), self.exponent)
        scene = Scene(lattice.snap(world)[0][corners], device=self.device) if len(corners) else None
        return _Casters(part, tiles, lattice, scene, lattice.snap(at)[0])

    def _mesh(self, tile: int, bend: Curvature) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """The vertices and faces of a caster tile, after curvature. Raises UnreadableError."""
        vertices, faces = self.casters.triangles(tile)
        vertices = vertices.copy()
        vertices[:, 2] = bend.lowered(vertices[:, 0], vertices[:, 1], vertices[:, 2])
        return vertices, faces

    def _along(
        self, part: Part, at: NDArray[np.float64], tiles: NDArray[np.int64], bend: Curvature
    ) -> NDArray[np.float64] | None:
        """(n, 3) normals to lift receivers along, NaN for those that are not lifted; None: no receiver is. Points on
        surfaces are lifted along their normals. A raster's vertex is lifted where a mesh passes within a step of it,
        as by Scene.lit(side=Side.vertices())."""
        if part.normals is not None:
            return scaled(part.normals)
        low, high = at.min(axis=0) - self.pad, at.max(axis=0) + self.pad
        first_mesh = len(self.casters) - len(self.settings.meshes)
        near = [np.empty((0, 3, 3))]
        for tile in tiles[tiles >= first_mesh].tolist():
            try:
                vertices, faces = self._mesh(tile, bend)
            except UnreadableError:
                continue  # the batches find it, too
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
        casters: _Casters,
        along: NDArray[np.float64] | None,
        at: NDArray[np.float64],
        towards: NDArray[np.float32],
        suns: NDArray[np.int64],
        rows: NDArray[np.int64] | None,
        lit: Planes,
    ) -> None:
        """Clears `lit` of these suns and receivers (None: of all) where a caster is in the way. All suns are strictly
        above the horizon, so for a receiver that is not lifted the normal straight up is no restriction; it makes the
        beams tighter."""
        here = casters.here if rows is None else casters.here[rows]
        if casters.scene is None or not (len(suns) and len(here)):
            return
        normals = np.broadcast_to(np.array([0.0, 0.0, 1.0]), here.shape)
        if along is not None:
            of_rows = along if rows is None else along[rows]
            lifted = np.flatnonzero(np.isfinite(of_rows[:, 0]))
            here, normals = here.copy(), normals.copy()
            normals[lifted] = of_rows[lifted]
            world = np.ascontiguousarray(at[lifted if rows is None else rows[lifted]])
            here[lifted] = casters.lattice.lift(world, np.ascontiguousarray(normals[lifted]))
        answer = casters.scene.lit_by(
            here, Lights.directions(-towards[suns]), side=Side.normals(normals), bits=True,
            settings={"many-lights": "beams"},
        )  # fmt: skip
        assert answer.bits is not None
        found = planes.transposed(answer.bits)
        if len(suns) < len(towards):
            others = ~planes.packed(np.isin(np.arange(len(towards)), suns)[None])
            found = planes.moved(found, suns, len(lit)) | others
        if rows is None:
            lit &= found
        else:
            lit[:, rows] &= found

    def _undecided(
        self,
        tiles: NDArray[np.int64],
        hit: NDArray[np.bool_],
        at: NDArray[np.float64],
        towards: NDArray[np.float64],
        bend: Curvature,
        lit: Planes,
    ) -> Planes | None:
        """Which lit answers lack the certificate: their ray may meet a tile that was not tested, or leaves the extent
        below the stated height of what stands outside. None: no answer does."""
        if not len(tiles) and self.settings.outside is None:
            return None
        result = np.zeros_like(lit)
        boxes = self.survey.boxes[tiles]
        tops = self.survey.tops[tiles] - bend.least(boxes)
        point = at[:, [0, 1, 0, 1]]
        for sun in range(len(towards)):
            bit = np.uint32(1 << sun % 32)
            open_rows = np.flatnonzero(planes.of_sun(lit, sun))
            if self.settings.outside is not None and len(open_rows):
                leaves = leaves_below(self.survey.extent, self.settings.outside, at[open_rows], towards[sun], self.pad)
                result[sun // 32, open_rows[leaves]] |= bit
                open_rows = open_rows[~leaves]
            for tile in np.flatnonzero(hit[:, sun]):
                if not len(open_rows):
                    break
                may = rises_above(boxes[tile], tops[tile], point[open_rows], at[open_rows, 2], towards[sun], self.pad)
                result[sun // 32, open_rows[may]] |= bit
                open_rows = open_rows[~may]
        return result


def _face_by_normals(normals: NDArray[np.float32], towards: NDArray[np.float32], lit: Planes) -> None:
    """Clears `lit` where a sun is not strictly on the normal's side: as gnomon decides it, of float32 normals."""
    n, d = normals.astype(np.float64), towards.astype(np.float64)
    largest = np.abs(n).max(axis=1)
    for sun in range(len(d)):
        s = n @ d[sun]
        above = s > 0
        for row in np.flatnonzero(np.abs(s) <= 2e-15 * largest * np.abs(d[sun]).max()):
            above[row] = math.fsum((n[row] * d[sun]).tolist()) > 0  # products of float32 values are exact
        planes.clear(lit, sun, ~above)
