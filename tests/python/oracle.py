# SPDX-License-Identifier: MIT
"""The visibility contract (docs/numerics.md, 1) in rational numbers, from its definition: slow, and nothing rounds."""

from __future__ import annotations

from fractions import Fraction
from math import ceil, floor

import numpy as np


def _vector(values):
    return [Fraction(float(v)) for v in values]


def _minus(a, b):
    return [x - y for x, y in zip(a, b, strict=True)]


def _dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def _cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def met(triangle, point, towards, is_position):
    """Where the open ray from the point meets the closed triangle, as weights of its corners; None where it does not:
    solves P + t D = a + u (b - a) + v (c - a)."""
    a, b, c = (_vector(v) for v in triangle)
    p, light = _vector(point), _vector(towards)
    d = _minus(light, p) if is_position else light
    e1, e2 = _minus(b, a), _minus(c, a)
    n = _cross(e1, e2)
    along = _dot(n, d)
    if along == 0:
        return None  # edge-on, or without area
    t = _dot(n, _minus(a, p)) / along
    if t <= 0 or (is_position and t >= 1):
        return None
    hit = _minus([x + t * y for x, y in zip(p, d, strict=True)], a)
    size = _dot(n, n)
    u = _dot(_cross(hit, e2), n) / size
    v = _dot(_cross(e1, hit), n) / size
    return (1 - u - v, u, v) if u >= 0 and v >= 0 and u + v <= 1 else None


def is_opaque(weights, uv, alpha, material) -> bool:
    """Whether a hit is opaque: texel(X) * alpha of the corners >= the threshold, with texel(X) by the material's wrap
    and filter. `uv` (3, 2); `alpha` three values, one for each corner."""
    threshold = round(255 * float(np.float32(material.cutoff)) / float(np.float32(material.factor)) * 65536)
    if np.float32(material.cutoff) > 1 or material.factor <= 0:
        return False
    wraps = (material.wrap,) * 2 if isinstance(material.wrap, str) else material.wrap
    sides = material.alpha.shape[::-1]
    at = [sum(w * Fraction(float(corner[i])) for w, corner in zip(weights, uv, strict=True)) * sides[i] for i in (0, 1)]

    def texel(x, y):
        place = []
        for i, wrap, side in zip((x, y), wraps, sides, strict=True):
            if wrap == "clamp":
                i = min(max(i, 0), side - 1)
            elif wrap == "repeat":
                i %= side
            else:
                i = min(i % (2 * side), 2 * side - 1 - i % (2 * side))
            place.append(i)
        return int(material.alpha[place[1], place[0]])

    if material.filter == "nearest":
        columns, rows = ({floor(a), ceil(a) - 1} for a in at)
        value = max(texel(x, y) for x in columns for y in rows)
    else:
        (x, f), (y, g) = ((floor(a - Fraction(1, 2)), a - Fraction(1, 2) - floor(a - Fraction(1, 2))) for a in at)
        upper = (1 - f) * texel(x, y) + f * texel(x + 1, y)
        value = (1 - g) * upper + g * ((1 - f) * texel(x, y + 1) + f * texel(x + 1, y + 1))
    return value * sum(w * Fraction(float(a)) for w, a in zip(weights, alpha, strict=True)) * 65536 >= threshold


def lit(triangles, points, *, direction=None, position=None, receivers=None, normals=None, front=False, opaque=None):
    """bool per point. `opaque`: whether a triangle, by its index, is opaque at a hit, by the weights of its corners."""
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
            and not any(
                k != own
                and (hit := met(t, point, towards, position is not None)) is not None
                and (opaque is None or opaque(k, hit))
                for k, t in enumerate(triangles)
            )
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
