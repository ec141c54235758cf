# SPDX-License-Identifier: MIT
"""Triangles of CityJSON files (1.0 to 2.0) and of sequences of CityJSON features.

Surfaces are polygons with holes over a table of vertices, which the file's transform turns into coordinates. Each
polygon is triangulated by mapbox_earcut in the coordinate plane that it faces most, with its own vertices only, and
keeps its side. An object's highest level of detail counts. Points and lines cast no shadow.
"""

from __future__ import annotations

import collections
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import mapbox_earcut
import numpy as np
from numpy.typing import NDArray

#: How deep the surfaces of a geometry lie in its boundaries.
DEPTHS = {"MultiSurface": 0, "CompositeSurface": 0, "Solid": 1, "MultiSolid": 2, "CompositeSolid": 2}
SUFFIXES = (".json", ".jsonl", ".cityjson")

Rings = list[NDArray[np.float64]]


def is_cityjson(name: str) -> bool:
    return name.lower().endswith(SUFFIXES)


class City(NamedTuple):
    """polygons: the name of each surface and its rings, (n, 3) in the file's coordinates: the outer one, then its
    holes. crs: its referenceSystem. notes: what is left out."""

    polygons: list[tuple[str, Rings]]
    crs: str | None
    notes: tuple[str, ...]

    @property
    def triangles(self) -> NDArray[np.float64]:
        """(F, 3, 3), those of each polygon."""
        return np.concatenate([np.empty((0, 3, 3)), *(triangulated(rings) for _, rings in self.polygons)])


def load(name: str) -> City:
    """Raises ValueError, KeyError, TypeError or OSError at a file that is not CityJSON."""
    text = Path(name).read_text(encoding="utf-8-sig")
    lines = text.splitlines() if name.lower().endswith(".jsonl") else [text]
    first, *features = [json.loads(line) for line in lines if line.strip()]
    if not isinstance(first, dict) or first.get("type") != "CityJSON":
        raise ValueError('its "type" is not "CityJSON"')
    if str(first.get("version", "2.0")).split(".")[0] not in ("1", "2"):
        raise ValueError(f'its "version" is {first["version"]!r}, and those from 1.0 to 2.0 are read')
    polygons: list[tuple[str, Rings]] = []
    left_out: collections.Counter[str] = collections.Counter()
    templates = first.get("geometry-templates", {})
    for part in (first, *features):
        transform = first.get("transform", {"scale": [1, 1, 1], "translate": [0, 0, 0]})
        scale, translate = (np.array(transform[key], np.float64) for key in ("scale", "translate"))
        vertices = np.array(part["vertices"], np.float64).reshape(-1, 3) * scale + translate
        for name, geometry in _geometries(part["CityObjects"], templates):
            surfaces = _surfaces(geometry, vertices, templates, left_out)
            polygons += [(f"{name} {kind or 'surface'} {i}", rings) for i, (kind, rings) in enumerate(surfaces)]
    crs = first.get("metadata", {}).get("referenceSystem")
    return City(polygons, crs, tuple(f"left out: {n} {what}" for what, n in left_out.items() if n))


