# SPDX-License-Identifier: MIT
"""The lit share of surfaces, as intervals that are proven to contain it (docs/shares.md)."""

from __future__ import annotations

import datetime
import os
import threading
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _gnomon, _meshes
from . import _lattice as _world
from ._files import write_whole

#: A polygon whose corners lie farther off one plane than this part of its extent is named in Surfaces.not_planar.
PLANAR = 1e-6


@dataclass(frozen=True, eq=False)
class Surfaces:
    """Polygons as triangles, made by polygons().

    triangles: (F, 3, 3), those of the polygons, then the occluders'.
    faces: (F,) the polygon that a triangle is part of; -1 for an occluder.
    not_planar: the rows of polygons that lie in no plane; they are taken as their triangles.
    """

    triangles: NDArray[np.float64]
    faces: NDArray[np.int32]
    not_planar: NDArray[np.int64]


class LitFractions(NamedTuple):
    """low, high: (faces, suns) the lit share of each face is at least and at most this.
    centroid: (faces, suns, 3) of the part that is proven lit, NaN where there is none; None unless asked for.
    """

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    centroid: NDArray[np.float64] | None

    def shaded(self) -> NDArray[np.float64]:
        """(faces, suns) the middle of each interval as pvlib's shaded fraction: 1 where nothing is lit."""
        return 1 - (self.low + self.high) / 2

    def write_table(self, path: str | os.PathLike[str], names: Sequence[str], times: Sequence[Any]) -> None:
        """A CSV file with a row for each time and two columns, lowest and highest share, for each face; and the x, y, z
        of its centroid, if there are centroids, empty where nothing is lit."""
        ends, values = ["low", "high"], [self.low, self.high]
        if self.centroid is not None:
            ends, values = [*ends, *"xyz"], [*values, *np.moveaxis(self.centroid, 2, 0)]
        columns = [f"{name} {end}" for name in _checked(names, times, self.low) for end in ends]
        _write_rows(path, ",".join(["time", *columns]), times, np.stack(values, axis=1))

    def write_shaded(self, path: str | os.PathLike[str], names: Sequence[str], times: Sequence[Any]) -> None:
        """A CSV file with a row for each time and a column for each face: shaded()."""
        _write_rows(path, ",".join(["time", *_checked(names, times, self.low)]), times, self.shaded()[:, None])

    def write_energyplus(self, path: str | os.PathLike[str], names: Sequence[str], times: Sequence[Any]) -> None:
        """The middles in the layout of the file that EnergyPlus writes as its external shading results, for its
        Schedule:File:Shading. times: the end of each time step, with month, day, hour and minute. Not run there."""
        head = "Surface Name," + "".join(f"{name}," for name in _checked(names, times, self.low))
        middle = (self.low + self.high) / 2
        rows = [f" {_end_text(t)}," + "".join(f"{v:.8f}," for v in middle[:, m]) + "\n" for m, t in enumerate(times)]
        write_whole(Path(path), head + "\n" + "".join(rows))


def _end_text(time: Any) -> str:
    """The end of a time step; midnight is the 24th hour of the day before."""
    if (time.hour, time.minute) != (0, 0):
        return f"{time:%m/%d %H:%M}"
    return f"{time - datetime.timedelta(days=1):%m/%d} 24:00"


def _write_rows(path: str | os.PathLike[str], head: str, times: Sequence[Any], values: NDArray[np.float64]) -> None:
    """A table of (faces, columns of a face, times), with all digits, so that intervals stay what they are; NaN as
    nothing."""
    lines = [head]
    for m, time in enumerate(times):
        numbers = values[:, :, m].reshape(-1).tolist()
        lines.append(f"{time}," + ",".join("" if v != v else repr(v).removesuffix(".0") for v in numbers))
    write_whole(Path(path), "\n".join(lines) + "\n")


def _checked(names: Sequence[str], times: Sequence[Any], shares: NDArray[np.float64]) -> Sequence[str]:
    if (len(names), len(times)) != shares.shape:
        faces, suns = shares.shape
        raise ValueError(f"{len(names)} names and {len(times)} times for {faces} faces and {suns} suns")
    for kind, texts in (("names", names), ("times", map(str, times))):
        for text in texts:
            if "," in text or "\n" in text or not text:
                raise ValueError(f"{kind}: {text!r} is empty, or has a comma or a new line")
    return names


class Cut(NamedTuple):
    """A polygon's triangles (F, 3, 3); what is wrong with it, or ""; and whether it lies in a plane."""

    triangles: NDArray[np.float64]
    fault: str
    is_planar: bool


