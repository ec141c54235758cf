# SPDX-License-Identifier: MIT
"""Lines of sight over a raster in rational numbers, from the definition (gnomon.viewshed): each line is clipped by each
triangle, edge and vertex of the ground in turn. Slow, and nothing rounds."""

from __future__ import annotations

import functools
from fractions import Fraction


def simplices(heights):
    """The triangles, edges and vertices, all of whose corners have heights, as lists of (column, row). heights: rows of
    numbers or None, row 0 in the north; the diagonals run from south-west to north-east."""
    rows, columns = len(heights), len(heights[0])
    found = []
    for r in range(rows):
        for c in range(columns):
            east, south, south_west = (c + 1, r), (c, r + 1), (c - 1, r + 1)
            found += [[(c, r)], [(c, r), east], [(c, r), south], [(c, r), south_west]]
            found += [[(c, r), east, south], [(c, r), south, south_west]]
    return [s for s in found if all(0 <= x < columns and 0 <= y < rows and heights[y][x] is not None for x, y in s)]


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


def minus(a, b):
    return a[0] - b[0], a[1] - b[1]


def clipped(corners, start, ray):
    """The part t0 to t1 of start + t ray, 0 <= t <= 1, over a simplex; None if there is none."""
    low, high = Fraction(0), Fraction(1)
    conditions = []  # f + t g >= 0
    if len(corners) == 3:
        if cross(minus(corners[1], corners[0]), minus(corners[2], corners[0])) < 0:
            corners = corners[::-1]
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
            side = minus(b, a)
            conditions.append((cross(side, minus(start, a)), cross(side, ray)))
    else:
        a = corners[0]
        side = minus(corners[-1], a) if len(corners) == 2 else (1, 0)
        up = (-side[1], side[0])
        for direction, length in ((side, side[0] ** 2 + side[1] ** 2 if len(corners) == 2 else 0), (up, 0)):
            f = sum(x * y for x, y in zip(direction, minus(start, a), strict=True))
            g = sum(x * y for x, y in zip(direction, ray, strict=True))
            conditions += [(f, g), (length - f, -g)]
    for f, g in conditions:
        if g == 0:
            if f < 0:
                return None
        elif g > 0:
            low = max(low, Fraction(-f) / g)
        else:
            high = min(high, Fraction(f) / -g)
    return (low, high) if low <= high else None


def is_apart(corners, start, ray):
    """Whether all corners lie strictly on one side of the line of sight, or strictly beyond an end of its box."""
    sides = [cross(ray, minus(corner, start)) for corner in corners]
    if min(sides) > 0 or max(sides) < 0:
        return True
    return any(
        max(c[i] for c in corners) < min(start[i], start[i] + ray[i])
        or min(c[i] for c in corners) > max(start[i], start[i] + ray[i])
        for i in (0, 1)
    )


def height_over(corners, values, at):
    """The height of the simplex at a place over it."""
    if len(corners) == 1:
        return values[0]
    a, b = minus(corners[1], corners[0]), minus(at, corners[0])
    if len(corners) == 2:
        share = Fraction(a[0] * b[0] + a[1] * b[1]) / (a[0] ** 2 + a[1] ** 2)
        return values[0] + share * (values[1] - values[0])
    c = minus(corners[2], corners[0])
    area = cross(a, c)
    u, v = Fraction(cross(b, c)) / area, Fraction(cross(a, b)) / area
    return values[0] + u * (values[1] - values[0]) + v * (values[2] - values[0])


def is_above(margins, low, high):
    """Whether a linear function with these values at low and high is above 0 in that part of the open line 0 to 1."""
    if low == high:
        return low in (0, 1) or margins[0] > 0
    ends = [m >= 0 if t in (0, 1) else m > 0 for m, t in zip(margins, (low, high), strict=True)]
    return all(ends) and any(m > 0 for m in margins)


def seen(heights, eye, target_height=0, cells=None):
    """{(row, column): bool} for the cells that have heights. eye: column, row and height, Fractions or integers."""
    ground = simplices(heights)
    surface = [[heights[y][x] for x, y in s] for s in ground]
    result = {}
    for r, row in enumerate(heights):
        for c, own in enumerate(row):
            if own is None or cells is not None and (r, c) not in cells:
                continue
            start, target = (c, r), own + target_height
            ray = minus(eye[:2], start)
            if ray == (0, 0):
                result[r, c] = True
                continue
            place = functools.partial(lambda t, start, ray: (start[0] + t * ray[0], start[1] + t * ray[1]),
                                      start=start, ray=ray)  # fmt: skip
            result[r, c] = True
            for corners, values in zip(ground, surface, strict=True):
                part = None if is_apart(corners, start, ray) else clipped(corners, start, ray)
                if part is None:
                    continue
                margins = [target + t * (eye[2] - target) - height_over(corners, values, place(t)) for t in part]
                if not is_above(margins, *part):
                    result[r, c] = False
                    break
    return result
