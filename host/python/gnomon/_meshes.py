# SPDX-License-Identifier: MIT
"""Meshes as other packages hold them, known by their attributes: none of the packages is imported."""

from __future__ import annotations

import os
import warnings
from typing import Any

import numpy as np

#: Faces of meshio's cells as triangles; cells without area are left out.
TRIANGLES_OF_CELLS = {"triangle": [[0, 1, 2]], "quad": [[0, 1, 2], [0, 2, 3]]}
CELLS_WITHOUT_AREA = ("vertex", "line", "line3")
#: VTK's array of cells and points that are not there, and its bits: copies of another part's cells, cells that finer
#: ones replace, hidden ones; hidden points. (vtkDataSetAttributes.h)
GHOSTS, ABSENT_CELL, ABSENT_POINT = "vtkGhostType", 1 | 8 | 32, 2
#: What is said of the rest; what has not even points is an empty scene.
WITHOUT_FACES = (
    "vertices: {} is no mesh: it has points or lines and no faces: they shadow nothing; give vertices and faces"
)


def mesh_of(vertices: Any, faces: Any) -> tuple[Any, Any]:
    """Vertices and faces of a mesh of trimesh, pyvista, meshio or Open3D; of arrays, themselves. Raises TypeError with
    what to call for what is none."""
    if faces is not None:
        return vertices, faces
    for kind in (_of_trimesh, _of_pyvista, _of_meshio, _of_open3d):
        found = kind(vertices)
        if found is not None:
            return found
    remedy = _remedy(vertices)
    if remedy is not None:
        raise TypeError(f"vertices: {type(vertices).__name__} is no mesh: {remedy}")
    return vertices, None


def _of_trimesh(mesh: Any) -> tuple[Any, Any] | None:
    if hasattr(mesh, "geometry") and hasattr(mesh, "graph"):  # a scene: its parts where its transforms put them
        parts = [part for part in mesh.dump() if hasattr(part, "faces")]
        counts = np.cumsum([0, *(len(part.vertices) for part in parts)])
        if not parts and len(mesh.geometry):
            raise TypeError(WITHOUT_FACES.format(type(mesh).__name__))
        if not parts:
            return np.empty((0, 3)), np.empty((0, 3), np.int64)
        return (
            np.concatenate([np.asarray(part.vertices) for part in parts]),
            np.concatenate([np.asarray(part.faces) + first for part, first in zip(parts, counts, strict=False)]),
        )
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
        return mesh.vertices, mesh.faces
    return None


def _of_pyvista(mesh: Any) -> tuple[Any, Any] | None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the names of these functions change between versions
        if hasattr(mesh, "n_blocks") and hasattr(mesh, "extract_geometry"):
            if not mesh.n_blocks:
                raise TypeError(f"vertices: {type(mesh).__name__} has no blocks: give it meshes first, by append()")
            mesh = mesh.extract_geometry()
        if not (hasattr(mesh, "triangulate") and hasattr(mesh, "points")):
            return None
        surface = mesh if hasattr(type(mesh), "regular_faces") else mesh.extract_surface()  # a property may raise
        triangles = surface.triangulate()
    if surface.n_cells and not len(triangles.faces):
        raise TypeError(WITHOUT_FACES.format(type(mesh).__name__))
    faces = np.asarray(triangles.faces).reshape(-1, 4)[:, 1:]
    is_there = np.ones(len(faces), bool)
    if GHOSTS in triangles.cell_data:
        is_there &= np.asarray(triangles.cell_data[GHOSTS]) & ABSENT_CELL == 0
    if GHOSTS in triangles.point_data:
        is_there &= (np.asarray(triangles.point_data[GHOSTS])[faces] & ABSENT_POINT == 0).all(axis=1)
    return triangles.points, faces[is_there]


