# SPDX-License-Identifier: MIT
"""Decides parts of receivers x suns: lit, in shadow, or undecided."""

from __future__ import annotations

import functools
import threading
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import _gnomon
from .._arrays import scaled
from .._devices import Device, device_of
from .._earth import per_square_of
from .._lattice import Lattice
from .._lights import Lights, LightsResult
from .._scene import Scene
from .._side import Side
from . import planes
from .casters import LARGEST_SPAN, Casters, Survey
from .facing import GridFacing
from .halo import Curvature, Pyramid, leaves_below, rises_above
from .planes import Planes
from .rasters import UnreadableError
from .receivers import Part
from .settings import Settings

#: The most bytes that a caster's triangle takes: its corners on host and device, its share of the BVH, and the loading;
#: and that one of a raster scene takes, on host and device, with its share of the BVH and the sweeps.
BYTES_PER_TRIANGLE, BYTES_PER_RASTER_TRIANGLE = 400, 16
#: The farthest whole numbers of steps from a lattice's origin.
LARGEST_STEPS = 2.0**24


class Answer(NamedTuple):
    """lit, undecided: planes of the receivers' answers; no answer is both. undecided is None where no answer is
    undecided. unread: caster tiles that could not be read and can shadow a receiver."""

    lit: Planes
    undecided: Planes | None
    unread: list[int]


class _CasterScene(NamedTuple):
    """Caster tiles that are one scene. scene: None if no tile has a triangle. snapped: (n, 3) the receivers'
    coordinates in its lattice, before any lift."""

    part: Part
    tiles: NDArray[np.int64]
    lattice: _gnomon.WorldLattice
    scene: Scene | None
    snapped: NDArray[np.float32]


def steps_of(values: NDArray[np.float64], exponent: int) -> NDArray[np.float64]:
    """The nearest whole numbers of steps, half-way cases upwards, as docs/numerics.md, 13 defines them."""
    steps = np.ldexp(values, -exponent)
    below: NDArray[np.float64] = np.floor(steps)
    return below + (steps - below >= 0.5)


class _TooFarError(Exception):
    """Coordinates lie too far from a lattice's origin."""


def _from_origin(values: NDArray[np.float64], origin: int, exponent: int) -> NDArray[np.float32]:
    """Coordinates along one axis as WorldLattice.snap() gives them, where NaN stays NaN. Raises _TooFarError."""
    steps = steps_of(values, exponent)
    steps -= origin
    if (np.abs(steps) > LARGEST_STEPS).any():
        raise _TooFarError
    return np.ldexp(steps.astype(np.float32), exponent)


