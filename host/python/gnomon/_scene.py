# SPDX-License-Identifier: MIT
"""Scenes, and the views of their cameras."""

from __future__ import annotations

import copy
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import IO, TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _cut_outs, _files, _gnomon, _lights, _meshes, _page
from . import _lattice as _world
from ._devices import Device, device_of, device_of_queue
from ._side import EXACT, Side, Technique, VertexSide
from ._visible_from import VisibleFrom, visible_from

if TYPE_CHECKING:
    from typing import TypedDict, overload

    from typing_extensions import Unpack

    class _VertexQuery(TypedDict, total=False):
        direction: ArrayLike | None
        position: ArrayLike | None
        nan: Literal["error", "absent"]

    class _SurfaceQuery(_VertexQuery, total=False):
        receivers: ArrayLike | None
        side: Side | None
        lift: bool
else:

    def overload(function):
        """typing's own keeps each function, and with it the devices, until the process ends."""
        return function


#: Points of one run: more are computed in several runs, so that the device's memory is bounded.
POINTS_AT_ONCE = 1 << 24
GREY = (0.8, 0.8, 0.8)
BLENDS = ("opaque", "clear", "mask")


#: What a scene keeps of the last techniques with settings of their own, and of the last devices.
TECHNIQUES_KEPT, DEVICES_KEPT = 8, 4


def _keep_latest(kept: dict[Any, Any], count: int) -> None:
    while len(kept) > count:
        del kept[next(iter(kept))]


class _OnDevice:
    """A scene's triangles on one device, and the techniques that ran there. Techniques keep lists between runs."""

    def __init__(self, device: Device, triangles: _gnomon.Triangles) -> None:
        self.device = device
        self.triangles = triangles
        self._techniques: dict[tuple[str, tuple[tuple[str, str], ...]], _gnomon.Technique] = {}
        self._appearance: _gnomon.Appearance | None = None

    def appearance(
        self, material: NDArray[np.uint32], base_color: list[tuple[float, float, float]]
    ) -> _gnomon.Appearance:
        """The scene's, uploaded once. Call it in the device's thread."""
        if self._appearance is None:
            self._appearance = _gnomon.Appearance.upload(self.device.native, material, base_color)
        return self._appearance

    def technique(self, wanted: Technique) -> _gnomon.Technique:
        """Call it in the device's thread."""
        settings = tuple(sorted((key, _setting_text(value)) for key, value in wanted.settings.items()))
        technique = self._techniques.pop((wanted.name, settings), None)
        if technique is None:
            technique = _gnomon.make_technique(wanted.name, self.device.native)
            for key, value in settings:
                technique.set(key, value)
        self._techniques[wanted.name, settings] = technique
        _keep_latest(self._techniques, TECHNIQUES_KEPT)
        return technique


class AtVertices(NamedTuple):
    """What a call with Side.vertices() finds. Rows count points, flattened.

    values: what the call returns for any other side, one per point.
    open: rows of points whose triangles do not close around them: at a border or a hole of the mesh, or where windings
        disagree or more than two triangles share an edge.
    touching: rows of points that lie on a triangle of which they are not a corner (T-junctions). They were lifted off
        that triangle, and are also dark where the light is not strictly on its front.
    extended: the number of points that an extension of the mesh decided (Side.vertices()).
    """

    values: NDArray[Any]
    open: NDArray[np.int64]
    touching: NDArray[np.int64]
    extended: int


#: The facing of the points in a range of rows, as the library takes it.
_FacingOf = Callable[[slice], _gnomon.Facing]


def _no_facing(_: slice) -> _gnomon.Facing:
    return _gnomon.Facing.none()


def _facing_by(normals: NDArray[np.floating[Any]]) -> _FacingOf:
    rounded = np.ascontiguousarray(normals, np.float32)  # the library reads it where it lies
    return lambda part: _gnomon.Facing.normals(rounded[part])


@dataclass(frozen=True)
class _Query:
    """Points of one call: their coordinates relative to the origin, their receivers, if there are any, and their
    facing."""

    local: NDArray[np.float32]
    ids: NDArray[np.uint32] | None = None
    facing: _FacingOf = _no_facing

    def part(self, first: int) -> tuple[NDArray[np.float32], NDArray[np.uint32], _gnomon.Facing]:
        rows = slice(first, first + POINTS_AT_ONCE)
        ids = np.empty(0, np.uint32) if self.ids is None else self.ids[rows]
        return self.local[rows], ids, self.facing(rows)


@dataclass(frozen=True)
class _Engine:
    """Answers queries: triangles on a device, a technique, and the light."""

    upload: _OnDevice
    technique: Technique
    light: tuple[float, float, float, float]

    def visibility(self, query: _Query, after_part: Callable[[int], None] = lambda _: None) -> NDArray[np.float32]:
        """after_part is called with the first row of each part, in the device's thread."""
        result = np.ones(len(query.local), np.float32)
        for first in range(0, len(query.local), POINTS_AT_ONCE):
            values = self.upload.device.call(self._visibility_of_part, query, first, after_part)
            result[first : first + POINTS_AT_ONCE] = values
        return result

    def _visibility_of_part(self, query: _Query, first: int, after_part: Callable[[int], None]) -> NDArray[np.float32]:
        device = self.upload.device.native
        local, ids, facing = query.part(first)
        points = _gnomon.Points.upload(device, local, ids)
        visibility = _gnomon.Visibility(device, len(local))
        self.run(points, visibility, facing)
        after_part(first)
        return visibility.read()

    def run(self, points: _gnomon.Points, visibility: _gnomon.Visibility, facing: _gnomon.Facing) -> None:
        """Call it in the device's thread."""
        technique = self.upload.technique(self.technique)
        technique.run(self.upload.triangles, points, self.light, visibility, facing)


class _Vertices(NamedTuple):
    """Points at vertices, ready for the device: those in the rows `touching` are lifted off a triangle, along its
    normal in `normals`."""

    world: NDArray[Any]
    up: tuple[float, float, float] | None
    local: NDArray[np.float32]
    normals: NDArray[np.float64] | None
    touching: NDArray[np.int64]
    fans: list[_gnomon.VertexFans]  # each for POINTS_AT_ONCE points


def _size_of(size: Any) -> tuple[int, int]:
    numbers = _arrays.on_host(size, "size")
    if numbers.shape != (2,) or numbers.dtype.kind not in "iuf" or (numbers % 1 != 0).any():
        raise ValueError(f"size: must be width and height in pixels, as (640, 360), not {size!r}")
    return int(numbers[0]), int(numbers[1])


def _technique_of(technique: str | Technique) -> Technique:
    if not isinstance(technique, str | Technique):
        raise TypeError(f"technique: must be a name of gnomon.techniques() or a gnomon.Technique, not {technique!r}")
    chosen = Technique(technique) if isinstance(technique, str) else technique
    if not isinstance(chosen.settings, Mapping):
        raise TypeError(f"settings: must be a mapping of names to values, not {chosen.settings!r}")
    return chosen


