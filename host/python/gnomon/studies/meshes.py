# SPDX-License-Identifier: MIT
"""Triangles of mesh files: glTF by gnomon's own loader, as everywhere; CityJSON by cityjson; PLY by ply; other formats
by trimesh.

Each file says what of it is left out. A polygon is divided into a fan of triangles where it is convex, and else by ear
clipping: trimesh divides all polygons into fans.
"""

from __future__ import annotations

import contextlib
import functools
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import _arrays, _gnomon
from . import cityjson, ply
from .rasters import UndeclaredNoDataError, UnreadableError, stamp_of
from .units import require_crs_of_mesh

#: Of files that are read here, and not by trimesh's own readers alone.
SUFFIXES = (".ply", ".obj", ".off", ".stl", ".glb", ".gltf", ".json", ".jsonl")
#: Lines of an .obj file that are no triangles: points, lines, curves and free-form surfaces.
OTHERS_OF_OBJ = re.compile(r"^[ \t]*(p|l|curv2?|surf)[ \t]", re.MULTILINE)
#: Faces that trimesh does not read as they are: of more than 3 corners, or with an index of 0 or below.
OWN_FACE_OF_OBJ = re.compile(r"^[ \t]*f(?:(?:[ \t]+[^\s#]+){4}|.*[ \t](?:0|-[0-9]+)(?:[/ \t]|$))", re.MULTILINE)


#: Vertices (V, 3), and the rows of each face's corners.
Polygons = tuple[NDArray[np.float64], list[NDArray[np.int64]]]


class MeshFile(NamedTuple):
    """triangles: (F, 3, 3) in the file's axes and in metres. up: "y" or "z". notes: what is left out, a sentence
    each. crs: the CRS that the file names, or None."""

    triangles: NDArray[np.float64]
    up: str
    notes: tuple[str, ...]
    crs: str | None = None


def load(name: str) -> MeshFile:
    """Raises UnreadableError or UndeclaredNoDataError, which name the file."""
    return _load(name, stamp_of(name))


@contextlib.contextmanager
def reading(name: str) -> Iterator[None]:
    """Makes any error of a loader an UnreadableError that names the file."""
    try:
        yield
    except (UnreadableError, UndeclaredNoDataError):
        raise
    except ModuleNotFoundError as error:
        package = error.name or str(error).split("'")[1]  # trimesh raises its own without the name
        remedy = f"pip install {package}, or write it as .ply, .obj or .glb, and give that"
        raise UnreadableError(f"{name}: needs the Python package {package}: {remedy}") from error
    except Exception as error:  # a loader may raise anything at a broken file
        # Such as "tuple index out of range", which says nothing of the file.
        is_bare = isinstance(error, LookupError | TypeError | AttributeError | AssertionError)
        text = f"its parts do not fit together ({type(error).__name__}: {error})" if is_bare else str(error)
        is_own = Path(name).suffix.lower() in SUFFIXES
        remedy = "export it again" if is_own else "write it as .ply, .obj or .glb, and give that"
        raise UnreadableError(text if text.startswith(name) else f"{name}: cannot be read: {text}; {remedy}") from error


@functools.lru_cache(maxsize=4)
def _load(name: str, stamp: tuple[int, int] | None) -> MeshFile:
    if stamp is not None and stamp[0] == 0:
        raise UnreadableError(f"{name}: the file is empty")
    with reading(name):
        mesh = _loaded(name)
    if not np.isfinite(mesh.triangles).all():
        raise UnreadableError(f"{name}: a coordinate is not finite")
    _require_places(mesh.triangles.reshape(-1, 3), name, is_gltf(name))
    if not len(mesh.triangles) and "has no triangles" not in mesh.notes:
        mesh = mesh._replace(notes=(*mesh.notes, "has no triangles"))
    return mesh


def _require_places(corners: NDArray[np.float64], name: str, is_asked: bool) -> None:
    """is_asked: gnomon's loader asked the file's own numbers, before its nodes moved them."""
    row = _arrays.first_fill_value(corners)
    row = _arrays.first_absent_place(corners) if row is None and not is_asked else row
    if row is not None:
        raise UndeclaredNoDataError(
            f"{name}: triangle {row // 3} has a corner at {corners[row].tolist()}, of which one number stands for no "
            "data: leave such triangles out where the file is made, or, if it is a place, move the mesh a little"
        )