def _geometries(objects: dict[str, Any], templates: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """The geometries that count, and their objects' names: each object's surfaces of its highest level of detail,
    unless one of its children has a level at least as high (a building with parts, say). An instance has its template's
    level."""

    def level(geometry: dict[str, Any]) -> float:
        if geometry["type"] == "GeometryInstance":
            geometry = templates["templates"][geometry["template"]]
        return float(geometry.get("lod", 0)) if geometry["type"] in DEPTHS else -1.0

    def highest(name: str) -> float:
        city_object = objects.get(name, {})
        levels = [level(g) for g in city_object.get("geometry", ())]
        return max([*levels, *(highest(child) for child in city_object.get("children", ()))], default=-1.0)

    for name, city_object in objects.items():
        geometries = city_object.get("geometry", ())
        max_level = max(map(level, geometries), default=-1.0)
        if all(highest(child) < max_level for child in city_object.get("children", ())):
            yield from ((name, g) for g in geometries if level(g) == max_level)


def _surfaces(
    geometry: dict[str, Any],
    vertices: NDArray[np.float64],
    templates: dict[str, Any],
    left_out: collections.Counter[str],
) -> list[tuple[str | None, Rings]]:
    """The semantic type of each surface, such as RoofSurface, where the file says one, and its rings."""
    if geometry["type"] == "GeometryInstance":
        matrix = np.array(geometry["transformationMatrix"], np.float64).reshape(4, 4)
        origin = vertices[_row(geometry["boundaries"][0], vertices)]
        template_vertices = np.array(templates["vertices-templates"], np.float64).reshape(-1, 3)
        moved = template_vertices @ matrix[:3, :3].T + matrix[:3, 3] + origin
        return _surfaces(templates["templates"][geometry["template"]], moved, {}, left_out)
    surfaces = geometry["boundaries"]
    if geometry["type"] not in DEPTHS:
        left_out[geometry["type"]] += 1
        return []
    semantics = geometry.get("semantics", {})
    of_surface = semantics.get("values") or []
    for _ in range(DEPTHS[geometry["type"]]):
        of_surface = [value for shell, values in zip(surfaces, of_surface) for value in values or [None] * len(shell)]  # noqa: B905
        surfaces = [surface for shell in surfaces for surface in shell]
    kinds: list[str | None] = [None] * len(surfaces)
    if len(of_surface) == len(surfaces):
        kinds = [None if value is None else semantics["surfaces"][value].get("type") for value in of_surface]
        left_out["ClosureSurface, which is no wall"] += kinds.count("ClosureSurface")
    return [
        (kind, [vertices[[_row(i, vertices) for i in ring]] for ring in rings])
        for kind, rings in zip(kinds, surfaces, strict=True)
        if kind != "ClosureSurface"
    ]


def _row(index: Any, vertices: NDArray[np.float64]) -> int:
    if not isinstance(index, int) or not 0 <= index < len(vertices):
        raise ValueError(f"boundaries: {index!r} names no vertex of {len(vertices)}")
    return index


def triangulated(rings: list[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Triangles (F, 3, 3) of a polygon: its outer ring, then its holes, (n, 3) each. Their corners turn as the outer
    ring does. A polygon without an area has no triangles."""
    outer = rings[0] if rings else np.empty((0, 3))
    if len(outer) < 3:
        return np.empty((0, 3, 3))
    from_first = outer - outer[0]
    normal = np.cross(from_first, np.roll(from_first, -1, axis=0)).sum(axis=0)
    axes = np.delete(np.arange(3), np.abs(normal).argmax())
    corners = np.concatenate(rings)
    flat = np.ascontiguousarray(corners[:, axes] - outer[0, axes])
    ends = np.cumsum([len(ring) for ring in rings]).astype(np.uint32)
    ids = _with_all_corners(mapbox_earcut.triangulate_float64(flat, ends).reshape(-1, 3).tolist(), ends.tolist())
    triangles = corners[np.array(ids, np.int64).reshape(-1, 3)]
    is_reversed = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]) @ normal < 0
    triangles[is_reversed] = triangles[is_reversed, ::-1]
    return triangles


def _with_all_corners(triangles: list[list[int]], ends: list[int]) -> list[list[int]]:
    """Adds the corners in the middle of straight edges, which earcut leaves out: the triangle at such an edge becomes
    several. A neighbouring polygon has these corners, too, and rounding may move them off the edge."""
    used = {corner for triangle in triangles for corner in triangle}
    for first, last in zip([0, *ends], ends, strict=False):
        kept = [i for i in range(first, last) if i in used]
        for a, b in zip(kept, [*kept[1:], *kept[:1]], strict=True):
            between = [*range(a + 1, b)] if a < b else [*range(a + 1, last), *range(first, b)]
            row = next((i for i, t in enumerate(triangles) if between and {a, b} <= {*t}), None)
            if row is not None:
                third = next(corner for corner in triangles.pop(row) if corner not in (a, b))
                chain = [a, *between, b]
                triangles += [[x, y, third] for x, y in zip(chain, chain[1:], strict=False)]
    return triangles