def cut(polygon: Sequence[ArrayLike]) -> Cut:
    """A polygon as triangles, and what is wrong with it. polygon: its outer ring (n, 3), then its holes. Needs
    gnomon[study], whose earcut cuts polygons into triangles."""
    from .studies.cityjson import triangulated

    parts = [np.asarray(ring, np.float64).reshape(-1, 3) for ring in polygon]
    if not parts or any(len(part) < 3 or not np.isfinite(part).all() for part in parts):
        return Cut(np.empty((0, 3, 3)), "has a ring with fewer than three corners, or one that is not finite", True)
    normal, *holes = (_normal_of(part) for part in parts)
    corners = np.concatenate(parts)
    extent = np.ptp(corners, axis=0).max()
    size = float(np.linalg.norm(normal))
    area = size - sum(float(np.linalg.norm(hole)) for hole in holes)
    if area <= 1e-12 * extent**2:
        return Cut(np.empty((0, 3, 3)), "has no area", True)
    triangles = parts[0][None] if len(corners) == 3 else triangulated(parts)
    is_planar = bool(np.abs((corners - corners[0]) @ normal).max() <= PLANAR * extent * size)
    found = np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1).sum()
    crosses = is_planar and abs(found - area) > PLANAR * size
    return Cut(triangles, "has a ring that crosses itself or another one" if crosses else "", is_planar)


def _normal_of(ring: NDArray[np.float64]) -> NDArray[np.float64]:
    """As long as twice the ring's area."""
    from_first = ring - ring[0]
    return np.asarray(np.cross(from_first, np.roll(from_first, -1, axis=0)).sum(axis=0))


def _rings_of(polygon: Any, row: int) -> list[NDArray[np.float64]]:
    name = f"polygons: row {row}"
    try:
        given = [_arrays.on_host(_arrays.columns_of(ring, name), name) for ring in polygon]
    except TypeError:
        given = []
    if not given or any(ring.ndim != 2 or ring.shape[1] != 3 or ring.dtype.kind not in "iuf" for ring in given):
        raise ValueError(f"{name} must be a list of rings, each of numbers (n, 3): [outer], or [outer, hole, hole]")
    for ring in given:
        if _arrays.all_finite(ring):  # what is not is said with other faults
            _arrays.require_places(ring, name)
    return [ring.astype(np.float64) for ring in given]


def _triangles_of(triangles: Any, where: str = "") -> NDArray[np.float64]:
    """Of an array or a mesh of another package. where: begins messages."""
    try:
        return np.ascontiguousarray(_arrays.triangles_of(*_meshes.mesh_of(triangles, None)), np.float64)
    except (ValueError, TypeError) as error:
        raise type(error)(f"{where}{error}") from None


def polygons(rings: Iterable[Sequence[ArrayLike]], occluders: ArrayLike | None = None) -> Surfaces:
    """Surfaces of polygons in space. Needs gnomon[study], whose earcut cuts them into triangles.

    rings: of each polygon its outer ring (n, 3), counter-clockwise as seen from its front, then its holes.
    occluders: (F, 3, 3) more triangles, which have no share of their own.
    """
    found, not_planar = [], []
    for row, polygon in enumerate(rings):
        triangles, fault, is_planar = cut(_rings_of(polygon, row))
        if fault:
            raise ValueError(f"polygons: row {row} {fault}")
        if not is_planar:
            not_planar.append(row)
        found.append(triangles)
    more = np.empty((0, 3, 3)) if occluders is None else _triangles_of(occluders, "occluders: ")
    faces = np.concatenate([np.repeat(np.arange(len(found)), [len(t) for t in found]), np.full(len(more), -1)])
    return Surfaces(np.concatenate([*found, more]), faces.astype(np.int32), np.array(not_planar, np.int64))


