# SPDX-License-Identifier: MIT
"""The visibility contract (docs/numerics.md, 1) in rational numbers, from its definition: slow, and nothing rounds."""

from __future__ import annotations

from fractions import Fraction

import numpy as np


def _vector(values):
    return [Fraction(float(v)) for v in values]


def _minus(a, b):
    return [x - y for x, y in zip(a, b, strict=True)]


def _dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def _cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def blocks(triangle, point, towards, is_position) -> bool:
    """Whether the closed triangle meets the open ray from the point: solves P + t D = a + u (b - a) + v (c - a)."""
    a, b, c = (_vector(v) for v in triangle)
    p, light = _vector(point), _vector(towards)
    d = _minus(light, p) if is_position else light
    e1, e2 = _minus(b, a), _minus(c, a)
    n = _cross(e1, e2)
    along = _dot(n, d)
    if along == 0:
        return False  # edge-on, or without area
    t = _dot(n, _minus(a, p)) / along
    if t <= 0 or (is_position and t >= 1):
        return False
    hit = _minus([x + t * y for x, y in zip(p, d, strict=True)], a)
    size = _dot(n, n)
    u = _dot(_cross(hit, e2), n) / size
    v = _dot(_cross(e1, hit), n) / size
    return u >= 0 and v >= 0 and u + v <= 1


def lit(triangles, points, *, direction=None, position=None, receivers=None, normals=None, front=False):
    """bool per point."""
    towards = np.float32(position) if position is not None else -np.float32(direction)
    result = []
    for i, point in enumerate(points):
        own = -1 if receivers is None else int(receivers[i])
        d = _minus(_vector(towards), _vector(point)) if position is not None else _vector(towards)
        side = True
        if normals is not None:
            side = _dot(_vector(normals[i]), d) > 0
        if front and own >= 0:
            a, b, c = (_vector(v) for v in triangles[own])
            of = _minus(_vector(towards), a) if position is not None else d
            side = side and _dot(_cross(_minus(b, a), _minus(c, a)), of) > 0
        result.append(
            side
            and not any(k != own and blocks(t, point, towards, position is not None) for k, t in enumerate(triangles))
        )
    return np.array(result, bool)


def above_height_field(triangles, vertex, towards, is_position=False):
    """Whether the light is strictly above the surface around a vertex, with z up, and whether the surface had to be
    extended: the surface's height where the ray leaves, from the triangles that have the vertex as a corner."""
    p = _vector(vertex)
    d = _minus(_vector(towards), p) if is_position else _vector(towards)
    over, planes = [], []
    for triangle in triangles:
        corners = [_vector(v) for v in triangle]
        if p not in corners:
            continue
        at = corners.index(p)
        a, b = _minus(corners[(at + 1) % 3], p), _minus(corners[(at + 2) % 3], p)
        area = a[0] * b[1] - a[1] * b[0]
        k, m = (d[0] * b[1] - d[1] * b[0]) / area, (a[0] * d[1] - a[1] * d[0]) / area  # d = k a + m b in x and y
        is_higher = d[2] > k * a[2] + m * b[2]
        planes.append(is_higher)
        if k >= 0 and m >= 0:
            over.append(is_higher)
    return all(over or planes), not over


def lit_at_vertices(triangles, points, direction):
    """bool per vertex of a height field, and how many needed the extension."""
    towards = -np.float32(direction)
    facing = [above_height_field(triangles, point, towards) for point in points]
    free = lit(triangles, points, direction=direction)
    return free & np.array([above for above, _ in facing]), sum(extended for _, extended in facing)