def _of_meshio(mesh: Any) -> tuple[Any, Any] | None:
    if not (hasattr(mesh, "points") and hasattr(mesh, "cells") and hasattr(mesh, "cell_data")):
        return None
    points, faces = np.asarray(mesh.points), [np.empty((0, 3), np.int64)]
    for i, block in enumerate(mesh.cells):
        if block.type in TRIANGLES_OF_CELLS:
            cells = np.asarray(block.data)
            if GHOSTS in mesh.cell_data:
                cells = cells[np.asarray(mesh.cell_data[GHOSTS][i]).astype(np.uint8) & ABSENT_CELL == 0]
            faces += [cells[:, corners] for corners in TRIANGLES_OF_CELLS[block.type]]
        elif block.type not in CELLS_WITHOUT_AREA:
            raise TypeError(
                f"vertices: a meshio mesh with cells of type {block.type!r}: of triangles and quads alone the surface "
                "is known; take it with pyvista.wrap(mesh).extract_surface()"
            )
    if mesh.cells and len(faces) == 1:
        raise TypeError(WITHOUT_FACES.format(type(mesh).__name__))
    if points.ndim == 2 and points.shape[1] == 2:
        raise TypeError(
            "vertices: a meshio mesh in two dimensions: give its heights, too, as "
            "mesh.points = numpy.column_stack([mesh.points, heights])"
        )
    return points, np.concatenate(faces)


def _of_open3d(mesh: Any) -> tuple[Any, Any] | None:
    if hasattr(mesh, "vertices") and hasattr(mesh, "triangles"):
        return np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    if hasattr(mesh, "vertex") and hasattr(mesh, "triangle"):  # open3d.t.geometry
        return mesh.vertex.positions.cpu().numpy(), mesh.triangle.indices.cpu().numpy()
    return None


def _remedy(given: Any) -> str | None:
    if isinstance(given, str | os.PathLike):
        name = os.fspath(given)
        if str(name).lower().endswith((".glb", ".gltf")):
            return f"gnomon.Scene.from_gltf({name!r}) reads the file"
        return f"load it first, as gnomon.Scene(trimesh.load({name!r}))"
    if isinstance(given, bytes | bytearray):
        return "gnomon.Scene.from_gltf(io.BytesIO(data)) reads glTF"
    if (hasattr(given, "read") or hasattr(given, "read_bytes")) and not hasattr(given, "__array__"):
        return (
            "gnomon.Scene.from_gltf(file) reads glTF; load other files first, as "
            "gnomon.Scene(trimesh.load(file, file_type=...))"
        )
    if isinstance(given, dict):
        return "give two arrays, gnomon.Scene(vertices, faces)"
    if hasattr(given, "dims") and hasattr(given, "coords"):
        return (
            "gnomon.study(folder, raster=...) takes a raster of heights as a file, which data.rio.to_raster() writes; "
            "a height field of arrays stands in docs/python.md, Side.vertices()"
        )
    if hasattr(given, "geometry") or hasattr(given, "geom_type"):
        return "make triangles of the geometry first, as with trimesh.creation.extrude_polygon()"
    if hasattr(given, "GetOutput") and hasattr(given, "Update"):
        return "gnomon.Scene(pyvista.wrap(it.GetOutput())) takes what it makes, after it.Update()"
    if hasattr(given, "GetPoints") and hasattr(given, "GetNumberOfCells"):
        return "gnomon.Scene(pyvista.wrap(mesh)) takes it"
    if isinstance(given, list | tuple) and given and hasattr(given[0], "faces"):
        return "join the meshes first, with trimesh.util.concatenate(meshes) or pyvista.merge(meshes)"
    are_two = isinstance(given, list | tuple) and [getattr(one, "ndim", 0) for one in given] == [2, 2]
    if are_two and given[0].shape != given[1].shape:  # two triangles have one shape
        return "give vertices and faces apart, gnomon.Scene(vertices, faces)"
    if hasattr(given, "points") or hasattr(given, "vertices"):
        return "it has points or lines and no faces: they shadow nothing; give vertices and faces"
    return None
