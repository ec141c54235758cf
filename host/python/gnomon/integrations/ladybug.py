# SPDX-License-Identifier: MIT
"""The function on which ladybug-radiance's studies rest, decided exactly instead of by Radiance's rays."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._gnomon import WorldLattice
from .._lights import Lights
from .._scene import Scene
from .._side import Side


def intersection_matrix(
    vectors: Iterable[Any],
    points: Iterable[Any],
    normals: Iterable[Any],
    context_geometry: Iterable[Any],
    offset_distance: float = 0,
    numericalize: bool = False,
    sim_folder: str | None = None,
    use_radiance_mesh: bool = False,
) -> NDArray[Any]:
    """Which vectors reach which sensors past the context: what ladybug_radiance.intersection.intersection_matrix says.

    vectors: towards the sun or the sky, from the sensors; objects with x, y, z. Each is rounded once to float32.
    points, normals: the sensors and the side that they look to; objects with x, y, z.
    context_geometry: what blocks: meshes (vertices, faces of 3 or 4 corners) and faces (triangulated_mesh3d).
    offset_distance: how far each sensor is moved along its normal first.
    numericalize: the cosines between normals and vectors where they are seen, float64, instead of bool.
    sim_folder, use_radiance_mesh: taken, and without effect: no file is written.

    Returns (points, vectors). Sensors and context are snapped once to a lattice (docs/numerics.md, 13); a sensor
    is lifted along its normal by less than 4 of its steps, so that a face under it does not shadow it.
    """
    sensors, along, towards = _triples(points, "points"), _triples(normals, "normals"), _triples(vectors, "vectors")
    if sensors.shape != along.shape:
        raise ValueError(f"normals: {len(along)} for {len(sensors)} points, must be one per point")
    triangles = [_triangles_of(geometry, row) for row, geometry in enumerate(context_geometry)]
    matrix: NDArray[Any] = np.zeros((len(sensors), len(towards)), np.float64 if numericalize else np.bool_)
    faces_somewhere = np.flatnonzero(along.any(axis=1))
    if matrix[faces_somewhere].size == 0:
        return matrix
    sensors, along = sensors[faces_somewhere], along[faces_somewhere]
    sensors = sensors + offset_distance * along
    context = np.concatenate([*triangles, np.empty((0, 3, 3))])
    corners = np.concatenate([context.reshape(-1, 3), sensors])
    with Scene(context, lattice=WorldLattice.fit(corners).step) as scene:
        lights = Lights.directions(-towards)
        found = scene.lit_by(sensors, lights, side=Side.normals(along), lift=True, bits=True)
    seen = found.lit()
    if numericalize:
        unit = [v / np.linalg.norm(v, axis=1, keepdims=True) for v in (along, towards)]
        matrix[faces_somewhere] = np.where(seen, np.maximum(unit[0] @ unit[1].T, 0), 0)
    else:
        matrix[faces_somewhere] = seen
    return matrix


def _triples(items: Iterable[Any], name: str) -> NDArray[np.float64]:
    """(N, 3) of objects with x, y, z."""
    try:
        values = np.array([(item.x, item.y, item.z) for item in items], np.float64).reshape(-1, 3)
    except AttributeError as error:
        raise TypeError(f"{name}: must be ladybug_geometry's, with x, y and z: {error}") from None
    bad = np.flatnonzero(~np.isfinite(values).all(axis=1))
    if bad.size:
        raise ValueError(f"{name}: row {bad[0]} {values[bad[0]].tolist()} is not finite")
    return values


def _triangles_of(geometry: Any, row: int) -> NDArray[np.float64]:
    """(F, 3, 3) of a mesh, or of a face by its triangulation."""
    mesh = geometry if hasattr(geometry, "faces") else getattr(geometry, "triangulated_mesh3d", None)
    if mesh is None or not hasattr(mesh, "vertices"):
        raise TypeError(
            f"context_geometry: row {row} is a {type(geometry).__name__}, which has neither vertices and faces nor a "
            "triangulated_mesh3d"
        )
    vertices = _triples(mesh.vertices, f"context_geometry: row {row}: vertices")
    three = np.array([face for face in mesh.faces if len(face) == 3], np.int64).reshape(-1, 3)
    four = np.array([face for face in mesh.faces if len(face) == 4], np.int64).reshape(-1, 4)
    return np.concatenate([vertices[three], _halves(vertices[four])])


def _halves(quads: NDArray[np.float64]) -> NDArray[np.float64]:
    """Each quad's two triangles, cut from its first corner, or from its second where the first cut runs outside."""

    def cut(first: int) -> NDArray[np.float64]:
        a, b, c, d = (np.roll(quads, -first, axis=1)[:, i] for i in range(4))
        return np.stack([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)], axis=1)

    halves = cut(0)
    normals = np.cross(halves[:, :, 1] - halves[:, :, 0], halves[:, :, 2] - halves[:, :, 0])
    is_outside = (normals[:, 0] * normals[:, 1]).sum(axis=1) < 0
    halves[is_outside] = cut(1)[is_outside]
    return halves.reshape(-1, 3, 3)
