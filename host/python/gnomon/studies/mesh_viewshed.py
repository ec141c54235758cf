# SPDX-License-Identifier: MIT
"""gnomon-study viewshed --targets: which points of a table observers see past meshes alone, as a table."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._files import require_other, require_writable, write_whole
from .._scene import Scene
from .._side import Side
from .._visible_from import VisibleFrom
from .meshes import study_triangles
from .tables import read_points
from .viewshed import given_place


class MeshSettings(NamedTuple):
    """What is asked of meshes alone; Scene.visible_from() has the meanings. Coordinates are those of the meshes, moved
    by mesh_offset, z up, without the Earth's curvature.

    meshes: files, all of whose triangles hide. observers: "x,y,z", or a table with the columns x, y, z.
    targets: a table of points with the columns x, y, z, and nx, ny, nz for the side that they face.
    height, target_height: of eyes and targets above these places. distance: targets farther away on the map are not
        seen; None: all are looked at.
    """

    meshes: tuple[str, ...]
    observers: str
    targets: str
    height: float = 0.0
    target_height: float = 0.0
    distance: float | None = None
    mesh_up: str | None = None
    mesh_offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    device: str | None = None


def _places_of(text: str) -> NDArray[np.float64]:
    """(M, 3). Raises ValueError."""
    place = given_place(text, "x,y,z", "12.5,3,1.7")
    return read_points(text)[:, :3] if place is None else np.array([place])


def write_seen_targets(path: Path, settings: MeshSettings) -> dict[str, Any]:
    """Writes a row for each target, in the table's order, and returns the record: x, y, z as they were given, the
    number of observers that see it, and their numbers, from 0. The file appears whole. Raises ValueError and OSError.
    """
    require_other(path, [*settings.meshes, settings.observers, settings.targets])
    if path.suffix.lower() != ".csv":
        raise ValueError(f"{path}: past meshes alone a table is written: give a file that ends in .csv")
    observers, targets = _places_of(settings.observers), read_points(settings.targets)
    files = [study_triangles(name, settings.mesh_up, settings.mesh_offset, None) for name in settings.meshes]
    require_writable(path)
    side = Side.normals(targets[:, 3:]) if targets.shape[1] > 3 else None
    if side is not None and settings.target_height != 0:
        raise ValueError(f"{settings.targets}: nx, ny, nz are of points on surfaces: leave --target-height out")
    with Scene(np.concatenate([file.triangles for file in files]), device=settings.device) as scene:
        found = scene.visible_from(
            observers, targets[:, :3], height=settings.height, target_height=settings.target_height,
            distance=settings.distance, side=side,
        )  # fmt: skip
        device = scene.device.description.name
    write_whole(path, _table(targets[:, :3], found))
    return {
        "triangles": int(sum(len(file.triangles) for file in files)), "observers": len(observers),
        "targets": len(targets), "seen by any": int((found.counts > 0).sum()),
        "notes": [f"{name}: {note}" for name, file in zip(settings.meshes, files, strict=True) for note in file.notes],
        "device": device,
    }  # fmt: skip


def _table(targets: NDArray[np.float64], found: VisibleFrom) -> str:
    rows = ["x,y,z,count,observers"]
    for place, count, seen in zip(targets.tolist(), found.counts.tolist(), found.seen(), strict=True):
        who = " ".join(map(str, np.flatnonzero(seen).tolist()))
        rows.append(f"{place[0]!r},{place[1]!r},{place[2]!r},{count},{who}")
    return "\n".join(rows) + "\n"