def study_triangles(name: str, up: str | None, offset: tuple[float, float, float], crs: str | None) -> MeshFile:
    """The file's triangles in a study's coordinates, z up: moved by the offset. Raises UnreadableError; and ValueError
    for a file in another CRS than the study's."""
    mesh = load(name)
    triangles = mesh.triangles
    if mesh.crs is not None:
        triangles = triangles * [1, 1, require_crs_of_mesh(name, mesh.crs, triangles, crs, any(offset))]
    if (up or mesh.up) == "y":
        triangles = np.stack([triangles[..., 0], -triangles[..., 2], triangles[..., 1]], axis=-1)
    return mesh._replace(triangles=triangles + np.array(offset), up="z")


def _loaded(name: str) -> MeshFile:
    if cityjson.is_cityjson(name):
        city = cityjson.load(name)
        return MeshFile(city.triangles, "z", city.notes, city.crs)
    if is_gltf(name):
        return _loaded_gltf(name)
    found, notes = read_by_trimesh(name)
    return MeshFile(of_polygons(*found) if isinstance(found, tuple) else found, "z", notes)


def is_gltf(name: str) -> bool:
    with open(name, "rb") as file:
        is_glb = file.read(4) == b"glTF"
    return is_glb or name.lower().endswith((".glb", ".gltf"))


def _loaded_gltf(name: str) -> MeshFile:
    if not hasattr(_gnomon, "load_scene"):
        raise UnreadableError(f"{name}: this build of gnomon reads no glTF files (docs/python.md, Install)")
    try:
        scene = _gnomon.load_scene(name, scene=None, animation=None, time_s=None, blend=0, decode_alpha=None)
    except _gnomon.NoDataError as error:
        raise UndeclaredNoDataError(str(error)) from None
    notes = tuple(warning.removeprefix(f"{name}: ") for warning in scene.warnings)
    doubles = scene.take_doubles()
    return MeshFile(scene.take_triangles().astype(np.float64) if doubles is None else doubles, "y", notes)


def read_by_trimesh(name: str) -> tuple[Polygons | NDArray[np.float64], tuple[str, ...]]:
    """The polygons of a file that has some, or its triangles (F, 3, 3); and what is left out."""
    import trimesh

    notes = []
    suffix = Path(name).suffix.lower()
    if suffix in (".obj", ".off"):
        text, is_utf16 = _text_of(name)
        if suffix == ".obj" and (others := len(OTHERS_OF_OBJ.findall(text))):
            notes.append(f"{others} points, lines, curves or free-form surfaces are left out")
        if suffix == ".off" or OWN_FACE_OF_OBJ.search(text) or text.startswith("\ufeff") or is_utf16:
            text = text.removeprefix("\ufeff")
            return (_off(text) if suffix == ".off" else _obj(text)), tuple(notes)
    if suffix == ".ply":
        return _ply(name)
    if suffix == ".stl":
        _require_whole_stl(name)
    if suffix in (".dxf", ".svg"):
        remedy = "write its faces as .ply, .obj or .glb, and give that"
        raise UnreadableError(f"{name}: of a drawing ({suffix}) lines alone are read, and no faces: {remedy}")
    scene: Any = trimesh.load_scene(name, process=False)
    meshes = [g for g in scene.geometry.values() if isinstance(g, trimesh.Trimesh)]
    if others := len(scene.geometry) - len(meshes):
        notes.append(f"{others} point clouds or paths are left out")
    if not meshes:
        return np.empty((0, 3, 3)), tuple(notes)
    mesh: Any = scene.to_mesh()
    triangles = np.asarray(mesh.vertices, np.float64)[np.asarray(mesh.faces, np.int64)].reshape(-1, 3, 3)
    if scene.units not in (None, "m", "meter", "meters", "metre", "metres"):
        scale = trimesh.units.unit_conversion(scene.units, "meters")
        triangles = triangles * scale
        notes.append(f"its unit is {scene.units}: its coordinates are multiplied by {scale:g}")
    return triangles, tuple(notes)


def _text_of(name: str) -> tuple[str, bool]:
    """The text of a file, its continued lines in one; and whether it is UTF-16, as its byte order mark says."""
    with open(name, "rb") as file:
        is_utf16 = file.read(2) in (b"\xff\xfe", b"\xfe\xff")
    text = Path(name).read_text(encoding="utf-16" if is_utf16 else "utf-8", errors="replace")
    return text.replace("\\\n", " "), is_utf16