def box_of(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """(2, 3): the least and the greatest coordinates of points (n, 3); infinite if there are none. By columns, since
    numpy's minima of many short rows take 20 times as long."""
    low = [points[:, axis].min(initial=np.inf) for axis in range(3)]
    return np.array([low, [points[:, axis].max(initial=-np.inf) for axis in range(3)]])


def distances(boxes: NDArray[np.float64], box: NDArray[np.float64]) -> NDArray[np.float64]:
    """Horizontal distances of boxes (n, 4), x0, y0, x1, y1, from another box."""
    apart = np.maximum(np.maximum(boxes[:, :2] - box[2:], box[:2] - boxes[:, 2:]), 0)
    return np.asarray(np.hypot(apart[:, 0], apart[:, 1]))


@functools.lru_cache(maxsize=4)
def _opened_device(name: str | None) -> Device:
    return device_of(name)


class Decider:
    """Decides the parts of all tasks of a study. The lattice's step is 2^exponent."""

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
        self._kept: _CasterScene | None = None  # the scene of the last part
        self._scene_lock = threading.Lock()  # held while a thread uses or replaces the only scene

    @property
    def device(self) -> Device:
        return _opened_device(self.device_name)

    @functools.cached_property
    def _empty_scene(self) -> Scene:
        """A point in it is lit where the light is strictly on its normal's side."""
        return Scene(np.empty((0, 3, 3), np.float32), device=self.device)

    def curvature(self, centre: tuple[float, float]) -> Curvature:
        per_square = per_square_of(self.settings.refraction_of_ground) if self.settings.curvature else 0.0
        return Curvature(*centre, per_square)

    def decide(self, part: Part, towards: NDArray[np.float32], centre: tuple[float, float]) -> Answer:
        """The answers of a part's receivers for suns (M, 3), all of them above the horizon."""
        curvature = self.curvature(centre)
        positions = part.xyz.copy()
        positions[:, 2] = curvature.lowered(positions[:, 0], positions[:, 1], positions[:, 2])
        lit = self._facing_of(part, towards, curvature)
        is_faced = np.zeros(len(towards), bool)  # suns for which a scene has decided the receivers' sides, too
        low, high = box_of(positions)
        box = np.array([low[0], low[1], high[0], high[1]])
        directions = towards.astype(np.float64)
        tiles, hit = self.pyramid.tiles_that_can_shadow(box, float(low[2]), directions, curvature, self.pad)
        is_untested = self._is_untested(tiles, box)
        unread: list[int] = tiles[self.survey.unread[tiles]].tolist()
        lift_normals = self._normals_to_lift_along(part, positions, tiles[~is_untested], curvature)
        groups = self._groups(tiles, is_untested, box)
        for i, group in enumerate(groups):
            suns, rows = np.flatnonzero(hit[group].any(axis=0)), None
            if i > 0:  # later groups are asked about open answers alone
                is_open = planes.unpacked(np.bitwise_or.reduce(lit, axis=1)[:, None], len(towards))[0]
                suns, rows = suns[is_open[suns]], np.flatnonzero(np.bitwise_or.reduce(lit, axis=0))
            with self._scene_lock:
                of_group = self._filled(tiles[group], tiles)
                casters = self._load_scene(part, positions, of_group, curvature, unread, tiles[is_untested])
                is_faced[suns] |= self._shadow(casters, lift_normals, positions, towards, suns, rows, lit)
                self._kept = casters if len(groups) == 1 and not unread else None
                del casters
        if part.normals is not None:
            self._clear_behind(part.normals, towards, np.flatnonzero(~is_faced), lit)
        is_untested |= np.isin(tiles, np.array(unread, np.int64))
        undecided = self._undecided(tiles[is_untested], hit[is_untested], positions, directions, curvature, lit)
        if undecided is not None:
            lit &= ~undecided
        return Answer(lit, undecided, sorted(unread))

    def _facing_of(self, part: Part, towards: NDArray[np.float32], curvature: Curvature) -> Planes:
        """The planes of whether each sun is on a raster's side. Other receivers face all suns here."""
        if part.window is None:
            return planes.ones(len(towards), len(part.rows))
        with self._facing_lock:
            kept = self._facing
            if kept is None or kept[0] is not part:
                x, y, z, inside = part.window
                z = curvature.lowered(x[None, :], y[:, None], z)
                x, y, z = (steps_of(v, self.exponent) for v in (x, y, z))
                self._facing = kept = part, GridFacing(x, y, z, inside)
        return kept[1].faces(towards)

    def _clear_behind(
        self, normals: NDArray[np.float64], towards: NDArray[np.float32], suns: NDArray[np.int64], lit: Planes
    ) -> None:
        """Clears `lit` where one of these suns is not strictly on the normal's side."""
        if not len(suns):
            return
        points = np.zeros(normals.shape, np.float32)
        lights = Lights.directions(-towards[suns])
        _clear_others(lit, self._empty_scene.lit_by(points, lights, side=Side.normals(normals), bits=True), suns, None)

    def _is_untested(self, tiles: NDArray[np.int64], box: NDArray[np.float64]) -> NDArray[np.bool_]:
        """(T,): tiles that are unread, farther away than the stated limit, or too far for one lattice with the
        receivers."""
        boxes = self.survey.boxes[tiles]
        is_untested = self.survey.unread[tiles].copy()
        if self.settings.halo_limit is not None:
            is_untested |= distances(boxes, box) > self.settings.halo_limit
        span = np.maximum(boxes[:, 2:], box[2:]) - np.minimum(boxes[:, :2], box[:2])
        return is_untested | (span > LARGEST_SPAN * self.step).any(axis=1)

    def _groups(
        self, tiles: NDArray[np.int64], is_untested: NDArray[np.bool_], box: NDArray[np.float64]
    ) -> list[list[int]]:
        """Indices of tested tiles, nearest first. A group has as many as the memory limit and the lattice hold."""
        boxes = self.survey.boxes[tiles]
        order = np.lexsort((tiles, distances(boxes, box)))
        tested = order[~is_untested[order]]
        if self._are_one_raster(tiles[tested], box):
            return [tested.tolist()]
        max_triangles = max(self.settings.memory_limit // BYTES_PER_TRIANGLE, 1)
        groups: list[list[int]] = []
        low, high, count = box[:2], box[2:], 0
        for i in tested.tolist():
            triangles = int(self.survey.triangles[tiles[i]])
            wider_low, wider_high = np.minimum(low, boxes[i, :2]), np.maximum(high, boxes[i, 2:])
            is_full = count + triangles > max_triangles or (wider_high - wider_low > LARGEST_SPAN * self.step).any()
            if is_full or not groups:
                groups.append([])
                count = 0
                wider_low, wider_high = np.minimum(box[:2], boxes[i, :2]), np.maximum(box[2:], boxes[i, 2:])
            low, high = wider_low, wider_high
            groups[-1].append(i)
            count += triangles
        return groups

    def _fits_as_raster(self, window: tuple[int, int, int, int]) -> bool:
        r0, r1, c0, c1 = window
        return 2 * (r1 - r0) * (c1 - c0) * BYTES_PER_RASTER_TRIANGLE <= self.settings.memory_limit

    def _are_one_raster(self, tiles: NDArray[np.int64], box: NDArray[np.float64]) -> bool:
        """Whether these tiles can be one raster scene."""
        found = self.casters.rectangle_of(tiles)
        if found is None or not self._fits_as_raster(found[0]):
            return False
        boxes = self.survey.boxes[tiles]
        span = np.maximum(boxes[:, 2:].max(axis=0), box[2:]) - np.minimum(boxes[:, :2].min(axis=0), box[:2])
        return bool((span <= LARGEST_SPAN * self.step).all())

    def _filled(self, group: NDArray[np.int64], tiles: NDArray[np.int64]) -> NDArray[np.int64]:
        """A group of raster tiles filled up to a rectangle, which is decided faster, by tiles that can shadow no
        receiver: those that are not in `tiles`. The group itself where a tile is another one, cannot be read, or where
        the rectangle has more than 1.5 times its triangles, or too many."""
        found = self.casters.rectangle_of(group)
        if found is None:
            return group
        window, more = found
        triangles = self.survey.triangles
        is_large = triangles[more].sum() > 0.5 * triangles[group].sum() or not self._fits_as_raster(window)
        is_barred = np.isin(more, tiles).any() or self.survey.unread[more].any()
        return group if is_large or is_barred else np.union1d(group, more)

    def _load_scene(
        self,
        part: Part,
        positions: NDArray[np.float64],
        tiles: NDArray[np.int64],
        curvature: Curvature,
        unread: list[int],
        barred: NDArray[np.int64],
    ) -> _CasterScene:
        """A scene of caster tiles: the kept one, with its BVH, if it holds these tiles and at most twice their
        triangles. Tiles that cannot be read are appended to `unread`. `barred`: tiles of which it has no triangle."""
        kept, count = self._kept, self.survey.triangles
        holds = kept is not None and kept.part is part and np.isin(tiles, kept.tiles).all()
        if kept is not None and holds and count[kept.tiles].sum() <= 2 * count[tiles].sum():
            return kept
        del kept
        self._kept = None  # frees its memory before the new scene takes some
        raster = self._load_raster(tiles, positions, curvature, barred)
        if raster is not None:
            lattice, scene = raster
            return _CasterScene(part, tiles, lattice, scene, lattice.snap(positions)[0])
        meshes = []
        for tile in tiles.tolist():
            try:
                meshes.append(self._mesh(tile, curvature))
            except UnreadableError:
                unread.append(tile)
        boxes = np.stack([box_of(positions), *(box_of(vertices) for vertices, _ in meshes)])
        box = np.stack([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])
        lattice = _gnomon.WorldLattice.around(box, self.exponent)
        triangles = _snapped_triangles(meshes, lattice)
        scene = Scene(triangles, device=self.device) if len(triangles) else None
        return _CasterScene(part, tiles, lattice, scene, lattice.snap(positions)[0])

    def _load_raster(
        self, tiles: NDArray[np.int64], positions: NDArray[np.float64], curvature: Curvature, barred: NDArray[np.int64]
    ) -> tuple[_gnomon.WorldLattice, Scene] | None:
        """The scene of raster tiles as a raster: without its triangles. Other tiles in their rectangle have no heights,
        but for those that they share with these tiles: their triangles may be in the scene, unless they are `barred`.
        None: the tiles are no raster, or cannot be read."""
        found = self.casters.rectangle_of(tiles)
        if found is None or not self._fits_as_raster(found[0]) or np.isin(found[1], barred).any():
            return None
        assert self.casters.mosaic is not None
        r0, r1, c0, c1 = found[0]
        x, y = self.casters.mosaic.x(c0, c1), self.casters.mosaic.y(r0, r1)
        box = box_of(positions)
        ends = [[x[0], y[0], box[0, 2]], [x[-1], y[-1], box[1, 2]]]
        lattice = _gnomon.WorldLattice.around(np.concatenate([box, ends]), self.exponent)
        heights = np.full((len(y), len(x)), np.nan, np.float32)
        try:
            columns, rows = (_from_origin(v, o, self.exponent) for v, o in zip((x, y), lattice.origin, strict=False))
            windows = [self.casters.window(tile) for tile in tiles.tolist()]
            if not len(found[1]):  # a row of tiles is read at once
                windows = [(t0, t1, c0, c1) for t0, t1 in dict.fromkeys(window[:2] for window in windows)]
            for t0, t1, s0, s1 in windows:
                part = self.casters.mosaic.heights(t0, t1, s0, s1)
                part = curvature.lowered(x[None, s0 - c0 : s1 - c0], y[t0 - r0 : t1 - r0, None], part)
                snapped = _from_origin(part, lattice.origin[2], self.exponent)
                heights[t0 - r0 : t1 - r0, s0 - c0 : s1 - c0] = snapped
        except (UnreadableError, _TooFarError):
            return None
        if not (np.diff(columns).all() and np.diff(rows).all()):
            return None
        return lattice, Scene.from_raster(columns, rows, heights, device=self.device)

    def _mesh(self, tile: int, curvature: Curvature) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """The vertices and faces of a caster tile, after curvature. Raises UnreadableError."""
        vertices, faces = self.casters.triangles(tile)
        vertices = vertices.copy()
        vertices[:, 2] = curvature.lowered(vertices[:, 0], vertices[:, 1], vertices[:, 2])
        return vertices, faces

    def _normals_to_lift_along(
        self, part: Part, positions: NDArray[np.float64], tiles: NDArray[np.int64], curvature: Curvature
    ) -> NDArray[np.float64] | None:
        """(n, 3) normals to lift receivers along, NaN for receivers that are not lifted; None: no receiver is lifted.
        Points on surfaces are lifted along their normals. A raster's vertex is lifted where a mesh passes within a step
        of it, as by Scene.lit(side=Side.vertices())."""
        if part.normals is not None:
            return scaled(part.normals)
        low, high = box_of(positions)
        low, high = low - self.pad, high + self.pad
        first_mesh = len(self.casters) - len(self.settings.meshes)
        near = [np.empty((0, 3, 3))]
        for tile in tiles[tiles >= first_mesh].tolist():
            try:
                vertices, faces = self._mesh(tile, curvature)
            except UnreadableError:
                continue  # _load_scene() notes it
            corners = vertices[faces]
            meets = (corners.max(axis=1) >= low).all(axis=1) & (corners.min(axis=1) <= high).all(axis=1)
            near.append(corners[meets])
        meshes = np.concatenate(near)
        if part.window is None or not len(meshes):
            return None
        low, high = meshes.min(axis=(0, 1)) - self.pad, meshes.max(axis=(0, 1)) + self.pad
        rows = np.flatnonzero(((positions >= low) & (positions <= high)).all(axis=1))
        if not len(rows):
            return None
        snapped = np.ascontiguousarray(positions[rows])
        triangles = np.concatenate(
            [meshes, np.repeat(snapped[:, None], 3, axis=1)]
        )  # a vertex is a corner of a triangle
        corners = triangles.reshape(-1, 3)
        lattice = _gnomon.WorldLattice.around(np.stack([corners.min(axis=0), corners.max(axis=0)]), self.exponent)
        found, normals = Lattice(lattice, triangles).normals_where_touching(lattice.snap(snapped)[0], (0.0, 0.0, 1.0))
        lift_normals = np.full(positions.shape, np.nan)
        lift_normals[rows[found]] = normals
        return lift_normals if len(found) else None

    def _shadow(
        self,
        casters: _CasterScene,
        lift_normals: NDArray[np.float64] | None,
        positions: NDArray[np.float64],
        towards: NDArray[np.float32],
        suns: NDArray[np.int64],
        rows: NDArray[np.int64] | None,
        lit: Planes,
    ) -> bool:
        """Clears `lit` of these suns and receivers (None: of all) where a caster blocks the ray, or the sun is not
        strictly on the side of a lifted receiver's normal. Returns whether it did so for all receivers. All suns are
        strictly above the horizon, so the vertical normal of a receiver that is not lifted restricts nothing; it makes
        the beams tighter."""
        snapped = casters.snapped if rows is None else casters.snapped[rows]
        if casters.scene is None or not (len(suns) and len(snapped)):
            return False
        normals = np.broadcast_to(np.array([0.0, 0.0, 1.0]), snapped.shape)
        if lift_normals is not None:
            of_rows = lift_normals if rows is None else lift_normals[rows]
            lifted = np.flatnonzero(np.isfinite(of_rows[:, 0]))
            snapped, normals = snapped.copy(), normals.copy()
            normals[lifted] = of_rows[lifted]
            world = np.ascontiguousarray(positions[lifted if rows is None else rows[lifted]])
            snapped[lifted] = casters.lattice.lift(world, np.ascontiguousarray(normals[lifted]))
        lights = Lights.directions(-towards[suns])
        answer = casters.scene.lit_by(snapped, lights, side=Side.normals(normals), bits=True)
        _clear_others(lit, answer, suns, rows)
        return rows is None

    def _undecided(
        self,
        tiles: NDArray[np.int64],
        hit: NDArray[np.bool_],
        positions: NDArray[np.float64],
        towards: NDArray[np.float64],
        curvature: Curvature,
        lit: Planes,
    ) -> Planes | None:
        """The planes of lit answers without a certificate: the ray may meet an untested tile, or leaves the extent
        below the stated height of what stands outside. None: every lit answer has its certificate."""
        if not len(tiles) and self.settings.outside is None:
            return None
        result = np.zeros_like(lit)
        boxes = self.survey.boxes[tiles]
        tops = self.survey.tops[tiles] - curvature.least(boxes)
        boxes_of_points = positions[:, [0, 1, 0, 1]]
        for sun in range(len(towards)):
            bit = np.uint32(1 << sun % 32)
            open_rows = np.flatnonzero(planes.of_sun(lit, sun))
            if self.settings.outside is not None and len(open_rows):
                leaves = leaves_below(
                    self.survey.extent, self.settings.outside, positions[open_rows], towards[sun], self.pad
                )
                result[sun // 32, open_rows[leaves]] |= bit
                open_rows = open_rows[~leaves]
            for tile in np.flatnonzero(hit[:, sun]):
                if not len(open_rows):
                    break
                meets_tile = rises_above(
                    boxes[tile], tops[tile], boxes_of_points[open_rows], positions[open_rows, 2], towards[sun], self.pad
                )
                result[sun // 32, open_rows[meets_tile]] |= bit
                open_rows = open_rows[~meets_tile]
        return result


def _snapped_triangles(
    meshes: list[tuple[NDArray[np.float64], NDArray[np.int64]]], lattice: _gnomon.WorldLattice
) -> NDArray[np.float32]:
    """(F, 3, 3): the triangles of meshes in a lattice. One mesh at a time, since pages that are touched for the first
    time take as long as all else."""
    ends = np.cumsum([0, *(len(faces) for _, faces in meshes)])
    triangles = np.empty((ends[-1], 3, 3), np.float32)
    for (vertices, faces), first in zip(meshes, ends[:-1], strict=True):
        part = triangles[first : first + len(faces)]
        np.take(lattice.snap(vertices)[0], faces, axis=0, out=part, mode="clip")  # "raise" would copy all of `part`
    return triangles


def _clear_others(lit: Planes, answer: LightsResult, suns: NDArray[np.int64], rows: NDArray[np.int64] | None) -> None:
    """Clears `lit` of these suns and receivers (None: of all) where the answer is not lit."""
    assert answer.bits is not None
    found = planes.transposed(answer.bits)
    if len(suns) < 32 * len(lit):
        is_asked = np.zeros((1, 32 * len(lit)), bool)
        is_asked[0, suns] = True
        found = planes.moved(found, suns, len(lit)) | ~planes.packed(is_asked)
    if rows is None:
        lit &= found
    else:
        lit[:, rows] &= found