def _setting_text(value: object) -> str:
    if isinstance(value, bool):
        return "on" if value else "off"
    return str(value)


@dataclass(frozen=True)
class _Raster:
    """What Scene.from_raster() takes, as float32."""

    x: NDArray[np.float32]
    y: NDArray[np.float32]
    heights: NDArray[np.float32]

    @property
    def joins_first_corner(self) -> bool:
        """The diagonal from south-west to north-east joins vertices (r, c) and (r + 1, c + 1)."""
        return bool((self.x[0] < self.x[-1]) == (self.y[0] < self.y[-1]))

    def triangles(self) -> NDArray[np.float32]:
        """(F, 3, 3), as gnomon/inputs.hpp orders them."""
        xyz = np.stack([*np.meshgrid(self.x, self.y), self.heights], axis=-1)
        first, right, below, last = xyz[:-1, :-1], xyz[:-1, 1:], xyz[1:, :-1], xyz[1:, 1:]
        if self.joins_first_corner:  # x and y both rise or both fall: counter-clockwise is the other way round
            corners = [below, first, last, last, first, right]
        else:
            corners = [below, last, right, below, right, first]
        return np.ascontiguousarray(np.stack(corners, axis=2).reshape(-1, 3, 3))


def _raster_of(x: ArrayLike, y: ArrayLike, heights: ArrayLike) -> _Raster:
    given = {"x": x, "y": y, "heights": heights}
    arrays = {name: _arrays.on_host(array, name) for name, array in given.items()}
    for name, array in arrays.items():
        if array.dtype.kind not in "iuf":
            raise ValueError(f"{name}: must be numbers, not {array.dtype}")
        if (row := _arrays.not_float32(array)) is not None:
            raise ValueError(
                f"{name}: row {row} has a number that is no float32: subtract a corner of the raster, or round; "
                "gnomon.study() does either"
            )
    x, y, heights = (np.ascontiguousarray(array, np.float32) for array in arrays.values())
    if x.ndim != 1 or y.ndim != 1 or heights.shape != (len(y), len(x)) or min(heights.shape) < 2:
        raise ValueError(
            f"heights: must have a row for each y and a column for each x, two or more of each; the shapes are "
            f"{heights.shape}, {y.shape} and {x.shape}"
        )
    for name, places in (("x", x), ("y", y)):
        steps = np.diff(places)
        if not np.isfinite(places).all() or not ((steps > 0).all() or (steps < 0).all()):
            raise ValueError(f"{name}: must be finite and rise, or fall, from each value to the next")
    return _Raster(x, y, heights)


