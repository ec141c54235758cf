# SPDX-License-Identifier: MIT
"""The planar polygons of a model, with their names: CityJSON, honeybee's HBJSON, and the mesh files of studies."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import cityjson, meshes
from .cityjson import Rings
from .units import require_crs_of_mesh

#: Where an object of an HBJSON file has others; apertures and doors lie in their face, as holes of its wall.
PARTS = ("rooms", "faces", "apertures", "doors", "indoor_shades", "outdoor_shades", "shades", "orphaned_faces",
         "orphaned_apertures", "orphaned_doors", "orphaned_shades", "shade_meshes")  # fmt: skip
HOLES = ("apertures", "doors")


class Model(NamedTuple):
    """polygons: the name of each and its rings, (n, 3) in the file's coordinates: the outer one, counter-clockwise as
    seen from its front, then its holes. up: "y" or "z". crs: the CRS that the file names, or None. notes: what is left
    out, a sentence each."""

    polygons: list[tuple[str, Rings]]
    up: str = "z"
    crs: str | None = None
    notes: tuple[str, ...] = ()


def load(name: str) -> Model:
    """The polygons of a file; of glTF and of meshes of triangles each triangle is one. Raises FileNotFoundError,
    UnreadableError, and ValueError for a CRS that is no map in metres."""
    if not Path(name).exists():
        raise FileNotFoundError(f"{name}: there is no such file")
    with meshes.reading(name):
        model = _read(name)
        if not all(np.isfinite(ring).all() for _, rings in model.polygons for ring in rings):
            raise ValueError("a coordinate is not finite")
    if model.crs is None:
        return model
    corners = np.concatenate([np.empty((0, 3)), *(ring for _, rings in model.polygons for ring in rings)])
    scale = [
        1,
        1,
        require_crs_of_mesh(name, model.crs, corners[: len(corners) // 3 * 3].reshape(-1, 3, 3), None, False),
    ]
    return model._replace(polygons=[(text, [ring * scale for ring in rings]) for text, rings in model.polygons])


def _read(name: str) -> Model:
    if cityjson.is_cityjson(name) or name.lower().endswith(".hbjson"):
        honeybee = None if name.lower().endswith(".jsonl") else json.loads(Path(name).read_text(encoding="utf-8-sig"))
        if isinstance(honeybee, dict) and honeybee.get("type") == "Model":
            return Model(list(_of_honeybee(honeybee)))
        city = cityjson.load(name)
        return Model([(text.replace(",", ";"), rings) for text, rings in city.polygons], "z", city.crs, city.notes)
    if meshes.is_gltf(name):
        mesh = meshes.load(name)
        return Model(_numbered(list(mesh.triangles)), mesh.up, mesh.crs, mesh.notes)
    found, notes = meshes.read_by_trimesh(name)
    if not isinstance(found, tuple):
        return Model(_numbered(list(found)), notes=notes)
    vertices, faces = found
    if any((face < 0).any() or (face >= len(vertices)).any() for face in faces):
        raise ValueError(f"a face names a vertex that is not among its {len(vertices)}")
    return Model(_numbered([vertices[face] for face in faces if len(face) >= 3]), notes=notes)


def _numbered(rings: list[NDArray[np.float64]]) -> list[tuple[str, Rings]]:
    return [(f"face {i}", [ring]) for i, ring in enumerate(rings)]


def _of_honeybee(part: dict[str, Any]) -> Iterator[tuple[str, Rings]]:
    """A model's or an object's polygons by their identifiers. A face has its apertures and doors as holes."""
    geometry = part.get("geometry")
    if geometry is not None:
        name = str(part["identifier"]).replace(",", ";")
        if geometry["type"] == "Face3D":
            holes = [hole["geometry"]["boundary"] for key in HOLES for hole in part.get(key) or ()]
            rings = [geometry["boundary"], *(geometry.get("holes") or ()), *holes]
            yield name, [np.array(ring, np.float64).reshape(-1, 3) for ring in rings]
        elif geometry["type"] == "Mesh3D":
            vertices = np.array(geometry["vertices"], np.float64).reshape(-1, 3)
            yield from ((f"{name} {i}", [vertices[face]]) for i, face in enumerate(geometry["faces"]))
        else:
            raise ValueError(f"{name}: its geometry is a {geometry['type']}, and must be a Face3D or a Mesh3D")
    for key in PARTS:
        for inner in part.get(key) or ():
            yield from _of_honeybee(inner)