def _require_whole_stl(name: str) -> None:
    """Raises UnreadableError for a binary file that is shorter than its number of triangles, or a text without end."""
    with open(name, "rb") as file:
        head = file.read(1024)
        file.seek(max(0, Path(name).stat().st_size - 1024))
        tail = file.read()
    if head.lstrip().startswith(b"solid") and b"facet" in head and b"endsolid" not in tail:
        raise UnreadableError(f"{name}: is cut off: its last line is no endsolid")
    count, room = int.from_bytes(head[80:84], "little"), (Path(name).stat().st_size - 84) // 50
    if b"facet" not in head and len(head) >= 84 and room < count:
        raise UnreadableError(f"{name}: is cut off: it says that it has {count} triangles, and has {room}")


def _obj(text: str) -> Polygons:
    """Vertices and faces of an .obj file: indices count from 1, or backwards from the last vertex so far."""
    vertices: list[list[float]] = []
    faces = []
    for line in text.splitlines():
        words = line.split("#", 1)[0].split()
        if not words:
            continue
        if words[0] == "v":
            vertices.append([float(word) for word in words[1:4]])
        elif words[0] == "f":
            corners = [int(word.split("/")[0]) for word in words[1:]]
            if 0 in corners:
                raise ValueError("a face names vertex 0, and they count from 1")
            faces.append(np.array([i - 1 if i > 0 else len(vertices) + i for i in corners], np.int64))
    return np.array(vertices, np.float64).reshape(-1, 3), faces


def _off(text: str) -> Polygons:
    lines = [words for line in text.splitlines() if (words := line.split("#", 1)[0].split())]
    first = lines[0][0] if lines else ""
    if not first.endswith("OFF") or "4OFF" in first or "nOFF" in first:
        begins = f"begins with {first!r} and not with OFF, vertices of three coordinates" if lines else "is empty"
        raise ValueError(begins)
    lines[0] = lines[0][1:]
    lines = lines[not lines[0] :]
    vertex_count, face_count = int(lines[0][0]), int(lines[0][1])
    if len(lines) - 1 < vertex_count + face_count:
        said = f"{vertex_count} vertices and {face_count} faces"
        raise ValueError(f"is cut off: it says that it has {said}, and has {len(lines) - 1} lines of them")
    vertices = np.array([line[:3] for line in lines[1 : 1 + vertex_count]], np.float64)
    rows = lines[1 + vertex_count : 1 + vertex_count + face_count]
    if short := next((row for row in rows if len(row) <= int(row[0])), None):
        raise ValueError(f"a face says that it has {short[0]} corners, and has {len(short) - 1}")
    return vertices, [np.array(row[1 : 1 + int(row[0])], np.int64) for row in rows]


def _ply(name: str) -> tuple[Polygons | NDArray[np.float64], tuple[str, ...]]:
    vertices, blocks = ply.read(name)
    notes = () if blocks or not len(vertices) else ("1 point clouds or paths are left out",)
    if all(block.shape[1] == 3 for block in blocks):
        return _corners(vertices, np.concatenate([np.empty((0, 3), np.int64), *blocks])), notes
    return (vertices, [face for block in blocks for face in block]), notes


def _corners(vertices: NDArray[np.float64], indices: NDArray[np.int64]) -> NDArray[np.float64]:
    if (indices < 0).any() or (indices >= len(vertices)).any():
        raise ValueError(f"a face names a vertex that is not among its {len(vertices)}")
    return vertices[indices]


def of_polygons(vertices: NDArray[np.float64], faces: list[NDArray[np.int64]]) -> NDArray[np.float64]:
    """Triangles (F, 3, 3) of faces in their order."""
    parts: list[NDArray[np.float64]] = [np.empty((0, 3, 3))] * len(faces)
    lengths = np.array([len(face) for face in faces], np.int64)
    for n in np.unique(lengths[lengths >= 3]).tolist():
        rows = np.flatnonzero(lengths == n)
        corners = _corners(vertices, np.stack([faces[row] for row in rows]))
        edges = np.roll(corners, -1, axis=1) - corners
        turns = np.cross(edges, np.roll(edges, -1, axis=1))  # at each corner but the first
        from_first = corners - corners[:, :1]
        normals = np.cross(from_first, np.roll(from_first, -1, axis=1)).sum(axis=1)
        is_convex = ((turns * normals[:, None]).sum(axis=2) >= 0).all(axis=1)
        fan = np.array([[0, i, i + 1] for i in range(1, n - 1)])
        for row, polygon, convex in zip(rows.tolist(), corners, is_convex.tolist(), strict=True):
            parts[row] = polygon[fan] if convex or n == 3 else cityjson.triangulated([polygon])
    return np.concatenate([np.empty((0, 3, 3)), *parts])