class Scene:
    """A mesh of triangles that cast shadows.

    The coordinates' axes are the caller's. from_gltf() gives them as glTF has them, with y up, and so does view() draw
    them unless it is given another `up`; in gnomon.study() z is up, as on maps.

    vertices, faces: (V, 3) coordinates and (F, 3) indices; or vertices alone as triangles (F, 3, 3) or (F, 9); or a
        mesh or a scene of trimesh, pyvista, meshio or Open3D. Any unit. A triangle's id is its row. A pyopencl array of
        float32 triangles is used where it lies, without a copy (with cut-outs it is copied): do not write it while the
        scene is used.
    cut_outs: triangles with holes, by the alpha of a texture, decided exactly at every hit: gnomon.CutOuts.
    lattice: a step, a power of two such as 2**-10, in the unit of the coordinates. float64 coordinates, of the mesh, of
        points and of point lights, are then snapped once to whole steps, floor(x / step + 1/2), and stay exact from
        there on, wherever the origin lies: a scene cut into tiles gives the same bits as a whole, if all tiles have the
        same step. All coordinates must lie within 2^24 steps of the scene's centre. Without it, vertices that are
        float32 values are taken as they are, and others get the finest step that leaves room for points twice as far
        out as the scene; what lies farther away is rounded to float32 relative to the scene's centre. Scene.lattice
        says which step it is, and what changed.
    device: a name as in gnomon.use(), or a Device; None: the default device.

    Raises ValueError for a wrong shape or dtype, a coordinate that is not finite, or a face that names no vertex.
    """

    def __init__(
        self,
        vertices: Any,
        faces: Any = None,
        *,
        cut_outs: _cut_outs.CutOuts | None = None,
        lattice: float | None = None,
        device: str | Device | None = None,
    ) -> None:
        vertices, faces = _meshes.mesh_of(vertices, faces)
        self._written: NDArray[np.float32] | None = None
        self._raster: _Raster | None = None
        self.lattice: _world.Lattice | None = None
        self._count = 0
        self._device_name: str | None = None
        self._opened: Device | None = None
        self._uploads: dict[Device, _OnDevice] = {}
        self._moved: dict[tuple[int, ...], _OnDevice] = {}  # on a lattice: the triangles near the last view's eye
        self._is_closed = False
        self.cameras: dict[str, _gnomon.Camera] = {}
        self._eyes: dict[str, tuple[float, float, float]] = {}  # of cameras, in double
        self.lights: dict[str, dict[str, tuple[float, float, float]]] = {}
        self.warnings: list[str] = []
        self._twin: Scene | None = None  # the same triangles on a lattice
        self._vertices: _Vertices | None = None  # of the last call with Side.vertices()
        self.animations: list[str] = []
        self._file: list[str] | None = None  # that it was read from, and what of it, in the words of the command
        self._material: NDArray[np.uint32] | None = None
        self._base_color: list[tuple[float, float, float]] = [GREY]
        self._cut_outs: _gnomon.CutOuts | None = None
        if _arrays.is_on_device(vertices):
            if lattice is not None:
                raise ValueError("lattice: not for a pyopencl array, which holds float32 coordinates already")
            if cut_outs is None:
                self._opened = self._wrap(vertices, faces)
                return
            vertices, device = vertices.get(), device_of_queue(vertices.queue)
        triangles = _arrays.triangles_of(vertices, faces)
        if lattice is None and _arrays.not_float32(triangles) is None:
            self._written = np.ascontiguousarray(triangles, dtype=np.float32)
        else:
            self.lattice = _world.lattice_of(np.ascontiguousarray(triangles, dtype=np.float64), lattice)
            self._written = self.lattice.triangles
            if lattice is None:
                _world.warn_if_coarse(self.lattice)
        self._count = len(self._written)
        if cut_outs is not None:
            corners = None if faces is None else _arrays.on_host(faces, "faces")
            self._cut_outs = _cut_outs.native_of(cut_outs, corners, self._count)
        self._device_name = device if isinstance(device, str) else None
        self._opened = device_of(device)

    @property
    def _device(self) -> Device:
        if self._opened is None:
            self._opened = device_of(self._device_name)
        return self._opened

    def __getstate__(self) -> dict[str, Any]:
        """What travels to another process, and to a copy: arrays. A scene that was made with a device's name opens that
        one there, when it is first used; any other takes the default device of its new process."""
        self._require_open()
        if self._written is None and self._raster is None:
            raise TypeError("the triangles of this scene lie in a pyopencl array, which cannot be copied: pickle the "
                            "array's get(), and make a scene of that")  # fmt: skip
        return {**self.__dict__, "_uploads": {}, "_moved": {}, "_vertices": None, "_opened": None}

    def __copy__(self) -> Scene:
        copied = object.__new__(type(self))
        copied.__dict__.update(self.__getstate__(), _opened=self._opened)
        return copied

    def __deepcopy__(self, memo: dict[int, Any]) -> Scene:
        copied = self.__copy__()
        copied.__dict__.update(copy.deepcopy(self.__getstate__(), memo), _opened=self._opened)
        return copied

    def _wrap(self, array: Any, faces: Any) -> Device:
        if faces is not None:
            raise ValueError("faces: triangles in a pyopencl array are given whole, as (F, 3, 3) or (F, 9)")
        if array.dtype != np.float32 or array.shape[1:] not in ((3, 3), (9,)) or not array.flags.c_contiguous:
            raise ValueError("vertices: a pyopencl array must be C-contiguous float32 of shape (F, 3, 3) or (F, 9)")
        device = device_of_queue(array.queue)
        self._count = array.shape[0]
        triangles = device.call(
            _gnomon.Triangles.wrap, device.native, array.base_data.int_ptr, self._count, array.offset // 4
        )
        self._uploads[device] = _OnDevice(device, triangles)
        return device

    @classmethod
    def from_raster(
        cls, x: ArrayLike, y: ArrayLike, heights: ArrayLike, *, device: str | Device | None = None
    ) -> Scene:
        """Ground between the vertices of a raster, z up, with two triangles in each square, which meet along the
        diagonal from south-west to north-east (x grows to the east, y to the north).

        x, y: (C,) of the columns, (R,) of the rows, in any unit, two or more; each rises, or falls, from value to
            value.
        heights: (R, C). NaN or infinite: no ground there; triangles with such a vertex block nothing and keep their
            ids.
        All numbers are float32 values: subtract a corner of the raster where they are not.

        lit_by() reads the raster as it is, with 8 bytes for each square, and 20 more where these pay: many times less
        than triangles take, and quicker from the first call on. Other calls write the triangles out: 72 bytes for each
        square on the device, once. Square q = r (C - 1) + c has the triangles 2 q and 2 q + 1. Raises ValueError with
        the argument's name.
        """
        raster = _raster_of(x, y, heights)
        scene = cls(np.empty((0, 3, 3), np.float32), device=device)
        scene._written, scene._raster = None, raster
        scene._count = 2 * (len(raster.y) - 1) * (len(raster.x) - 1)
        return scene

    @classmethod
    def from_gltf(
        cls,
        path: str | os.PathLike[str] | IO[bytes],
        *,
        time: float | None = None,
        animation: str | int | None = None,
        scene: str | int | None = None,
        blend: Literal["opaque", "clear", "mask"] = "opaque",
        device: str | Device | None = None,
    ) -> Scene:
        """The scene of a .glb or .gltf file, with its `cameras` and `lights` by name, the names of its `animations`,
        and `warnings`: what the file has and gnomon leaves out, a sentence each.

        `path`: the file's name, or a binary file from where it stands: open(name, "rb"), io.BytesIO, a member of a
        ZipFile. Only a name leads to the files beside it.
        `time`: seconds into `animation` (a name or an index; default: the first). Without both the pose is the one at
        rest. `scene`: one of the file's scenes, by name or index. Materials with alphaMode MASK are cut-outs, if Pillow
        is installed to decode their images. `blend`: triangles with alphaMode BLEND block as opaque ones, as if they
        were not there, or as masks with a cutoff of .5. Raises FileNotFoundError, or ValueError that names the wrong
        part.
        """
        if not hasattr(_gnomon, "load_scene"):
            raise RuntimeError(
                "this build of gnomon reads no glTF files (tinygltf, GLM or meshoptimizer was missing when it was "
                "built): use gnomon.Scene(trimesh.load(path, force='mesh'))"
            )
        if blend not in BLENDS:
            raise ValueError(f"blend: must be one of {', '.join(BLENDS)}, not {blend!r}")
        with _files.on_disk(path, "path") as file:
            loaded = _gnomon.load_scene(
                str(file.path),
                scene=None if scene is None else str(scene),
                animation=None if animation is None else str(animation),
                time_s=None if time is None else float(time),
                blend=BLENDS.index(blend),
                decode_alpha=_cut_outs.decode_alpha if _cut_outs.has_decoder() else None,
            )
        doubles = loaded.take_doubles()
        result = cls(loaded.take_triangles() if doubles is None else doubles, device=device)
        result._cut_outs = loaded.take_cut_outs()
        result.cameras = dict(loaded.cameras)
        for (name, _), (x, y, z) in zip(loaded.cameras, loaded.eyes, strict=True):
            result._eyes[name] = (x, y, z)
        extent = float(np.ptp(result.bounds, axis=0).max()) if loaded.lights else 0.0
        for (name, (x, y, z, w)), place in zip(loaded.lights, loaded.positions, strict=True):
            if w and (doubles is not None or _world.moves_visibly(place, extent)):
                x, y, z = place
            result.lights[name] = {"position": (x, y, z)} if w else {"direction": (-x, -y, -z)}
        result.warnings = [file.named(warning) for warning in loaded.warnings]
        result.animations = list(loaded.animations)
        chosen = {"scene": scene, "animation": animation, "time": time, "blend": blend}
        words = [f"--{name}={value}" for name, value in chosen.items() if value is not None]
        if isinstance(path, str | os.PathLike):
            result._file = [os.path.abspath(path), *words]
        result._material = loaded.take_triangle_material()
        result._base_color = [(r, g, b) for r, g, b in loaded.base_color]
        return result

    # ---- Its data ----------------------------------------------------------------------------------------------------

    def __len__(self) -> int:
        """The number of triangles."""
        return self._count

    @property
    def triangles(self) -> NDArray[np.float32]:
        """The triangles on the host, (F, 3, 3), read-only; relative to the lattice's origin if there is a lattice.
        ValueError if they lie in a pyopencl array."""
        self._require_open()
        if self._host is None:
            raise ValueError("the triangles of this scene lie in a pyopencl array: read that one")
        view = self._host.view()
        view.flags.writeable = False
        return view

    @property
    def bounds(self) -> NDArray[np.float32]:
        """(2, 3) the smallest and the largest coordinates of `triangles`; NaN without triangles."""
        corners = self.triangles.reshape(-1, 3)
        if len(corners) == 0:
            return np.full((2, 3), np.nan, np.float32)
        return np.stack([corners.min(axis=0), corners.max(axis=0)])

    @property
    def cut_out_counts(self) -> _cut_outs.CutOutCounts:
        """The numbers of triangles with holes, by kind; zeros without cut-outs. Uploads the scene at its first use."""
        if self._cut_outs is None:
            return _cut_outs.CutOutCounts()
        counts = self._on(self._device).triangles.cut_out_counts
        return _cut_outs.CutOutCounts(counts.masked, counts.opaque, counts.clear, counts.unusable)

    @property
    def device(self) -> Device:
        """The device that host arrays are computed on."""
        return self._device

    def close(self) -> None:
        """Frees the device's memory. The scene cannot be used any more."""
        self._is_closed = True
        self._uploads.clear()
        self._moved.clear()
        self._vertices = None
        self._twin = None
        self._written = self._raster = None

    def __enter__(self) -> Scene:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        device = "no device yet" if self._opened is None else repr(self._opened.description.name)
        state = "closed" if self._is_closed else f"on {device}"
        lattice = "" if self.lattice is None else f", {self.lattice!r}"
        return f"<gnomon.Scene of {self._count:,} triangles, {state}{lattice}>"

    def _require_open(self) -> None:
        if self._is_closed:
            raise ValueError("the scene is closed")

    @property
    def _native_lattice(self) -> _gnomon.WorldLattice | None:
        return None if self.lattice is None else self.lattice.native

    def _on(self, device: Device) -> _OnDevice:
        self._require_open()
        if device not in self._uploads:
            if self._written is None and self._raster is None:
                raise ValueError(
                    "the scene's triangles lie on another OpenCL queue than the points: give both one queue"
                )
            self._uploads[device] = self._uploaded(device, None if self._raster is not None else self._host)
        upload = self._uploads[device] = self._uploads.pop(device)
        _keep_latest(self._uploads, DEVICES_KEPT)
        return upload

    @property
    def _host(self) -> NDArray[np.float32] | None:
        """The triangles (F, 3, 3); a raster's are written out when something asks for them. None: they lie in a
        pyopencl array."""
        if self._written is None and self._raster is not None:
            self._written = self._raster.triangles()
        return self._written

    def _uploaded(self, device: Device, triangles: NDArray[np.float32] | None) -> _OnDevice:
        """None: the scene's raster."""
        if triangles is None:
            assert self._raster is not None
            of = self._raster
            arrays = (of.x, of.y, of.heights, of.joins_first_corner)
            return _OnDevice(device, device.call(_gnomon.Triangles.raster, device.native, *arrays))
        cut_outs = () if self._cut_outs is None else (self._cut_outs,)
        on_device = device.call(_gnomon.Triangles.upload, device.native, triangles, *cut_outs)
        if len(on_device) >= _gnomon.TRIANGLES_WORTH_CLUSTERS:
            device.call(on_device.keep_clusters, device.native)
        return _OnDevice(device, on_device)

    # ---- Points ------------------------------------------------------------------------------------------------------

    @overload
    def lit(self, points: ArrayLike, *, side: VertexSide, **query: Unpack[_VertexQuery]) -> AtVertices: ...
    @overload
    def lit(  # noqa: F811
        self, points: ArrayLike, *, out: Any = None, **query: Unpack[_SurfaceQuery]
    ) -> NDArray[np.bool_]: ...
    def lit(  # noqa: F811
        self,
        points: ArrayLike,
        *,
        direction: ArrayLike | None = None,
        position: ArrayLike | None = None,
        receivers: ArrayLike | None = None,
        side: Side | VertexSide | None = None,
        lift: bool = False,
        nan: Literal["error", "absent"] = "error",
        out: Any = None,
    ) -> NDArray[np.bool_] | AtVertices:
        """Whether the light reaches each point: what ray tracing would answer in exact arithmetic.

        points: (..., 3) coordinates in the scene's unit. On a scene without a lattice float64 points that float32 does
            not hold are rounded to it, or they and the triangles are snapped to a lattice, whichever moves less.
        direction: (3,) along which a directional light travels (of any length, rounded once to float32); or
        position: (3,) of a point light.
        receivers: (...) ids of the triangles that the points lie on, negative for none. A receiver never shadows its
            own points; it excludes that triangle and does nothing else. A point exactly on a triangle's plane is not
            shadowed by this triangle in any case.
        side: a gnomon.Side: none(), eye(), normals(), front() or vertices(). A point is dark unless the light is
            strictly on that side, decided exactly; None: none(). With vertices() an AtVertices is returned.
        lift: the points lie on surfaces, within 3/4 of a step: each is lifted along its normal, of Side.normals() or of
            the receiver with Side.front(), by a little over 2.6 steps, so that a flat surface does not shadow it after
            snapping. Facing is decided by that normal, of the triangle before snapping. Needs a lattice.
        nan: "error": a point that is not finite is a ValueError. "absent": it is False, and masked in the result.
        out: a pyopencl array (N,) of float32 for the result, with pyopencl points only.

        Returns bool, one per point; numpy.ma.MaskedArray with nan="absent". The blocking triangles are closed sets;
        a triangle that the light sees edge-on, or without area, blocks nothing (docs/numerics.md has the contract).

        Points in a pyopencl array (N, 3) of float32, relative to the lattice's origin if there is a lattice, are read
        where they lie, on that array's queue, and the result is a pyopencl array (N,) of float32, 1 lit and 0 not;
        receivers (uint32) and normals (float32) are pyopencl arrays, too. Nothing is checked there: a point that is not
        finite is 1. Side.front() and Side.eye() read the triangles after snapping there, and are refused where
        Scene.lattice names changed ones: give normals, or points on the host.

        Raises ValueError with the argument's name and the first bad row, MemoryError, DeviceNotFoundError.
        """
        if out is not None and not _arrays.is_on_device(points):
            raise ValueError("out: is only for points in a pyopencl array")
        if lift and _arrays.is_on_device(points):
            raise ValueError("lift: is only for points on the host, in float64")
        if _arrays.is_on_device(points):
            light = _world.light_of(self._native_lattice, direction, position)
            on_device: Any = self._lit_on_device(points, light, receivers, side, out)
            return on_device  # type: ignore[no-any-return]
        visibility: Any = self.visibility  # `side` chooses the overload
        values = visibility(
            points, direction=direction, position=position, receivers=receivers, side=side, lift=lift, nan=nan
        )
        if isinstance(values, AtVertices):
            return values._replace(values=_as_bool(values.values))
        return _as_bool(values)

    @overload
    def visibility(
        self, points: ArrayLike, *, side: VertexSide, technique: str | Technique = EXACT, **query: Unpack[_VertexQuery]
    ) -> AtVertices: ...
    @overload
    def visibility(  # noqa: F811
        self, points: ArrayLike, *, technique: str | Technique = EXACT, **query: Unpack[_SurfaceQuery]
    ) -> NDArray[np.float32]: ...
    def visibility(  # noqa: F811
        self,
        points: ArrayLike,
        *,
        direction: ArrayLike | None = None,
        position: ArrayLike | None = None,
        receivers: ArrayLike | None = None,
        side: Side | VertexSide | None = None,
        lift: bool = False,
        nan: Literal["error", "absent"] = "error",
        technique: str | Technique = EXACT,
    ) -> NDArray[np.float32] | AtVertices:
        """lit() as float32 from 0 (in shadow) to 1, by any technique of gnomon.techniques(), a name or a
        gnomon.Technique with settings; filtered shadow maps answer values between. Points on the host only. Raises
        ValueError for an unknown name."""
        if nan not in ("error", "absent"):
            raise ValueError(f"nan: {nan!r} is neither 'error' nor 'absent'")
        positions = _arrays.rows_of_triples(points, "points")
        flat = positions.reshape(-1, 3)
        _arrays.require_points(flat, nan)
        if not lift and not isinstance(side, VertexSide) and (twin := self._needed_twin(flat, position)):
            visibility: Any = twin.visibility
            on_lattice: NDArray[np.float32] = visibility(
                positions, direction=direction, position=position, receivers=receivers, side=side, nan=nan,
                technique=technique,
            )  # fmt: skip
            return on_lattice
        light = _world.light_of(self._native_lattice, direction, position)
        engine = _Engine(self._on(self._device), _technique_of(technique), light)

        def shaped(values: NDArray[np.float32]) -> NDArray[np.float32]:
            if nan == "error":
                return values.reshape(positions.shape[:-1])
            absent = ~np.isfinite(flat).all(axis=1)
            values[absent] = 0
            return np.ma.MaskedArray(
                values.reshape(positions.shape[:-1]), absent.reshape(positions.shape[:-1]), fill_value=0
            )

        if isinstance(side, VertexSide):
            if receivers is not None or lift:
                raise ValueError("side: Side.vertices() takes no receivers= and no lift=")
            at_vertices = self._at_vertices(engine, flat, side.up)
            return at_vertices._replace(values=shaped(at_vertices.values))
        ids = None if receivers is None else _arrays.receivers_of(receivers, positions.shape[:-1], self._count)
        return shaped(self._on_surfaces(engine, positions, ids, _side_of(side), lift))

    def lit_by(
        self,
        points: ArrayLike,
        lights: _lights.Lights,
        *,
        receivers: ArrayLike | None = None,
        side: Side | None = None,
        lift: bool = False,
        bits: bool = False,
        cosines: bool = False,
        progress: Callable[[float], object] | None = None,
        settings: Mapping[str, object] | None = None,
    ) -> _lights.LightsResult:
        """Which of many lights reach each point: hours of sun, soft shadows, shares of the sky. Each answer is that of
        lit() for the one light; work is shared between neighbouring points and lights, so it takes far less time.

        points, receivers, side: as in lit(), but no Side.vertices(); on a scene with a lattice, give Side.normals().
        lift: as in lit(), along Side.normals().
        lights: gnomon.Lights.directions() or gnomon.Lights.positions(), M of them.
        bits: return each answer, too: one bit per point and light.
        cosines: each weight is multiplied by max(0, n . l), with l the light's unit direction and n the normal as it
            is, in float32 (gnomon/trace.hpp has the arithmetic). Needs Side.normals() and directions.
        progress: called now and then with the part that is done, 0 to 1; if it returns False, gnomon.Cancelled is
            raised.
        settings: of the exact technique, by name.

        Returns a LightsResult: sums, counts, first and last lit light, bits. Raises ValueError with the argument's name
        and the first bad row, MemoryError, DeviceNotFoundError, Cancelled.
        """
        side = _side_of(side, "is for lit() and visibility()")
        positions = _arrays.rows_of_triples(points, "points")
        flat = positions.reshape(-1, 3)
        _arrays.require_points(flat)
        if not lift and side.kind in ("none", "normals") and (twin := self._needed_twin(flat, None)):
            return twin.lit_by(
                positions, lights, receivers=receivers, side=side, bits=bits, cosines=cosines, progress=progress,
                settings=settings,
            )  # fmt: skip
        table = _lights.table_of(self._native_lattice, lights)
        if self.lattice is not None and side.kind in ("front", "eye"):
            raise ValueError("side: on a scene with a lattice give Side.normals() of the surfaces before snapping")
        if cosines and side.kind != "normals":
            raise ValueError("cosines: needs side=Side.normals()")
        if lift and side.kind != "normals":
            raise ValueError("lift: needs side=Side.normals()")
        ids = None if receivers is None else _arrays.receivers_of(receivers, positions.shape[:-1], self._count)
        normals = _arrays.normals_of(side.value, positions.shape) if side.kind == "normals" else None
        along = self._normals_to_lift_along(normals, ids, side) if lift else None
        if cosines:
            facing = _facing_by(_lights.normals_for_cosines(side.value, positions.shape))
        else:
            facing = self._facing_of(side, ids) if normals is None else _facing_by(normals)
        query = _Query(self._local(flat, along), ids, facing)
        upload = self._on(self._device)

        def run_part(first: int, report: Callable[[float], bool]) -> tuple[Any, ...]:
            technique = upload.technique(_technique_of(Technique(EXACT, {} if settings is None else settings)))
            part, part_ids, part_facing = query.part(first)
            points = _gnomon.Points.upload(upload.device.native, part, part_ids)
            return _gnomon.run_light_table(
                technique, upload.triangles, points, table, part_facing, cosines, bits, report
            )

        firsts = range(0, max(len(flat), 1), POINTS_AT_ONCE)
        parts = [upload.device.call_reporting(run_part, progress, first) for first in firsts]
        return _lights.result_of(parts, positions.shape[:-1], bits, len(table))

    def visible_from(
        self,
        observers: ArrayLike,
        points: ArrayLike | None = None,
        *,
        height: float | ArrayLike = 0.0,
        target_height: float = 0.0,
        distance: float | ArrayLike | None = None,
        up: ArrayLike = (0, 0, 1),
        side: Side | VertexSide | None = None,
        progress: Callable[[float], object] | None = None,
    ) -> VisibleFrom:
        """Which points each observer sees: a line of sight is a shadow ray to a lamp at the observer's eye, so each
        answer is that of lit() with this lamp. (Rasters alone: gnomon.viewshed(), which takes far less time.)

        observers: (M, 3) where they stand. points: (..., 3) what is looked at; None: the corners of the scene's
        triangles, (F, 3), as Side.vertices() has them.
        height, target_height: eyes and targets lie this far above observers and points, along `up`.
        distance: points farther away, measured across `up`, are not seen. This and height may be one for each observer.
        side: the surface's side that points belong to, as in lit(); with target_height=0 alone.
        progress: as in lit_by().

        Returns VisibleFrom: counts and bits. Raises ValueError with the argument's name and the first bad row.
        """
        return visible_from(self, observers, points, height, target_height, distance, up, side, progress)

    def _local(self, flat: NDArray[Any], normals: NDArray[np.float64] | None = None) -> NDArray[np.float32]:
        """Points relative to the lattice's origin, lifted along the normals, if there are any; without a lattice points
        as they are."""
        if self.lattice is None:
            return _arrays.float32_of(flat, "points")
        return self.lattice.snap(flat, "points", normals)

    def _needed_twin(self, flat: NDArray[Any], *triples: Any) -> Scene | None:
        """The same triangles on a lattice, for questions that float32 would move too far; None: it moves nothing, or
        less than a lattice would. A scene on a lattice needs none."""
        lies_here = self._written is not None or self._raster is not None
        if self.lattice is not None or not lies_here or self._is_closed:
            return None
        moved = _arrays.moved_by_float32(flat)
        extent = float(np.ptp(self.bounds, axis=0).max()) if moved or any(t is not None for t in triples) else 0.0
        is_visible = any(t is not None and _world.moves_visibly(t, extent) for t in triples)
        if not (moved or is_visible) or not np.isfinite([moved, extent]).all() or not np.isfinite(self._host).all():
            return None
        twin = self._on_lattice()
        assert twin.lattice is not None
        return twin if is_visible or moved > max(twin.lattice.largest_move, twin.lattice.step / 2) else None

    def _on_lattice(self, points: NDArray[Any] | None = None) -> Scene:
        """The same triangles on a lattice that the caller stated, or on the finest that holds them and the points."""
        if self.lattice is not None and not isinstance(self.lattice.native, _world.Reaching):
            return self
        if points is None and self._twin is not None:
            return self._twin
        world = self.triangles.astype(np.float64) if self.lattice is None else self.lattice.world
        step = None
        if points is not None:
            step = _gnomon.WorldLattice.fit(np.concatenate([world.reshape(-1, 3), points])).step
        twin = Scene.__new__(Scene)
        twin.__dict__.update(self.__dict__)
        twin.lattice = _world.lattice_of(world, step)
        twin._written = twin.lattice.triangles
        twin._uploads, twin._moved, twin._vertices = {}, {}, None
        if points is None:
            self._twin = twin
        return twin

    def _facing_of(self, side: Side, ids: NDArray[np.uint32] | None) -> _FacingOf:
        """Facing by an eye, by the receivers' front, or none."""
        if side.kind == "none":
            return _no_facing
        if ids is None:
            raise ValueError(f"side: Side.{side.kind}() needs receivers=, the triangles that the points lie on")
        if side.kind == "front":
            return lambda _: _gnomon.Facing.winding()
        eye = _world.snapped_triple(self._native_lattice, side.value, "eye")
        return lambda _: _gnomon.Facing.eye(eye)

    def _on_surfaces(
        self, engine: _Engine, positions: NDArray[Any], ids: NDArray[np.uint32] | None, side: Side, lift: bool
    ) -> NDArray[np.float32]:
        flat = positions.reshape(-1, 3)
        normals = _arrays.normals_of(side.value, positions.shape) if side.kind == "normals" else None
        if lift:
            normals = self._normals_to_lift_along(normals, ids, side)
        facing = self._facing_of(side, ids) if normals is None else _facing_by(normals)
        query = _Query(self._local(flat, normals if lift else None), ids, facing)
        result = engine.visibility(query)
        if self.lattice is not None and ids is not None and normals is None and side.kind != "none":
            self._face_changed(engine, query, side, result)
        return result

    def _face_changed(self, engine: _Engine, query: _Query, side: Side, result: NDArray[np.float32]) -> None:
        """Decides again the points on triangles that snapping changes, now by the triangles before snapping."""
        assert self.lattice is not None and query.ids is not None
        rows = np.flatnonzero(np.append(self.lattice.is_changed, False)[np.minimum(query.ids, self._count)])
        if rows.size == 0:
            return
        world = self.lattice.world[query.ids[rows]]
        normals = _arrays.scaled(_world.normals_of_triangles(world))
        if side.kind == "eye":
            eye = np.array(self.lattice.native.world_of(_world.snapped_triple(self._native_lattice, side.value, "eye")))
            seen_side = np.sign(((eye - world[:, 0]) * normals).sum(axis=1, keepdims=True))
            normals = normals * seen_side  # an eye in the plane sees no side: a normal of zero faces no light
        facing = _facing_by(normals)
        result[rows] = engine.visibility(_Query(query.local[rows], query.ids[rows], facing))

    def _at_vertices(self, engine: _Engine, flat: NDArray[Any], up: Any) -> AtVertices:
        upwards = None if up is None else _arrays.triple(up, "up")
        if upwards is not None and not any(upwards):
            raise ValueError("up: must not be zero")
        kept = self._vertices
        if kept is None or kept.up != upwards or not np.array_equal(kept.world, flat, equal_nan=True):
            kept = self._vertices = self._vertices_of(engine.upload, flat, upwards)
        fans, local, extended = kept.fans, kept.local, 0

        def count_extended(first: int) -> None:
            nonlocal extended
            extended += fans[first // POINTS_AT_ONCE].extended()

        query = _Query(local, None, lambda part: _gnomon.Facing.fans(fans[part.start // POINTS_AT_ONCE], upwards))
        result = engine.visibility(query, count_extended)
        rows = kept.touching
        if kept.normals is not None:  # a run has one facing: a second run decides these by their triangles' normals
            lifted = _Query(local[rows], None, _facing_by(kept.normals))
            result[rows] = np.minimum(result[rows], engine.visibility(lifted))
        open_rows = [one.open().astype(np.int64) + i * POINTS_AT_ONCE for i, one in enumerate(fans)]
        return AtVertices(result, np.concatenate([*open_rows, np.empty(0, np.int64)]), rows, extended)

    def _vertices_of(self, upload: _OnDevice, flat: NDArray[Any], up: tuple[float, float, float] | None) -> _Vertices:
        triangles = self.triangles
        local = self._local(flat)
        fans = []
        for first in range(0, len(flat), POINTS_AT_ONCE):
            part = local[first : first + POINTS_AT_ONCE]
            fans.append(upload.device.call(_gnomon.VertexFans.find, upload.device.native, triangles, part))
            alone = fans[-1].alone()
            alone = alone[np.isfinite(part[alone]).all(axis=1)]
            if alone.size:
                row = first + int(alone[0])
                raise ValueError(f"points: row {row} {flat[row].tolist()} is no vertex of the scene's triangles")
        rows, normals = np.empty(0, np.int64), None
        if self.lattice is not None:
            rows, along = upload.device.call(self.lattice.normals_where_touching, local, up)
            if rows.size:
                local[rows] = _world.lifted(self.lattice.native, flat[rows].astype(np.float64), "points", along)
                normals = along
        return _Vertices(np.array(flat), up, local, normals, rows, fans)

    def _normals_to_lift_along(
        self, normals: NDArray[np.float64] | None, ids: NDArray[np.uint32] | None, side: Side
    ) -> NDArray[np.float64]:
        if self.lattice is None:
            raise ValueError("lift: needs a lattice: make the scene with lattice=, a step such as 2**-10")
        if normals is not None:
            return normals
        if side.kind != "front" or ids is None:
            raise ValueError("lift: needs Side.normals(), or receivers= and Side.front(): a side to lift to")
        row = _arrays.first_row(ids == _arrays.NO_RECEIVER)
        if row is not None:
            raise ValueError(f"receivers: row {row} names no triangle to lift off")
        found = _arrays.scaled(_world.normals_of_triangles(self.lattice.world[ids]))
        row = _arrays.first_row((found == 0).all(axis=1))
        if row is not None:
            raise ValueError(f"receivers: row {row} names triangle {int(ids[row])}, which has no area")
        return found

    def _lit_on_device(self, points: Any, light: Any, receivers: Any, side: Side | VertexSide | None, out: Any) -> Any:
        import pyopencl.array

        side = _side_of(side, "is only for points on the host")
        count = points.shape[0]
        _require_on_device(points, "points", (count, 3), np.float32)
        if receivers is not None:
            _require_on_device(receivers, "receivers", (count,), np.uint32)
        if side.kind == "normals":
            _require_on_device(side.value, "normals", (count, 3), np.float32)
            facing = _gnomon.Facing.normals_in_buffer(side.value.base_data.int_ptr, _packed_from(side.value))
        else:
            facing = self._facing_of(side, None if receivers is None else np.empty(0, np.uint32))(slice(None))
            if side.kind != "none" and self.lattice is not None and self.lattice.is_changed.any():
                raise ValueError(
                    f"side: snapping changed triangle {int(np.flatnonzero(self.lattice.is_changed)[0])} (Scene.lattice "
                    "names all), and points on the device would be decided by the triangles after snapping: give "
                    "Side.normals(), or points on the host"
                )
        engine = _Engine(self._on(device_of_queue(points.queue)), Technique(), light)
        result = pyopencl.array.empty(points.queue, (count,), np.float32) if out is None else out
        _require_on_device(result, "out", (count,), np.float32)
        if count:
            engine.upload.device.call(_enqueue_on_device, engine, points, receivers, facing, result)
        return result

    def prepare(self, *, direction: ArrayLike | None = None, position: ArrayLike | None = None) -> None:
        """Stores what depends on this light and these triangles alone: later calls with the same light do less work,
        with the same bits. Worth it from some calls per light on. Preparing another light frees the memory."""
        light = _world.light_of(self._native_lattice, direction, position)
        upload = self._on(self._device)
        upload.device.call(lambda: upload.technique(Technique()).prepare(upload.triangles, light))

    # ---- Views -------------------------------------------------------------------------------------------------------

    def view(
        self,
        eye: ArrayLike | None = None,
        target: ArrayLike | None = None,
        *,
        camera: str | None = None,
        up: ArrayLike = (0, 1, 0),
        fov: float = 50.0,
        size: tuple[int, int] = (1280, 720),
    ) -> View:
        """What a camera sees: per pixel the nearest triangle and the point on it.

        eye, target: (3,) where the camera stands and what it looks at; or camera: a name of `cameras`.
        up: (3,) the direction that is up in the picture. fov: the vertical field of view in degrees, 0 to 180.
        size: width and height in pixels, 1 to 16384.
        """
        if (camera is None) == (eye is None and target is None):
            raise ValueError("give either eye= and target=, or camera=, a name of `cameras`")
        width, height = _size_of(size)
        upwards = _arrays.triple(up, "up")
        if camera is not None and camera not in self.cameras:
            raise ValueError(f"camera: there is no {camera!r}; there are {', '.join(self.cameras) or 'none'}")
        if camera is not None:
            eye = target = self._eyes[camera]
        if twin := self._needed_twin(np.empty((0, 3)), eye, target):
            if camera is not None:
                return twin.view(camera=camera, size=size)
            return twin.view(eye, target, up=up, fov=fov, size=size)
        local_eye, local_target, origin, upload = self._at_eye(eye, target)
        if camera is not None:
            chosen = self.cameras[camera].at(local_eye)
        else:
            chosen = _gnomon.Camera.look_at(local_eye, local_target, upwards, _arrays.number(fov, "fov"))
        view = upload.device.call(_gnomon.look, upload.device.native, upload.triangles, chosen, width, height)
        return View(self, upload, view, (width, height), origin, upwards)

    def _at_eye(self, eye: Any, target: Any) -> tuple[Any, Any, _gnomon.WorldLattice | None, _OnDevice]:
        """Eye and target near an origin, and the triangles moved there. On a lattice this origin is the lattice's point
        nearest the eye, since what a camera sees must not depend on the origin of the scene."""
        if self.lattice is None:
            return _arrays.triple(eye, "eye"), _arrays.triple(target, "target"), None, self._on(self._device)
        around_eye = _gnomon.WorldLattice.around(_world.world_triple(eye, "eye"), self.lattice.native.exponent)
        from_eye = _world.world_triple(target, "target")[0] - around_eye.world_of((0.0, 0.0, 0.0))
        key = tuple(around_eye.origin)
        if key not in self._moved:
            corners = np.ascontiguousarray(self.triangles.reshape(-1, 3))
            try:
                moved = self.lattice.native.rebased(corners, around_eye)
            except ValueError:
                if not isinstance(self.lattice.native, _world.Reaching):
                    raise
                # The eye is out of the lattice's reach: it is rounded to float32, and the triangles stay.
                ends = [_world.snapped_triple(self._native_lattice, *end) for end in ((eye, "eye"), (target, "target"))]
                return ends[0], ends[1], self._native_lattice, self._on(self._device)
            self._moved = {key: self._uploaded(self._device, moved)}
        return (0.0, 0.0, 0.0), _arrays.triple(from_eye, "target"), around_eye, self._moved[key]


def _packed_from(array: Any) -> _gnomon.PointLayout:
    """Packed xyz from the array's offset in its buffer on."""
    return _gnomon.PointLayout(array.offset // 4, 3, 1)


def _require_on_device(array: Any, name: str, shape: tuple[int, ...], dtype: type) -> None:
    if not _arrays.is_on_device(array):
        raise TypeError(f"{name}: must be a pyopencl array, as the points are")
    if array.dtype != dtype or array.shape != shape or not array.flags.c_contiguous:
        raise ValueError(f"{name}: must be C-contiguous {np.dtype(dtype)} of shape {shape}")


def _side_of(side: Side | VertexSide | None, of_vertices: str = "") -> Side:
    if isinstance(side, VertexSide):
        raise ValueError(f"side: Side.vertices() {of_vertices}")
    if side is not None and not isinstance(side, Side):
        raise TypeError(f"side: must be a gnomon.Side, such as gnomon.Side.front(), not {side!r}")
    return side or Side.none()


def _as_bool(values: NDArray[np.float32]) -> NDArray[np.bool_]:
    if isinstance(values, np.ma.MaskedArray):
        return np.ma.MaskedArray(values.data != 0, values.mask, fill_value=False)
    return values != 0


def _enqueue_on_device(engine: _Engine, positions: Any, receivers: Any, facing: _gnomon.Facing, result: Any) -> None:
    device = engine.upload.device.native
    ids = None if receivers is None else _from_the_beginning(receivers)
    points = _gnomon.Points.wrap(
        device,
        positions.base_data.int_ptr,
        _packed_from(positions),
        positions.shape[0],
        0 if ids is None else ids.base_data.int_ptr,
    )
    aligned = result if _is_aligned(result) else type(result)(result.queue, result.shape, result.dtype)
    visibility = _gnomon.Visibility.wrap(device, aligned.base_data.int_ptr, positions.shape[0], aligned.offset // 4)
    engine.run(points, visibility, facing)
    if aligned is not result:
        _copy_on_device(aligned, result)


def _is_aligned(array: Any) -> bool:
    """Whether OpenCL can make a buffer of its own of an array's part of its buffer."""
    return array.offset % (array.queue.device.mem_base_addr_align // 8) == 0


def _from_the_beginning(array: Any) -> Any:
    """The array, or its copy on the device, so that its buffer begins with it."""
    if array.offset == 0:
        return array
    copied = type(array)(array.queue, array.shape, array.dtype)
    _copy_on_device(array, copied)
    return copied


def _copy_on_device(source: Any, target: Any) -> None:
    import pyopencl

    pyopencl.enqueue_copy(
        target.queue, target.base_data, source.base_data,
        byte_count=source.nbytes, src_offset=source.offset, dst_offset=target.offset,
    )  # fmt: skip


class View:
    """The picture of a camera, made by Scene.view(). Arrays are (height, width, ...), row 0 on top."""

    def __init__(
        self,
        scene: Scene,
        upload: _OnDevice,
        view: _gnomon.View,
        size: tuple[int, int],
        origin: _gnomon.WorldLattice | None,
        up: tuple[float, float, float],
    ) -> None:
        self._material = scene._material
        self._base_color = scene._base_color
        self._count = len(scene)
        self._light = next(iter(scene.lights.values()), {"direction": _default_direction(up)})
        self._upload = upload
        self._seen = view
        self._origin = origin
        self._host: tuple[Any, Any, Any] | None = None
        self.width, self.height = size

    def __reduce__(self) -> Any:
        raise TypeError("a gnomon.View lies on its device and cannot be copied or pickled: take its arrays "
                        "(visibility(), image(), points), or call Scene.view() in the other process")  # fmt: skip

    def _read(self) -> tuple[Any, Any, Any]:
        if self._host is None:
            device = self._upload.device
            points, normals, receivers = device.call(
                _gnomon.read_view, device.native, self._upload.triangles, self._seen
            )
            points[receivers == _arrays.NO_RECEIVER] = np.nan
            self._host = points, normals, receivers.astype(np.int64)
            self._host[2][receivers == _arrays.NO_RECEIVER] = -1
        return self._host

    @property
    def points(self) -> NDArray[Any]:
        """(H, W, 3) the shading points, lifted off their triangle by a proven bound; NaN where the sky is. float32, or
        on a lattice float64 in world coordinates."""
        if self._origin is None:
            return self._read()[0]
        return self._read()[0] + np.array(self._origin.world_of((0.0, 0.0, 0.0)))

    @property
    def normals(self) -> NDArray[np.float32]:
        """(H, W, 3) unit normals of the triangles, towards the camera; 0 where the sky is."""
        return self._read()[1]

    @property
    def receivers(self) -> NDArray[np.int64]:
        """(H, W) ids of the triangles; -1 where the sky is."""
        return self._read()[2]

    def _values(self, light: Any, samples: int, technique: str | Technique) -> _gnomon.Visibility:
        upload = self._upload

        def run() -> _gnomon.Visibility:
            result = _gnomon.Visibility(upload.device.native, self.width * self.height)
            chosen = upload.technique(_technique_of(technique))
            if samples == 1:
                chosen.run(upload.triangles, self._seen.points, light, result, _gnomon.Facing.automatic())
            else:
                _gnomon.run_samples(chosen, upload.triangles, self._seen, light, int(samples), result)
            return result

        return upload.device.call(run)

    def visibility(
        self,
        *,
        direction: ArrayLike | None = None,
        position: ArrayLike | None = None,
        samples: int = 1,
        technique: str | Technique = EXACT,
    ) -> NDArray[np.float32]:
        """(H, W) float32: 1 where the light reaches the pixel's point, 0 in shadow or on a side that faces away; the
        sky is 1. samples: 1, 4, 8, 16 or 32 per pixel; the result is their mean."""
        values = self._values(_world.light_of(self._origin, direction, position), samples, technique)
        return self._upload.device.call(values.read).reshape(self.height, self.width)

    def image(
        self,
        *,
        direction: ArrayLike | None = None,
        position: ArrayLike | None = None,
        samples: int = 1,
        technique: str | Technique = EXACT,
    ) -> NDArray[np.uint8]:
        """(H, W, 4) RGBA: Lambert's law with the shadows, and ambient light, in sRGB. samples: 1, 4, 8, 16
        or 32 per pixel; the result is the mean of their colours."""
        light = _world.light_of(self._origin, direction, position)
        material = self._material if self._material is not None else np.zeros(self._count, np.uint32)
        upload = self._upload
        values = self._values(light, 1, technique) if samples == 1 else None

        def shade() -> NDArray[np.uint8]:
            appearance = upload.appearance(material, self._base_color)
            if values is None:
                chosen = upload.technique(_technique_of(technique))
                return _gnomon.smooth_picture(appearance, chosen, upload.triangles, self._seen, light, int(samples))
            return _gnomon.shade(appearance, upload.triangles, self._seen, [values], [light])

        return upload.device.call(shade)

    def _repr_png_(self) -> bytes:
        """What a notebook shows: image() by the scene's first light, or if it has none by that of `gnomon render`."""
        return _page.png_of(self.image(direction=self._light.get("direction"), position=self._light.get("position")))

    def __repr__(self) -> str:
        return f"<gnomon.View of {self.width} x {self.height} pixels>"


def _default_direction(up: tuple[float, float, float]) -> tuple[float, float, float]:
    """The light of `gnomon render` for scenes without lights, from above as this picture has it."""
    x, y, z = -0.4, -1.0, -0.3
    return (x, -z, y) if up[2] > abs(up[1]) else (x, y, z)