def lit_fractions(
    triangles: ArrayLike | Surfaces,
    directions: ArrayLike,
    faces: ArrayLike | None = None,
    *,
    within: float = 0.01,
    limit: int = 10_000,
    lattice: float | None = None,
    centroids: bool = False,
    threads: int | None = None,
    progress: Callable[[float], object] | None = None,
) -> LitFractions:
    """The share of each face's area that each of many suns reaches, as an interval that contains it.

    triangles: Surfaces; or (F, 3, 3), counter-clockwise as seen from their fronts, all of which cast shadows.
    directions: (M, 3) along which light travels, each rounded once to float32.
    faces: (F,) the number of the planar face that a triangle is part of, from 0 on; -1 for an occluder alone. The
        triangles of one face do not shadow each other. Default: each triangle is a face.
    within: intervals are refined until each is at most this wide.
    limit: the subtractions of shadows from one triangle under one sun, after which its interval stays as it is.
    lattice: the step, a power of two, to which coordinates are snapped once; default: the finest that holds them.
    centroids: find the centroids of the lit parts, too.
    progress: called now and then with the part that is done; if it returns False, gnomon.Cancelled is raised.

    A share is that of gnomon's points: what lies on the back, and what a closed triangle strictly above the face's
    plane blocks, is dark. The width of an interval holds all that is undecided, and the bound of all rounding.
    """
    if isinstance(triangles, Surfaces):
        return lit_fractions(
            triangles.triangles, directions, triangles.faces, within=within, limit=limit, lattice=lattice,
            centroids=centroids, threads=threads, progress=progress,
        )  # fmt: skip
    scene = _world.lattice_of(_triangles_of(triangles), lattice)
    rows = _arrays.on_host(_arrays.columns_of(directions, "directions"), "directions")
    _arrays.require_real(rows, "directions")
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise ValueError(f"directions: shape {rows.shape} is not (M, 3)")
    if _arrays.all_finite(rows):  # what is not is said below
        _arrays.require_places(rows, "directions")
    with np.errstate(over="ignore"):
        towards = -rows.astype(np.float32)
    length = np.abs(towards.astype(np.float64)).sum(axis=1)
    bad = _arrays.first_row(~(np.isfinite(length) & (length > 0)))
    if bad is not None:
        raise ValueError(f"directions: row {bad} {(-towards[bad]).tolist()} is zero or not finite in float32")
    size = len(scene.triangles)
    of = np.arange(size) if faces is None else _arrays.on_host(faces, "faces")
    if of.dtype.kind == "f" and np.isnan(of).any():
        raise ValueError(f"faces: row {_arrays.first_row(np.isnan(of))} is masked or has no value")
    if of.shape != (size,) or of.dtype.kind not in "iu":
        raise ValueError(f"faces: must be {size} whole numbers, one per triangle")
    if (row := _arrays.first_row(of < -1)) is not None:
        raise ValueError(f"faces: row {row} is {of[row]}: they count from 0 on, and -1 is for an occluder")
    has_one = np.isin(np.arange(size + 1), of)
    if of.max(initial=-1) >= size:
        raise ValueError(f"faces: face {has_one.argmin()} has no triangle, and one is called {of.max()}")
    within, limit = _arrays.number(within, "within"), int(_arrays.number(limit, "limit", least=0))
    threads = None if threads is None else int(_arrays.number(threads, "threads"))
    if not 0 < within <= 1:
        raise ValueError(f"within: {within:g} is not above 0 and at most 1")
    count = int(of.max(initial=-1)) + 1
    steps = np.ascontiguousarray(scene.triangles / np.float32(scene.step), np.int32).reshape(-1, 9)
    _require_areas(steps, of, count)
    threads = max(1, threads or os.cpu_count() or 1)
    block = max(1, len(towards) if progress is None else max(4 * threads, len(towards) // 100))
    blocks = []
    for first in range(0, max(len(towards), 1), block):
        some = np.ascontiguousarray(towards[first : first + block])
        blocks.append(_gnomon.lit_fractions(
            steps, np.ascontiguousarray(of, np.int32), count, some, float(within), int(limit), threads, centroids,
            threading.current_thread() is threading.main_thread(),
        ))  # fmt: skip
        if progress is not None and progress(min(1.0, (first + block) / max(len(towards), 1))) is False:
            raise _gnomon.Cancelled("cancelled")
    low, high, centroid = (np.concatenate(parts) for parts in zip(*blocks, strict=True))
    places = centroid.transpose(1, 0, 2) * scene.step + scene.origin if centroids else None
    return LitFractions(low.T, high.T, places)


def _require_areas(steps: NDArray[np.int32], of: NDArray[Any], count: int) -> None:
    corners = steps.reshape(-1, 3, 3).astype(np.int64)
    edges = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    has_area = np.cross(*edges).any(axis=1) & (of >= 0)
    empty = np.flatnonzero(np.bincount(of[has_area], minlength=count) == 0)
    if empty.size:
        raise ValueError(f"faces: face {empty[0]} has no triangle with an area on the lattice ({empty.size:,} are so)")
